"""The command that shows things made to order."""

import json
from pathlib import Path

import click

from oodscen._cli.options import json_option, simulator_option
from oodscen._cli.output import say, tracked, write_bytes
from oodscen._cli.paths import FileCommand, OutputName, PathName
from oodscen.errors import MissingExtra


@click.command(cls=FileCommand)
@click.argument("where", type=PathName(exists=True, path_type=Path))
@click.option("-o", "--out", type=OutputName(), help="PNG file for the sheet of pictures.")
@click.option(
    "--captions",
    is_flag=True,
    help="Write names and sizes on the sheet; otherwise its rows are numbered in random order.",
)
@simulator_option
@json_option
def props(where: Path, out: Path | None, captions: bool, simulator: str, as_json: bool) -> None:
    """Check and show the things made to order in WHERE: a file, a folder or a study.

    Prints size, mass and pixels of each thing 15 m ahead. The sheet shows each from 10, 15 and 30 m by day and
    by night. Without --captions it is for people or models who are to name what they see. The exit code is 1 if a
    thing is too small or too faint to be recognised.
    """
    from oodscen._display import png
    from oodscen._registry import make_simulator
    from oodscen.stages._props.files import read_props
    from oodscen.stages._props.looking import JUDGED_M, look_at, sheet

    found = read_props(where)
    with make_simulator(simulator) as shown:
        known = shown.catalogue().with_made(found)
        seen = list(tracked(look_at(found, shown), "props", len(found)))
    if out is not None:
        picture = png(sheet(seen, captions=captions))
        if picture is None:
            raise MissingExtra("a sheet of pictures", "pybullet", "cv2")
        write_bytes(out, picture)
    looks = [one.look for one in seen]
    if as_json:
        say(json.dumps([look.model_dump(mode="json") for look in looks], indent=2))
    else:
        for prop, look in zip(found, looks, strict=True):
            asset = known.asset(prop.id)
            size = f"{asset.length:g} x {asset.width:g} x {asset.height:g} m"
            day = next(v for v in look.views if v.distance_m == JUDGED_M and not v.is_night)
            told = "; ".join(look.faults) or look.recognised
            say(f"{prop.id:28} {size:22} {prop.mass_kg:8g} kg {day.pixels:7,} px  {told}")
    if any(look.faults for look in looks):
        click.get_current_context().exit(1)

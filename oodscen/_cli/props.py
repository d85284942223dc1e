"""The command that shows things made to order."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.options import json_option, refuse_idle, simulator_option
from oodscen._cli.output import say, write_bytes
from oodscen._cli.paths import FileCommand, OutputName, PathName
from oodscen._cli.progress import tracked
from oodscen._members import using
from oodscen.errors import MissingExtra, UsageError

if TYPE_CHECKING:
    from oodscen.data._catalogue import Asset
    from oodscen.stages._making.looking import PropLook


@click.command(cls=FileCommand)
@click.argument("where", type=PathName(exists=True, path_type=Path), required=False)
@click.option("-o", "--out", type=OutputName(), help="PNG file for the sheet of pictures.")
@click.option(
    "--captions",
    is_flag=True,
    help="Write names and sizes on the sheet; otherwise its rows are numbered in random order.",
)
@click.option(
    "--details",
    is_flag=True,
    help="Instead of WHERE, show every pose of people and every state of vehicles' parts.",
)
@simulator_option
@json_option
def props(
    where: Path | None,
    out: Path | None,
    captions: bool,
    details: bool,
    simulator: str,
    as_json: bool,
) -> None:
    """Check and show the things made to order in WHERE: a file, a folder or a study.

    Prints size, mass and pixels of each thing 15 m ahead. The sheet shows each from 10, 15 and 30 m by day and
    by night; what could not be made is named on standard error. Without --captions it is for people or models who are
    to name what they see. The exit code is 1 if a thing is too small or too faint to be recognised.
    """
    from oodscen._display import png
    from oodscen._registry import make_simulator
    from oodscen.data._details import DetailKinds
    from oodscen.stages._making.files import read_props
    from oodscen.stages._making.looking import look_at, look_at_details
    from oodscen.stages._making.sheet import sheet

    if (where is None) != details:
        raise click.UsageError("give WHERE, or --details without it")
    if out is None:
        refuse_idle("without --out, the file of the sheet", "captions")
    found, unmade = read_props(where) if where is not None else ([], [])
    with using(make_simulator(simulator)) as shown:
        catalogue = shown.catalogue()
        known = catalogue.with_made(found)
        kinds = catalogue.details or DetailKinds()
        views = look_at_details(shown) if details else look_at(found, shown)
        count = len(kinds.poses) + len(kinds.parts) if details else len(found)
        if details and not count:
            raise UsageError(f"{simulator} draws no poses and no states of parts")
        seen = list(tracked(views, "props", count))
    if out is not None:
        picture = png(sheet(seen, captions=captions))
        if picture is None:
            raise MissingExtra("a sheet of pictures", "pybullet", "cv2")
        write_bytes(out, picture)
    if unmade:
        say(f"not shown, since no design was made: {', '.join(unmade)}", err=True)
    looks = [shown_prop.look for shown_prop in seen]
    if as_json:
        say(json.dumps([look.model_dump(mode="json") for look in looks], indent=2))
    else:
        sizes = {prop.id: (known.asset(prop.id), f"{prop.mass_kg:8g} kg") for prop in found}
        for look in looks:
            say(_line(look, *sizes.get(look.id, (None, ""))))
    if any(look.faults for look in looks):
        click.get_current_context().exit(1)


def _line(look: "PropLook", asset: "Asset | None", mass: str) -> str:
    """Return the line about one thing: its size and mass if it was made, and its pixels by day."""
    from oodscen.stages._making.looking import JUDGED_M

    size = f"{asset.length:g} x {asset.width:g} x {asset.height:g} m" if asset else ""
    day = next(v for v in look.views if v.distance_m == JUDGED_M and not v.is_night)
    told = "; ".join(look.faults) or look.recognised
    return f"{look.id:28} {size:22} {mass:11} {day.pixels:7,} px  {told}"

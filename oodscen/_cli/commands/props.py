"""The command that shows things made to order."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.options import json_option, refuse_idle, simulator_option
from oodscen._cli.output import say, write_bytes
from oodscen._cli.paths import FileCommand, OutputName, PathName, is_same_file
from oodscen._cli.progress import tracked
from oodscen._members import using
from oodscen.errors import MissingExtra, UsageError

if TYPE_CHECKING:
    from oodscen.data._catalogue import Catalogue
    from oodscen.data._designs.prop import Prop
    from oodscen.stages._making.looking import PropLook, ShownProp


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
    from oodscen._registry import make_simulator
    from oodscen.stages._making.files import Designs, read_props
    from oodscen.stages._making.looking import look_at, look_at_details

    if (where is None) != details:
        raise click.UsageError("give WHERE, or --details without it")
    if out is None:
        refuse_idle("without --out, the file of the sheet", "captions")
    elif where is not None:
        _refuse_design_file(out, where)
    with using(make_simulator(simulator)) as adapter:
        catalogue = adapter.catalogue()
        designs = Designs([], []) if where is None else read_props(where, catalogue.assets)
        count = _detail_count(catalogue) if details else len(designs.props)
        if details and not count:
            raise UsageError(f"{simulator} draws no poses and no states of parts")
        views = look_at_details(adapter) if details else look_at(designs.props, adapter)
        shown = list(tracked(views, "props", count))
    if out is not None:
        _write_sheet(out, shown, captions=captions)
    if designs.unmade:
        say(f"not shown, since no design was made: {', '.join(designs.unmade)}", err=True)
    looks = [shown_prop.look for shown_prop in shown]
    if as_json:
        say(json.dumps([look.model_dump(mode="json") for look in looks], indent=2))
    else:
        catalogue = catalogue.with_made(designs.props)
        by_id = {prop.id: prop for prop in designs.props}
        for look in looks:
            say(_line(look, by_id.get(look.id), catalogue))
    if any(look.faults for look in looks):
        click.get_current_context().exit(1)


def _refuse_design_file(out: Path, where: Path) -> None:
    """Refuse to write a sheet over a design of the folder that is shown."""
    from oodscen.stages._making.files import design_files

    if where.is_dir():
        for file in design_files(where):
            if is_same_file(out, file):
                raise UsageError(f"--out would replace a file that WHERE reads: {file}")


def _detail_count(catalogue: "Catalogue") -> int:
    """Return the number of poses and of states of parts that the simulator draws."""
    kinds = catalogue.details
    return len(kinds.poses) + len(kinds.parts) if kinds else 0


def _write_sheet(out: Path, shown: "list[ShownProp]", *, captions: bool) -> None:
    from oodscen._display import png
    from oodscen.stages._making.sheet import sheet

    picture = png(sheet(shown, captions=captions))
    if picture is None:
        raise MissingExtra("a sheet of pictures", "pybullet", "cv2")
    write_bytes(out, picture)


def _line(look: "PropLook", prop: "Prop | None", catalogue: "Catalogue") -> str:
    """Return the line about one thing: its size and mass if it was made, and its pixels by day."""
    from oodscen.stages._making.looking import JUDGED_M

    size = mass = ""
    if prop is not None:
        asset = catalogue.asset(prop.id)
        size = f"{asset.length:g} x {asset.width:g} x {asset.height:g} m"
        mass = f"{prop.mass_kg:8g} kg"
    day = next(view for view in look.views if view.distance_m == JUDGED_M and not view.is_night)
    judgement = "; ".join(look.faults) or look.recognised
    return f"{look.id:28} {size:22} {mass:11} {day.pixels:7,} px  {judgement}"

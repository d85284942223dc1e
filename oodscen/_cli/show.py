"""The command that prints a scene, with its picture where the terminal shows one."""

import json
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.options import json_option, refuse_idle
from oodscen._cli.output import say
from oodscen._cli.paths import PathName
from oodscen._cli.pictures import GRAPHICS, blocks, graphics_of, iterm, kitty, sixel
from oodscen._text import one_line
from oodscen.data._episode import ACTIONS, in_order
from oodscen.data._pairing import kind_of, scene_of
from oodscen.errors import UnknownComponent, UsageError

if TYPE_CHECKING:
    from oodscen.data._details import Details
    from oodscen.data._episode import Episode
    from oodscen.data._scenario import Scenario
    from oodscen.data._scene import Scene, Weather
    from oodscen.study._study import Study

_WIDEST = 80
"""Maximum width of a picture, in columns of the terminal."""


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.argument("scene", required=False)
@click.option("--moment", help="Frame to show: first, middle, last ...  [default: last]")
@click.option(
    "--graphics",
    type=click.Choice(GRAPHICS),
    default="auto",
    show_default=True,
    help="Way of showing the picture; none in a pipe.",
)
@json_option
def show(out: Path, scene: str | None, moment: str | None, graphics: str, as_json: bool) -> None:
    """Print a scene of the study in the folder OUT with its picture, or a list of all scenes.

    SCENE is the id of a scene, or the beginning of one; SCENE~twin and SCENE~demand are its ordinary drives.
    """
    from oodscen.study._study import Study

    if scene is None or as_json:
        refuse_idle("without a scene" if scene is None else "with --json", "moment", "graphics")
    study = Study.open(out)
    texts = {scenario.id: scenario for scenario in study.scenarios}
    scenes = study.scenes
    if scene is None:
        rows = [(one.id, one_line(texts[one.id].text) if one.id in texts else "") for one in scenes]
        if as_json:
            say(json.dumps([{"id": name, "text": text} for name, text in rows], indent=2))
        else:
            say("\n".join(f"{name}  {text}" for name, text in rows) or "the study has no scenes")
        return
    chosen = _chosen(scene, scenes)
    item = chosen.id + scene[len(scene_of(scene)) :]
    episode = next((one for one in study.episodes if one.scene_id == item), None)
    if episode is None and kind_of(item) != "rare":
        raise UnknownComponent("ordinary drive", item, [one.scene_id for one in study.episodes])
    known = texts.get(chosen.id)
    if as_json:
        found = {"scene": chosen, "scenario": known, "episode": episode}
        shown = {name: one and one.model_dump(mode="json") for name, one in found.items()}
        say(json.dumps(shown, indent=2, ensure_ascii=False))
        return
    if episode is None or not episode.frames:
        refuse_idle(f"on {item}, which has no frames", "moment")
    file = _frame(study, episode, moment)
    if file is not None:
        _show_picture(file, graphics)
    say("\n".join(_words(item, chosen, known, episode, file)))


def _chosen(name: str, scenes: "list[Scene]") -> "Scene":
    """Return the scene with an id that is, or starts with, a name.

    Raises:
        UsageError: If several scenes start with it.
        UnknownComponent: If none does, with close matches.
    """
    wanted = scene_of(name)
    found = [scene for scene in scenes if scene.id == wanted]
    found = found or [scene for scene in scenes if wanted and scene.id.startswith(wanted)]
    if not found:
        raise UnknownComponent("scene", wanted[:200], [scene.id for scene in scenes])
    if len(found) > 1:
        raise UsageError(
            f"{len(found)} scenes start with {wanted!r}: {', '.join(one.id for one in found[:5])} ..."
        )
    return found[0]


def _frame(study: "Study", episode: "Episode | None", moment: str | None) -> Path | None:
    """Return the file of a frame, or `None` if the episode has none.

    Raises:
        UnknownComponent: If the episode has frames, but none of that moment.
    """
    if episode is None or not episode.frames:
        return None
    name = moment or in_order(episode.frames)[-1]
    if name not in episode.frames:
        raise UnknownComponent("moment", name, episode.frames)
    file = study.store.inside(episode.frames[name])
    return file if file.is_file() else None


def _show_picture(file: Path, graphics: str) -> None:
    """Show a picture, if the terminal can and OpenCV is installed."""
    if graphics == "auto":
        graphics = graphics_of(os.environ) if sys.stdout.isatty() else "none"
    if graphics == "none":
        return
    columns = min(shutil.get_terminal_size().columns, _WIDEST)
    data = file.read_bytes()
    if graphics == "iterm":
        click.echo(iterm(data, columns), color=True)
        return
    try:
        import cv2
        import numpy as np
    except ImportError:
        say("no picture: pip install 'oodscen[pybullet]'", err=True)
        return
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    if image is None:
        say(f"no picture: {file} cannot be read", err=True)
    elif graphics == "kitty":
        click.echo(kitty(cv2.imencode(".png", image)[1].tobytes(), columns), color=True)
    else:
        pixels = np.ascontiguousarray(image[..., ::-1])
        shown = sixel(pixels) if graphics == "sixel" else blocks(pixels, columns)
        click.echo(shown, color=True)


def _words(
    item: str,
    scene: "Scene",
    known: "Scenario | None",
    episode: "Episode | None",
    file: Path | None,
) -> Iterator[str]:
    """Yield the lines about a scene, or about one of its ordinary drives."""
    yield item
    if known is not None:
        yield f"  path      {' > '.join(known.path)}"
        text = {"rare": known.text, "twin": known.ordinary}.get(kind_of(item))
        if text:
            yield f"  text      {one_line(text)}"
    if kind_of(item) == "rare":
        yield f"  place     {scene.map}, ego at {scene.ego.speed:g} m/s; {_weather(scene.weather)}"
        for part, state in scene.map_state.faults() if scene.map_state else ():
            yield f"  map       {part}: {state}"
        for actor in scene.actors:
            mark = "*" if actor.id in scene.hazard.actors else " "
            at = actor.placement
            yield (
                f"  actor   {mark} {actor.id}: {actor.asset}, {actor.behaviour.name}, lane {at.lane}, "
                f"{at.ahead_m:g} m ahead"
            )
            for name in actor.details.given() if actor.details else ():
                yield f"              {name}: {_given(actor.details, name)}"
        for prop in scene.made:
            yield f"  made      {prop.id}: {prop.description}"
        for motion in scene.motions:
            yield f"  made      {motion.id}: {motion.description}"
    if episode is None:
        yield "  not simulated"
    elif episode.status == "failed":
        yield f"  failed    {one_line(episode.error or '')}"
    else:
        yield f"  decision  after {episode.decision_s or 0:.2f} s"
        for action in (one for one in ACTIONS if one in episode.actions):
            yield f"  {action:18}{episode.label(action)}"
    if file is not None:
        yield f"  frame     {file}"


def _given(details: "Details | None", name: str) -> str:
    value = getattr(details, name)
    return ", ".join(value) if isinstance(value, tuple) else str(value)


def _weather(weather: "Weather") -> str:
    from oodscen.data._scene import CLEAR_AIR_M

    parts = [f"sun at {weather.sun_elevation_deg:g} degrees"]
    if weather.fog_visual_range_m < CLEAR_AIR_M:
        parts.append(f"fog, {weather.fog_visual_range_m:g} m of sight")
    if weather.precipitation != "none":
        parts.append(f"{weather.precipitation}, {weather.precipitation_mm_h:g} mm/h")
    return ", ".join(parts)

"""The command that prints a scene, with its picture where the terminal shows one."""

import json
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from oodscen._cli.options import json_option, refuse_idle
from oodscen._cli.output import say
from oodscen._cli.paths import PathName
from oodscen._cli.pictures import GRAPHICS, blocks, graphics_of, iterm, kitty, sixel
from oodscen._io.standard_output import results
from oodscen._words.text import one_line
from oodscen.data._episode import ACTIONS, in_order
from oodscen.data._pairing import is_ordinary, kind_of, scene_of
from oodscen.errors import UnknownComponent, UsageError

if TYPE_CHECKING:
    from oodscen.data._details import Details
    from oodscen.data._episode import Episode
    from oodscen.data._scenario import Scenario
    from oodscen.data._scene import Scene
    from oodscen.data._weather import Weather
    from oodscen.study._study import Study

_WIDEST = 80
"""Maximum width of a picture, in columns of the terminal."""
_LISTED = 5
"""Maximum number of scenes that are listed if several start with a name."""


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
    scenarios = {scenario.id: scenario for scenario in study.scenarios}
    if scene is None:
        _say_scenes(study.scenes, scenarios, as_json=as_json)
        return
    drive = _drive(scene, study, scenarios)
    if as_json:
        say(drive.to_json())
        return
    if not drive.frames:
        refuse_idle(f"on {drive.item_id}, which has no frames", "moment")
    frame = _frame(study, drive, moment)
    if frame is not None:
        _show_picture(frame, graphics)
    say("\n".join(_lines(drive, frame)))


def _say_scenes(
    scenes: "Iterable[Scene]", scenarios: "Mapping[str, Scenario]", *, as_json: bool
) -> None:
    texts = {
        scene.id: one_line(scenarios[scene.id].text) if scene.id in scenarios else ""
        for scene in scenes
    }
    if as_json:
        rows = [{"id": scene_id, "text": text} for scene_id, text in texts.items()]
        say(json.dumps(rows, indent=2))
    elif texts:
        say("\n".join(f"{scene_id}  {text}" for scene_id, text in texts.items()))
    else:
        say("the study has no scenes")


class _Drive(NamedTuple):
    """A scene or one of its ordinary drives, and what the study holds of it."""

    item_id: str
    scene: "Scene"
    """The driven scene; of a twin, the one without its hazard."""
    scenario: "Scenario | None"
    """The text of the scene, or of the scene to which the ordinary drive belongs."""
    episode: "Episode | None"

    @property
    def frames(self) -> dict[str, str]:
        """The files of the frames by moment; empty if there are none."""
        return self.episode.frames if self.episode else {}

    @property
    def text(self) -> str | None:
        """The text of this very drive, if it has one."""
        if self.scene.demand is not None:
            return self.scene.demand.text
        if self.scenario is None:
            return None
        return self.scenario.ordinary if is_ordinary(self.item_id) else self.scenario.text

    def to_json(self) -> str:
        """Return the parts as one object; a part that is missing is null."""
        parts = {"scene": self.scene, "scenario": self.scenario, "episode": self.episode}
        rows: dict[str, object] = {"text": self.text}
        rows |= {name: part and part.model_dump(mode="json") for name, part in parts.items()}
        return json.dumps(rows, indent=2, ensure_ascii=False)


def _drive(name: str, study: "Study", scenarios: "Mapping[str, Scenario]") -> _Drive:
    """Return the drive of a name, whose scene may be abbreviated.

    Raises:
        UsageError: If several scenes start with the name.
        UnknownComponent: If there is no such scene or ordinary drive, with close matches.
    """
    scene = _scene(scene_of(name), study.scenes)
    item_id = scene.id + name.removeprefix(scene_of(name))
    episodes = {episode.scene_id: episode for episode in study.episodes}
    if is_ordinary(item_id) and item_id not in episodes:
        raise UnknownComponent("ordinary drive", item_id, filter(is_ordinary, episodes))
    driven = _driven(item_id, scene, study.demands, episodes)
    return _Drive(item_id, driven, scenarios.get(scene.scenario_id), episodes.get(item_id))


def _driven(
    item_id: str, scene: "Scene", demands: "Iterable[Scene]", episodes: "Mapping[str, Episode]"
) -> "Scene":
    """Return what was driven as a scene, or as one of its ordinary drives."""
    kind = kind_of(item_id)
    if kind == "demand":
        return next((demand for demand in demands if demand.id == item_id), scene)
    if kind == "twin":
        runs = (episodes.get(name) for name in (item_id, scene.id))
        times_s = [run.decision_s for run in runs if run is not None and run.decision_s is not None]
        return scene.twin(times_s[0] if times_s else 0.0)
    return scene


def _scene(name: str, scenes: "Sequence[Scene]") -> "Scene":
    """Return the scene with an id that is, or starts with, a name."""
    by_id = {scene.id: scene for scene in scenes}
    if name in by_id:
        return by_id[name]
    matches = [scene_id for scene_id in by_id if name and scene_id.startswith(name)]
    if not matches:
        raise UnknownComponent("scene", name[:200], by_id)
    if len(matches) > 1:
        rest = " ..." if len(matches) > _LISTED else ""
        listed = ", ".join(matches[:_LISTED])
        raise UsageError(f"{len(matches)} scenes start with {name!r}: {listed}{rest}")
    return by_id[matches[0]]


def _frame(study: "Study", drive: _Drive, moment: str | None) -> Path | None:
    """Return the file of a frame, or `None` if there is none.

    Raises:
        UnknownComponent: If the drive has frames, but none of that moment.
    """
    if not drive.frames:
        return None
    name = moment or in_order(drive.frames)[-1]
    if name not in drive.frames:
        raise UnknownComponent("moment", name, drive.frames)
    file = study.store.inside(drive.frames[name])
    return file if file.is_file() else None


def _show_picture(file: Path, graphics: str) -> None:
    """Show a picture, if the terminal can and OpenCV is installed."""
    if graphics == "auto":
        graphics = graphics_of(os.environ) if results().isatty() else "none"
    if graphics == "none":
        return
    columns = min(shutil.get_terminal_size().columns, _WIDEST)
    data = file.read_bytes()
    if graphics == "iterm":
        click.echo(iterm(data, columns), file=results(), color=True)
        return
    try:
        import cv2
        import numpy as np
    except ImportError:
        say("no picture: pip install 'oodscen[pybullet]'", err=True)
        return
    # OpenCV raises an error of its own for a file without a byte.
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
    if image is None:
        say(f"no picture: {file} cannot be read", err=True)
    elif graphics == "kitty":
        click.echo(
            kitty(cv2.imencode(".png", image)[1].tobytes(), columns), file=results(), color=True
        )
    else:
        pixels = np.ascontiguousarray(image[..., ::-1])
        shown = sixel(pixels) if graphics == "sixel" else blocks(pixels, columns)
        click.echo(shown, file=results(), color=True)


def _lines(drive: _Drive, frame: Path | None) -> Iterator[str]:
    """Yield the lines about a drive."""
    yield drive.item_id
    if drive.scenario is not None:
        yield f"  path      {' > '.join(drive.scenario.path)}"
    if drive.text:
        yield f"  text      {one_line(drive.text)}"
    yield from _scene_lines(drive.scene)
    yield from _episode_lines(drive.episode)
    if frame is not None:
        yield f"  frame     {frame}"


def _scene_lines(scene: "Scene") -> Iterator[str]:
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
        if actor.details:
            for name in actor.details.given():
                yield f"              {name}: {_detail(actor.details, name)}"
    for prop in scene.made:
        yield f"  made      {prop.id}: {prop.description}"
    for motion in scene.motions:
        yield f"  made      {motion.id}: {motion.description}"


def _episode_lines(episode: "Episode | None") -> Iterator[str]:
    if episode is None:
        yield "  not simulated"
    elif episode.status == "failed":
        yield f"  failed    {one_line(episode.error or '')}"
    else:
        yield f"  decision  after {episode.decision_s or 0:.2f} s"
        for action in ACTIONS:
            if action in episode.actions:
                yield f"  {action:18}{episode.label(action)}"


def _detail(details: "Details", name: str) -> str:
    value = getattr(details, name)
    return ", ".join(value) if isinstance(value, tuple) else str(value)


def _weather(weather: "Weather") -> str:
    from oodscen.data._weather import CLEAR_AIR_M

    parts = [f"sun at {weather.sun_elevation_deg:g} degrees"]
    if weather.fog_visual_range_m < CLEAR_AIR_M:
        parts.append(f"fog, {weather.fog_visual_range_m:g} m of sight")
    if weather.precipitation != "none":
        parts.append(f"{weather.precipitation}, {weather.precipitation_mm_h:g} mm/h")
    return ", ".join(parts)

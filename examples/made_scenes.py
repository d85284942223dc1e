"""Shows scenes with things and movements made to order that are nothing but data.

Run it with `python examples/made_scenes.py [FOLDER [SIMULATOR]]`; it needs OpenCV. The folder becomes a small
study: texts, scenes, episodes, frames and a report; one that holds anything is refused. `examples/made` has the designs of the things,
`examples/made_scenes.toml` the movements and the scenes. Only PyBullet draws the parts and the poses.
"""

import json
import sys
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import cv2

from oodscen import Scenario, Scene, Study, make_simulator, simulate
from oodscen.errors import OodscenError
from oodscen.protocols import Simulator

HERE = Path(__file__).parent


def scenes() -> Iterator[tuple[Scenario, Scene]]:
    """Yield every text with its scene; all actors of a scene are part of its hazard."""
    designs = {path.stem: json.loads(path.read_text()) for path in (HERE / "made").glob("*.json")}
    rows = tomllib.loads((HERE / "made_scenes.toml").read_text())
    motions = {name: {"id": name, **one} for name, one in rows.pop("motions").items()}
    for name, row in rows.items():
        text = row.pop("text")
        yield Scenario(id=name, text=text), scene_of(name, row, designs, motions)


def scene_of(
    name: str,
    row: Mapping[str, Any],
    designs: Mapping[str, Any],
    motions: Mapping[str, Any],
) -> Scene:
    """Return a scene with the designs that its actors use."""
    actors = row["actors"]
    used = [actor["asset"] for actor in actors]
    used += [actor["behaviour"]["name"] for actor in actors if "behaviour" in actor]
    usual = {
        "ego": {"speed": 7},
        "hazard": {"actors": {actor["id"]: None for actor in actors}},
        "decision": {"kind": "distance", "value": 16, "actor": actors[0]["id"]},
    }
    made = [designs[fromkey] for fromkey in dict.fromkeys(used) if fromkey in designs]
    moved = [motions[fromkey] for fromkey in dict.fromkeys(used) if fromkey in motions]
    own = {"id": name, "scenario_id": name, "made": made, "motions": moved}
    return Scene.parse({**usual, **own, **row}, source=name)


def run(folder: Path, scene: Scene, simulator: Simulator) -> str:
    """Simulate a scene, save its frames and return the line of its episode."""
    result = simulate(scene, simulator)
    files = {moment: f"frames/{scene.id}/{moment}.jpg" for moment in result.frames}
    for moment, frame in result.frames.items():
        path = folder / files[moment]
        path.parent.mkdir(parents=True, exist_ok=True)
        if not cv2.imwrite(str(path), frame.rgb[..., ::-1]):
            raise OSError(f"{path} cannot be written")
    return result.episode.model_copy(update={"frames": files}).to_json()


def main(folder: str = "made", simulator_name: str = "pybullet") -> None:
    """Make the study in a new or empty folder, as its only writer."""
    out = Path(folder)
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise FileExistsError(f"{folder} is not empty; choose another folder")
    with Study(out).store.writing():
        write(out, simulator_name)
    print(Study.open(out).write_report())


def write(out: Path, simulator_name: str) -> None:
    """Write the study, and say which actions are safe in every scene."""
    lines: dict[str, list[str]] = {"scenarios": [], "scenes": [], "episodes": []}
    with make_simulator(simulator_name) as simulator:
        for scenario, scene in scenes():
            faults = scene.check(simulator.catalogue())
            if faults:
                print(f"{scene.id:42} cannot be shown: {faults[0]}")
                continue
            lines["scenarios"].append(scenario.to_json())
            lines["scenes"].append(scene.to_json())
            lines["episodes"].append(run(out, scene, simulator))
            actions = json.loads(lines["episodes"][-1])["actions"]
            safe = [name for name, outcome in actions.items() if outcome["safe"]]
            print(f"{scene.id:42} safe: {', '.join(safe) or 'nothing'}")
    for name, rows in lines.items():
        (out / f"{name}.jsonl").write_text("".join(f"{row}\n" for row in rows))
    about = {"schema_version": 1, "status": "success", "config": {"simulator": simulator_name}}
    (out / "study.json").write_text(json.dumps(about))


if __name__ == "__main__":
    try:
        main(*sys.argv[1:3])
    except (OodscenError, OSError) as error:
        sys.exit(f"made_scenes: {error}")

"""Compares the safe sets of a study with those that CARLA's client finds on the same scenes.

Usage: python benchmarks/carla_safe_sets.py STUDY [--scenes N] [--reaction S ...] [--json]

Needs the `carla` package. A server of the study's scenes runs in a process of its own, and
`examples/carla/actions.py`, which knows only the client, drives every action by three drivers. An action that is
safe in the study must pass in all drives, one that no driver passes must fail in all, and a marginal one must do
both: if it does not, the script drives it again with the road's friction and the ego's speed varied as in the study.
For the driver with the middle reaction time, the way is compared with the simulator's own, too.
"""

import argparse
import json
import math
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from oodscen_carla.server import CarlaTestServer

from oodscen import Episode, Scene, Study, make_simulator, simulate
from oodscen.stages._safe_actions import FRICTIONS, SPEEDS, Trials

SCRIPT = Path(__file__).parents[1] / "examples" / "carla" / "actions.py"
Row = dict[str, Any]


def chosen(study: Study, count: int) -> list[tuple[Scene, Episode]]:
    """Return scenes that succeeded, from every map in turn."""
    episodes = {episode.scene_id: episode for episode in study.episodes if episode.status == "ok"}
    by_map: dict[str, list[Scene]] = {}
    for scene in study.scenes:
        # A client does not see the light that forbids to pass a stop line.
        if scene.id in episodes and scene.stop_line is None:
            by_map.setdefault(scene.map, []).append(scene)
    rows = [
        scenes[round((number + 0.5) * len(scenes) / count - 0.5) % len(scenes)]
        for number in range(count)
        for scenes in by_map.values()
    ]
    rows = list({scene.id: scene for scene in rows}.values())
    return [(scene, episodes[scene.id]) for scene in rows[:count]]


def driven(port: int, scene: Scene, episode: Episode, more: Sequence[str] = ()) -> list[Row]:
    """Return what the client finds for every action and driver, with more options of the script."""
    order = [sys.executable, str(SCRIPT), scene.id, "--json", "--port", str(port)]
    order += ["--decision", str(episode.decision_s), "--horizon", str(episode.horizon_s)]
    order += ["--reaction", *map(str, episode.reaction_s), *more]
    done = subprocess.run(order, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def verdict(found: list[Row], episode: Episode, action: str) -> str:
    """Return whether the drives of an action agree with the study."""
    drives = [row for row in found if row["action"] == action]
    outcome = episode.actions[action]
    if not drives[0]["available"] or outcome.unavailable:
        return "agrees" if outcome.unavailable and not drives[0]["available"] else "differs"
    passed = {not row["hit"] and not row["off_road"] for row in drives}
    if outcome.marginal:
        return "agrees" if passed == {True, False} else "marginal in the study only"
    return "agrees" if passed == {outcome.safe} else "differs"


def verdicts(port: int, scene: Scene, episode: Episode, found: list[Row]) -> dict[str, str]:
    """Return whether the drives agree, by action, after more drives of those that are marginal in the study only."""
    said = {action: verdict(found, episode, action) for action in episode.actions}
    again = [one for one, word in said.items() if word.startswith("marginal")]
    if again:
        shares = ["--friction", *map(str, FRICTIONS), "--speed", *map(str, SPEEDS)]
        more = driven(port, scene, episode, [*shares, "--action", *again])
        said |= {one: verdict(more, episode, one) for one in again}
    return said


def apart(found: list[Row], action: str, middle: float, rollout: Any) -> float:
    """Return the greatest distance between the client's way and the simulator's, m."""
    drives = [row for row in found if row["action"] == action and row["available"]]
    near = [row for row in drives if row["reaction"] == middle or action == "keep_speed"]
    if not near or rollout is None:
        return 0.0
    x, y = rollout["x"][1:, 0].tolist(), rollout["y"][1:, 0].tolist()
    ways = zip(near[0]["path"], x, y, strict=False)
    return max((math.dist((a, -b), (c, d)) for (a, b, _), c, d in ways), default=0.0)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", type=Path)
    parser.add_argument("--scenes", type=int, default=18)
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    options = parser.parse_args()
    pairs = chosen(Study(options.study), options.scenes)
    counts: Counter[str] = Counter()
    same, farthest, rows = 0, 0.0, []
    with (
        make_simulator("pybullet") as simulator,
        CarlaTestServer([scene for scene, _ in pairs], simulator="pybullet") as server,
    ):
        for scene, episode in pairs:
            found = driven(server.port, scene, episode)
            own = simulate(scene, simulator, render=False, traces=True).rollouts
            middle = Trials.of(episode.reaction_s).middle
            said = verdicts(server.port, scene, episode, found)
            away = {
                action: apart(found, action, middle, own.get(action)) for action in episode.actions
            }
            counts.update(said.values())
            same += set(said.values()) == {"agrees"}
            farthest = max(farthest, *away.values())
            rows.append({"scene": scene.id, "map": scene.map, "verdicts": said, "apart_m": away})
            odd = {one: kind for one, kind in said.items() if kind != "agrees"}
            print(
                f"{scene.map:20} {scene.id:50} {max(away.values()):7.4f} m  {odd or 'same'}",
                flush=True,
            )
    print(f"safe set equal in {same} of {len(pairs)} scenes; farthest way {farthest:.3f} m")
    print(", ".join(f"{kind}: {number}" for kind, number in counts.most_common()))
    if options.json:
        print(json.dumps(rows))
    return 0 if not counts["differs"] else 1


if __name__ == "__main__":
    sys.exit(main())

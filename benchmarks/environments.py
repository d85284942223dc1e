"""Measures the environment `oodscen/Scene-v0` beside highway-env, and the reference drivers on a study.

Usage: python benchmarks/environments.py [STUDY] [--json] [--seconds N] [--limit N]

Steps per second of CPU time are of one process, without a policy, with the time of resets. highway-env is measured if it is
installed (`pip install highway-env`): its own defaults, and steps of 0.1 s as here. Actions of both keep the lane and
the speed. STUDY is the folder of a finished study; without it, the drivers drive the example scenes.
"""

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from statistics import median
from typing import Any

import gymnasium

import oodscen.gymnasium  # noqa: F401  # registers the environment
from oodscen import Study, drive, make_simulator
from oodscen._entry_points import DRIVERS
from oodscen._registry import driver_maker
from oodscen.data._scene import Scene
from oodscen.gymnasium._scenes import EXAMPLES
from oodscen.judging import drive_board

ROUNDS = 3
"""Rounds in which the environments take turns; the median counts."""
PICTURE = {
    "type": "GrayscaleObservation",
    "observation_shape": (128, 64),
    "stack_size": 1,
    "weights": [0.2989, 0.5870, 0.1140],
    "scaling": 1.75,
}
"""highway-env's picture from above, as its documentation configures it."""
Row = dict[str, object]
Made = tuple[Callable[[], "gymnasium.Env[Any, Any]"], Any]
"""A maker of an environment, and the action that keeps lane and speed."""


def environments() -> Iterator[tuple[str, Made]]:
    """Yield every environment to measure by name."""

    def ours(**settings: Any) -> Callable[[], "gymnasium.Env[Any, Any]"]:
        return lambda: gymnasium.make("oodscen/Scene-v0", disable_env_checker=True, **settings)

    yield "oodscen, state, 0.1 s", (ours(), [0.0, 0.0])
    yield "oodscen, state, 1 s", (ours(actions="discrete", step_s=1.0), 0)
    yield "oodscen, frame, 0.1 s", (ours(observation="frame"), [0.0, 0.0])
    if find_spec("highway_env") is None:
        print("highway-env is not installed: pip install highway-env", file=sys.stderr)
        return
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    import highway_env  # noqa: F401

    def theirs(**config: Any) -> Callable[[], "gymnasium.Env[Any, Any]"]:
        return lambda: gymnasium.make("highway-v0", disable_env_checker=True, config=config)

    fine = {"simulation_frequency": 20, "policy_frequency": 10}
    yield "highway-env, state, 0.1 s", (theirs(**fine), 1)
    yield "highway-env, state, 0.1 s, 3 of 50 cars", (theirs(vehicles_count=3, **fine), 1)
    yield "highway-env, state, 1 s (its default)", (theirs(), 1)
    yield "highway-env, frame, 0.1 s", (theirs(observation=PICTURE, **fine), 1)


def rates(seconds: float) -> list[Row]:
    """Measure the steps per second of every environment, taking turns."""
    made = {name: (make(), action) for name, (make, action) in environments()}
    found: dict[str, list[float]] = {name: [] for name in made}
    for env, action in made.values():
        rate(env, action, 0.2)
    for _ in range(ROUNDS):
        for name, (env, action) in made.items():
            found[name].append(rate(env, action, seconds / ROUNDS))
    for env, _ in made.values():
        env.close()
    return [row(f"{name}: steps", median(told), "steps/s") for name, told in found.items()]


def rate(env: "gymnasium.Env[Any, Any]", action: Any, seconds: float) -> float:
    """Return the steps per second of CPU time of one environment, resets included."""
    env.reset(seed=0)
    steps, start = 0, time.process_time()
    while time.process_time() - start < seconds:
        _, _, terminated, truncated, _ = env.step(action)
        steps += 1
        if terminated or truncated:
            env.reset()
    return steps / (time.process_time() - start)


def repeats() -> list[Row]:
    """Compare the rewards of episodes with those of a fresh environment in another order."""
    told: list[dict[str, list[float]]] = []
    for order in (1, -1):
        env = gymnasium.make("oodscen/Scene-v0")
        names = [scene.id for scene in EXAMPLES][::order]
        told.append({name: episode(env, name) for name in names})
        env.close()
    return [row("episodes repeat", float(told[0] == told[1]), "0/1", holds=told[0] == told[1])]


def episode(env: "gymnasium.Env[Any, Any]", scene: str) -> list[float]:
    """Return the rewards of braking a little all the way."""
    env.reset(options={"scene": scene})
    rewards, is_over = [], False
    while not is_over:
        _, reward, terminated, truncated, _ = env.step([-0.1, 0.0])
        rewards.append(float(reward))
        is_over = terminated or truncated
    return rewards


def outcomes(folder: str | None, limit: int | None) -> list[Row]:
    """Let every reference driver drive the scenes and twins of a study."""
    study = None if folder is None else Study.open(folder)
    scenes: Sequence[Scene] = EXAMPLES if study is None else study.scenes
    seed = 0 if study is None else study.config.seed
    results = []
    with make_simulator("flat" if study is None else study.config.simulator) as simulator:
        for name in DRIVERS:
            results += drive(scenes[:limit], driver_maker(name), simulator, name=name, seed=seed)
    board = drive_board(results, () if study is None else study.scenarios, seed=seed)
    rows = []
    for found in board.rows:
        label = f"{found.driver}, {found.n} {found.items}"
        rows += [
            row(f"{label}: passed", found.passed, "drives"),
            row(f"{label}: collisions", found.collisions, "drives"),
            row(f"{label}: failed", found.failed, "drives", holds=not found.failed),
        ]
        if found.paired is not None:
            sound, needless = found.paired.drives_and_passes, found.paired.brakes_needlessly
            rows += [
                row(f"{label}: drives and passes", sound.hits, "drives"),
                row(f"{label}: brakes needlessly in twins", needless.hits, "drives"),
            ]
    return rows


def row(name: str, value: float, unit: str, *, holds: bool = True) -> Row:
    """Return one row of the result."""
    return {"name": name, "value": round(value, 1), "unit": unit, "holds": holds}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; return 0 if episodes repeat and no drive failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("study", nargs="?", help="folder of a finished study")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    parser.add_argument("--seconds", type=float, default=9.0, help="time per environment")
    parser.add_argument("--limit", type=int, help="drive at most this many scenes")
    options = parser.parse_args(arguments)
    rows: list[Mapping[str, object]] = [
        *rates(options.seconds),
        *repeats(),
        *outcomes(options.study, options.limit),
    ]
    if options.json:
        print(json.dumps(rows))
    else:
        for one in rows:
            print(f"{one['name']!s:60} {one['value']:>9} {one['unit']}")
    return 0 if all(one["holds"] for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

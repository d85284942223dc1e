"""Measures the speed, memory use and bitwise repeatability of episodes.

Usage: python benchmarks/episodes.py [--json] [--only PART ...] [--simulator NAME]

Parts: rate, processes, study, memory, hashes.
"""

import argparse
import gc
import hashlib
import importlib
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import median

from tqdm import tqdm

from oodscen import Augmenter, Describer, Pruner, RedTeamer, TreeGrower, make_llm, make_simulator
from oodscen._pipeline.jobs import Job
from oodscen._pipeline.sweep import sweep
from oodscen.data._episode import ACTIONS, MOMENTS
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._motion.actions import action_driver
from oodscen.driving._trace import Trace
from oodscen.errors import LLMError
from oodscen.protocols import Camera, Simulator
from oodscen.stages._simulate import simulate
from oodscen.study._store import Store
from oodscen.testing._kit.isolation import open_files, resident_bytes

PARTS = ("rate", "processes", "study", "memory", "hashes")
SECONDS = 8.0
ROUNDS = 5
BATCH = 24
"""Episodes per measurement."""
STUDY_SCENES = 130
RESETS = 1_000
SMALL = Camera(width=160, height=120)

Row = dict[str, object]

CASTS: tuple[tuple[str, Weather, tuple[tuple[str, str, float, int, float], ...]], ...] = (
    (
        "urban_avenue",
        Weather(
            sun_elevation_deg=-20.0, precipitation="rain", precipitation_mm_h=8.0, friction=0.7
        ),
        (
            ("car", "hard_brake", 24.0, 0, 0.0),
            ("van", "cut_in", 8.0, 1, 0.0),
            ("bus", "follow_lane", -18.0, 0, 0.0),
            ("truck", "follow_lane", 60.0, 2, 0.0),
            ("cyclist", "wobble", 40.0, 0, -1.0),
            ("adult", "cross_road", 70.0, 0, -4.5),
        ),
    ),
    (
        "residential_two_lane",
        Weather(fog_visual_range_m=120.0, cloud_cover=0.9),
        (
            ("car", "follow_lane", 30.0, 0, 0.0),
            ("police_car", "follow_lane", 80.0, 1, 0.0),
            ("dog", "bolt", 45.0, 0, -4.0),
            ("child", "cross_road", 55.0, 0, -4.2),
            ("wheelie_bin", "stand", 65.0, 0, -1.8),
            ("car", "stop_and_go", 95.0, 0, 0.0),
        ),
    ),
    (
        "rural_curve",
        Weather(precipitation="snow", precipitation_mm_h=2.0, friction=0.4),
        (
            ("tractor", "follow_lane", 45.0, 0, 0.0),
            ("car", "wrong_way", 140.0, 0, 0.0),
            ("car", "follow_lane", 110.0, 1, 0.0),
            ("deer", "bolt", 60.0, 0, -4.0),
            ("motorcycle", "swerve", 20.0, 0, 0.0),
            ("adult", "walk_along", 80.0, 0, -2.6),
        ),
    ),
)
"""Map, weather, and six actors each: asset, behaviour, metres ahead, lane, metres to the left."""


def sample_scenes() -> list[Scene]:
    """Return the scenes to time, each with six actors."""
    scenes = []
    for number, (road, weather, cast) in enumerate(CASTS):
        actors = tuple(
            Actor(
                id=f"a{index}",
                asset=asset,
                placement=Placement(
                    ahead_m=ahead,
                    lane=lane,
                    offset_m=aside,
                    heading_deg=90.0 if behaviour in ("cross_road", "bolt") else 0.0,
                ),
                behaviour=Behaviour(
                    name=behaviour,
                    trigger=Trigger(value=1.0),
                    parameters={"lanes": -1.0} if behaviour == "cut_in" else {},
                ),
            )
            for index, (asset, behaviour, ahead, lane, aside) in enumerate(cast)
        )
        scenes.append(
            Scene(
                id=f"s{number}",
                scenario_id=f"s{number}",
                map=road,
                ego=Ego(speed=9.0),
                weather=weather,
                actors=actors,
                hazard=Hazard(actors={"a0": None}),
                decision=Trigger(value=1.5),
            )
        )
    return scenes


def run_episode(simulator: Simulator, scene: Scene, seed: int) -> Trace:
    """Run one episode of eight seconds without pictures but with all its ground truth."""
    driver = action_driver("keep_speed")
    states = [simulator.reset(scene, seed)]
    states += [
        simulator.step(driver.act(simulator.observe()))
        for _ in range(round(SECONDS / simulator.dt))
    ]
    trace = Trace.of(states, scene, simulator.catalogue())
    trace.summary()
    return trace


# ---------------------------------------------------------------- rate and processes


def rate(name: str) -> list[Row]:
    """Measure episodes per second of CPU time."""
    scenes, rates = sample_scenes(), []
    with make_simulator(name) as simulator:
        for scene in scenes:
            run_episode(simulator, scene, 0)
        for _ in tqdm(range(ROUNDS), desc="rate", disable=None):
            began = time.process_time()
            for index in range(BATCH):
                run_episode(simulator, scenes[index % len(scenes)], index)
            rates.append(BATCH / (time.process_time() - began))
    what = "8 s episodes with 6 actors and full ground truth, unrendered"
    return [row(what, median(rates), "per second and core", 40.0)]


_OPENED: dict[str, Simulator] = {}


def run_batch(name: str, count: int) -> int:
    """Run some episodes in a process that keeps its simulator, and return the process's id."""
    if name not in _OPENED:
        _OPENED[name] = make_simulator(name)
    scenes = sample_scenes()
    for index in range(count):
        run_episode(_OPENED[name], scenes[index % len(scenes)], index)
    return os.getpid()


def processes(name: str) -> list[Row]:
    """Compare the throughput of two processes with that of one, alternating."""
    context = multiprocessing.get_context("spawn")
    with (
        ProcessPoolExecutor(1, mp_context=context) as one,
        ProcessPoolExecutor(1, mp_context=context) as two,
    ):
        for pool in (one, two):
            pool.submit(run_batch, name, len(CASTS)).result()
        ratios = []
        for _ in tqdm(range(ROUNDS), desc="processes", disable=None):
            marks = [time.perf_counter()]
            one.submit(run_batch, name, 2 * BATCH).result()
            marks.append(time.perf_counter())
            for future in [pool.submit(run_batch, name, 2 * BATCH) for pool in (one, two)]:
                future.result()
            marks.append(time.perf_counter())
            ratios.append(2.0 * (marks[1] - marks[0]) / (marks[2] - marks[1]))
    return [row("throughput of two processes : one", median(ratios), "x", 1.8)]


# ---------------------------------------------------------------- the study's scenes


def study_scenes(name: str, count: int = STUDY_SCENES) -> list[Scene]:
    """Stage scenes of the default study, spread evenly over its paths.

    A text that cannot be staged is reported on standard error and skipped.
    """
    llm, catalogue = make_llm("builtin", seed=0), make_simulator(name).catalogue()
    tree = Pruner(llm, catalogue).run(RedTeamer(llm).run(TreeGrower(llm).run()))
    scenarios = list(Describer(llm, None).run(tree))
    chosen = [scenarios[index * len(scenarios) // count] for index in range(count)]
    augmenter, scenes = Augmenter(llm, catalogue), []
    for one in tqdm(chosen, desc="staging", disable=None):
        try:
            scenes.append(augmenter.run(one))
        except LLMError as error:
            print(f"{one.id} is not staged: {error}", file=sys.stderr)
    return scenes


def study(name: str) -> list[Row]:
    """Run the study's scenes as the study does: two processes, key frames, every action."""
    scenes = study_scenes(name)
    lost = STUDY_SCENES - len(scenes)
    failed = unseen = 0
    with tempfile.TemporaryDirectory() as folder:
        store = Store(folder)
        began = time.perf_counter()
        results = sweep(Job(name), scenes, workers=2)
        for result in tqdm(results, total=len(scenes), desc="study", disable=None):
            result.save(store)
            failed += result.episode.status == "failed"
            unseen += result.episode.hazard_visible is False
            if result.episode.status == "failed" or result.episode.hazard_visible is False:
                fault = result.episode.error or "its hazard is not visible"
                print(f"{result.episode.id}: {fault}", file=sys.stderr)
        seconds = time.perf_counter() - began
    what = f"{STUDY_SCENES} scenes, key frames and {len(ACTIONS)} actions each, on 2 cores"
    return [
        row(what, seconds, "s", 60.0, is_most=True),
        row("of these, not staged", lost, "scenes", 0.0, is_most=True),
        row("of these, failed", failed, "scenes", 0.0, is_most=True),
        row("of these, hazard not visible in any key frame", unseen, "scenes", 0.0, is_most=True),
    ]


# ---------------------------------------------------------------- memory


def watch_memory(name: str) -> dict[str, float]:
    """Load scenes repeatedly; return the growth since the first fifth, in MiB and open files."""
    scenes = sample_scenes()
    used: list[int] = []
    files: list[int] = []
    with make_simulator(name) as simulator:
        for index in range(RESETS):
            simulator.reset(scenes[index % len(scenes)], index)
            if index % 10 == 0:
                simulator.reset(scenes[index // 10 % len(scenes)], 0)
                simulator.render(SMALL)
            if index % 10 == 9:
                gc.collect()
                used.append(resident_bytes())
                files.append(open_files())
    fifth = len(used) // 5
    grown = min(used[-fifth:]) - min(used[fifth : 2 * fifth])
    return {"mib": grown / 2**20, "files": files[-1] - files[fifth]}


def memory(name: str) -> list[Row]:
    """Measure the memory of a fresh process."""
    grown = json.loads(child("memory", name, {}))
    what = f"memory of a process over {RESETS} resets, after the first fifth"
    return [
        row(what, grown["mib"], "MiB", 5.0, is_most=True),
        row("open files over the same resets", grown["files"], "files", 0.0, is_most=True),
    ]


# ---------------------------------------------------------------- hashes


def digests(name: str, *, is_reversed: bool = False) -> dict[str, str]:
    """Return the SHA-256 of every trace and frame of the sample scenes."""
    found = {}
    scenes = sample_scenes()
    with make_simulator(name) as simulator:
        for scene in scenes[::-1] if is_reversed else scenes:
            simulated = simulate(scene, simulator, seed=5, traces=True)
            for moment in MOMENTS:
                frame = simulated.frames[moment]
                digest = hashlib.sha256(frame.rgb.tobytes())
                digest.update(frame.depth.tobytes() + frame.ids.tobytes())
                found[f"{scene.id} {moment}"] = digest.hexdigest()
            found[f"{scene.id} approach"] = simulated.episode.trace_sha256
            for action, trace in {"truth": simulated.trace, **simulated.rollouts}.items():
                digest = hashlib.sha256()
                for column in sorted(trace.columns):
                    digest.update(trace[column].tobytes())
                found[f"{scene.id} {action}"] = digest.hexdigest()
    return found


def environments() -> dict[str, dict[str, str]]:
    """Return the settings that change which instructions libraries select."""
    chosen = importlib.import_module("numpy._core._multiarray_umath")
    here = [name for name in chosen.__cpu_dispatch__ if chosen.__cpu_features__.get(name)]
    return {
        "another order": {"ORDER": "reversed"},
        "OPENBLAS_CORETYPE=Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
        f"NPY_DISABLE_CPU_FEATURES={' '.join(here)}": {"NPY_DISABLE_CPU_FEATURES": " ".join(here)},
        "GLIBC_TUNABLES without AVX and FMA": {
            "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4,-AVX512F"
        },
        "NUMBA_CPU_NAME=generic": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    }


def hashes(name: str) -> list[Row]:
    """Run the same scenes in fresh processes under other settings and count the differences."""
    plain = json.loads(child("hashes", name, {}))
    rows = []
    for what, settings in tqdm(environments().items(), desc="hashes", disable=None):
        other = json.loads(child("hashes", name, settings))
        differing = [key for key in plain if plain[key] != other.get(key)]
        for key in differing:
            print(f"{what}: {key} differs", file=sys.stderr)
        label = f"hashes of {len(plain)} that differ, {what}"
        rows.append(row(label, len(differing), "", 0.0, is_most=True))
    return rows


# ---------------------------------------------------------------- the frame


def child(part: str, name: str, settings: Mapping[str, str]) -> str:
    """Run one part in a fresh process and return its last line of output."""
    command = [sys.executable, str(Path(__file__).resolve()), "--child", part, "--simulator", name]
    if settings.get("ORDER") == "reversed":
        command.append("--reversed")
    environment = {**os.environ, **settings}
    done = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, text=True, check=True
    ).stdout
    return done.strip().splitlines()[-1]


def row(name: str, value: float, unit: str, target: float, *, is_most: bool = False) -> Row:
    """Return one row of the report; the value must be at least, or at most, the target."""
    return {
        "name": name,
        "value": round(value, 3),
        "unit": unit,
        "target": target,
        "holds": value <= target if is_most else value >= target,
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; return 0 if every target holds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, last line")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--simulator", default="pybullet")
    parser.add_argument("--child", choices=("memory", "hashes"), help=argparse.SUPPRESS)
    parser.add_argument("--reversed", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.child == "memory":
        print(json.dumps(watch_memory(options.simulator)))
        return 0
    if options.child == "hashes":
        print(json.dumps(digests(options.simulator, is_reversed=options.reversed)))
        return 0
    parts = {
        "rate": rate, "processes": processes, "study": study, "memory": memory, "hashes": hashes,
    }  # fmt: skip
    rows = [one for part in options.only for one in parts[part](options.simulator)]
    if options.json:
        print(json.dumps(rows))
    else:
        for one in rows:
            limit = "holds" if one["holds"] else "FAILS"
            print(
                f"{one['name']!s:78} {one['value']:>9} {one['unit']!s:20} {limit} {one['target']}"
            )
    return 0 if all(one["holds"] for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

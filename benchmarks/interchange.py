"""Exports of a study's scenes, twins and demands, judged by esmini, ASAM's checkers and our own reader.

usage: interchange.py [STUDY] [--every N] [--json] [--skip PART ...]

Without a study, the thirty scenes of the tests are taken. The results are printed as they come, with `--json` as one
object at the end.

`ESMINI_LIB` is the path of esmini's library; without it nothing is played. `ASAM_PYTHON` is an interpreter with
`asam-qc-openscenarioxml` and `asam-qc-opendrive`; without it nothing is checked. `OMEGA_PYTHON` is an interpreter with
`omega-prime`; without it no trace is validated.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from _esmini import LIBRARY, played
from lxml import etree

from oodscen import Episode, Scene, Study, make_catalogue
from oodscen.data import Catalogue
from oodscen.data._pairing import scene_of
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.driving._motion.triggers import is_due
from oodscen.driving._roads.building import load_corridor
from oodscen.interchange import read_openscenario, verdict
from oodscen.interchange._moving import UnrenderedSimulator
from oodscen.interchange._recording import RecordedRun, ordinary_twin, replayed
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._verdicts.poses import PlayedPoses
from oodscen.interchange._verdicts.verdict import PlayedVerdict
from oodscen.interchange._writing.entities import entities
from oodscen.interchange._writing.reactions import reactions
from oodscen.interchange._writing.reactive import followers
from oodscen.interchange._writing.replay import write_course
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.interchange._writing.storyboard import Storyboard
from oodscen.interchange._writing.trajectories import phases, reference_poses
from oodscen.protocols import Driver, Observation, Simulator, State
from oodscen.stages._simulate import simulate

_CHECK = """
import json, logging, sys
logging.disable(logging.CRITICAL)
from qc_baselib import Configuration, Result
import qc_opendrive.main as roads
import qc_openscenario.main as scenarios
found, total = [], 0
for path in sys.argv[1:]:
    checks = roads if path.endswith(".xodr") else scenarios
    name = checks.constants.BUNDLE_NAME
    settings, result = Configuration(), Result()
    settings.set_config_param("InputFile", path)
    settings.register_checker_bundle(checker_bundle_name=name)
    result.register_checker_bundle(name=name, build_date="", description="", version="", summary="")
    result.set_result_version("1")
    checks.run_checks(settings, result)
    total += 1
    for checker in result.get_checker_ids(name):
        if result.get_checker_status(checker).value == "error":
            found.append(f"{path}: {checker} crashed")
        for issue in result.get_issues(checker_bundle_name=name, checker_id=checker):
            found.append(f"{path}: {issue.rule_uid}: {issue.description}")
print(json.dumps([total, found]))
"""


_OMEGA = """
import json, sys, warnings
warnings.simplefilter("ignore")
from omega_prime import Recording, metrics
wanted = metrics.MetricManager(metrics=[
    metrics.vel, metrics.distance_traveled, metrics.timegaps_and_min_timegaps, metrics.curvilinear_projection,
    metrics.ttc_and_thw,
])
found = {}
for path in sys.argv[1:]:
    try:
        run = Recording.from_file(path, validate=True, parse_map=True)
        assert run.map is not None, "has no map"
        table = wanted.compute(run, ego_id=run.host_vehicle_idx)[1]["ttc_and_thw"]
        columns = [table[name].to_list() for name in ("idx", "total_nanos_ego", "TTC")]
        found[path] = [row for row in zip(*columns) if row[2] is not None]
    except Exception as error:
        found[path] = f"{type(error).__name__}: {error}"[:500]
print(json.dumps(found))
"""


class _OneDriver(UnrenderedSimulator):
    """Tries an action as one driver on one road, as a recording does, and not as several."""

    rehearse = None  # type: ignore[assignment]


class _Slower(Cruise):
    """Brakes gently for a while, then holds its speed."""

    change = -1.5

    def accelerate(self, observation: Observation) -> float:
        return self.change if 0.3 <= observation.time < 1.8 else 0.0


class _Faster(_Slower):
    change = 1.5


SAMPLE = Path(__file__).parents[1] / "tests" / "interchange" / "scenes.jsonl"
EGOS = {"blind": Cruise, "slower": _Slower, "faster": _Faster}


PARTS = ("export", "checks", "round", "traces", "replay", "reactive")
TTC_SCENES = 50
"""Number of scenes in which omega-prime's time to collision is compared with ours."""
_SLIDES = 0.02
"""Sine of the angle between motion and heading from which a body slides."""
FOUND: dict[str, object] = {}
"""The results by name."""


def tell(name: str, value: object, misses: Sequence[str] = ()) -> None:
    FOUND[name] = value
    print(f"{name}: {value}", *misses, sep="\n  ", file=sys.stderr)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=Path, nargs="?")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--skip", nargs="*", default=(), choices=PARTS)
    given = parser.parse_args()
    if given.study is None:
        lines = SAMPLE.read_text("utf-8").splitlines()
        scenes, catalogue = [Scene.parse(line) for line in lines], make_catalogue("pybullet")
        demands = dict[str, Scene]()
    else:
        study = Study.open(given.study)
        scenes, catalogue = study.scenes, make_catalogue(study.config.simulator)
        demands = {scene_of(demand.id): demand for demand in study.demands}
    scenes = scenes[:: given.every]
    scenes += [demands[scene.id] for scene in scenes if scene.id in demands]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        if "export" not in given.skip:
            export(scenes, catalogue, folder, "checks" not in given.skip)
        if "round" not in given.skip:
            round_trips(scenes, catalogue, folder / "round")
        interpreter = os.environ.get("OMEGA_PYTHON")
        if interpreter and "traces" not in given.skip:
            traces(scenes, catalogue, folder / "traces", interpreter)
        if LIBRARY and "replay" not in given.skip:
            replays(scenes, catalogue, folder / "played")
        if LIBRARY and "reactive" not in given.skip:
            reactive(scenes, catalogue, folder / "played")
    if given.json:
        print(json.dumps(FOUND))


def round_trips(scenes: list[Scene], catalogue: Catalogue, folder: Path) -> None:
    same = 0
    for scene in scenes:
        path = to_openscenario(scene, catalogue, mode="reactive").save(folder)
        same += read_openscenario(path, catalogue).scene == scene
    tell("scenes that come back equal", f"{same} of {len(scenes)}")


def with_twins(scenes: list[Scene], catalogue: Catalogue) -> Iterator[Scene]:
    for scene in scenes:
        yield scene
        if not scene.is_ordinary:
            yield ordinary_twin(scene, catalogue)


def export(scenes: list[Scene], catalogue: Catalogue, folder: Path, checks: bool) -> None:
    items = list(with_twins(scenes, catalogue))
    for mode in ("replay", "reactive"):
        begun, busy = time.perf_counter(), time.process_time()
        sizes = [
            to_openscenario(item, catalogue, mode=mode).save(folder / mode).stat().st_size
            for item in items
        ]
        spent = time.perf_counter() - begun
        worked = time.process_time() - busy
        size = np.mean(sizes) / 1e3
        tell(
            mode, f"{len(sizes)} files in {spent:.1f} s, {worked:.1f} s of CPU, {size:.0f} kB each"
        )
        if checks and (interpreter := os.environ.get("ASAM_PYTHON")):
            check(mode, interpreter, sorted((folder / mode).iterdir()))


def check(mode: str, interpreter: str, paths: list[Path]) -> None:
    found, total = [], 0
    for first in range(0, len(paths), 400):
        names = list(map(str, paths[first : first + 400]))
        done = subprocess.run(
            [interpreter, "-c", _CHECK, *names], capture_output=True, text=True, check=True
        )
        count, issues = json.loads(done.stdout.splitlines()[-1])
        total, found = total + count, found + issues
    tell(f"issues of ASAM's checkers, {mode}", f"{len(found)} in {total} files", found[:5])


def traces(scenes: list[Scene], catalogue: Catalogue, folder: Path, interpreter: str) -> None:
    """Have omega-prime validate traces, and compare its time to collision with ours."""
    folder.mkdir()
    seen, valid, apart, misses = 0, 0, dict[str, float](), []
    for first in range(0, len(scenes), 20):
        part = scenes[first : first + 20]
        for one in part:
            path = folder / f"{one.id}.mcap"
            path.write_bytes(osi_trace(one, catalogue, container="mcap"))
        paths = [str(folder / f"{one.id}.mcap") for one in part]
        done = subprocess.run(
            [interpreter, "-c", _OMEGA, *paths], capture_output=True, text=True, check=True
        )
        told = json.loads(done.stdout.splitlines()[-1])
        for one, path in zip(part, paths, strict=True):
            if isinstance(told[path], str):
                misses.append(f"{one.id}: {told[path]}")
                continue
            valid += 1
            if told[path]:
                apart[one.id] = ttc_apart(one, catalogue, told[path])
        seen += len(part)
        if len(apart) >= TTC_SCENES:
            break
    misses += [f"{name}: {share:.4f}" for name, share in apart.items() if share > 0.01]
    near = sum(share <= 0.01 for share in apart.values())
    tell("traces in MCAP that are valid for omega-prime", f"{valid} of {seen}")
    worst = f"; worst {max(apart.values()):.2%}" if apart else ""
    tell(
        "scenes whose time to collision by omega-prime is within 1 %",
        f"{near} of {len(apart)}{worst}",
        misses,
    )


def ttc_apart(scene: Scene, catalogue: Catalogue, told: Sequence[tuple[int, int, float]]) -> float:
    """Return the largest relative difference between omega-prime's time to collision and ours.

    Both are between centres along the ego's way; ours is taken from the states of the simulation. Moments at which
    a body slides off its heading are left out: omega-prime takes motion to be along the heading.
    """
    run = replayed(scene, UnrenderedSimulator(catalogue), "keep_speed", 0)
    corridor = load_corridor(scene.map, catalogue)
    ways = np.gradient(run.poses[:, :, :2], run.dt, axis=0)
    worst = 0.0
    for row, nanos, its in told:
        step = round(nanos * 1e-9 / run.dt)
        vx, vy = ways[step, row]
        slide = np.arctan2(vy, vx) - run.poses[step, row, 3]
        if np.hypot(vx, vy) > 0.1 and abs(np.sin(slide)) > _SLIDES:
            continue
        speeds = [
            run.speeds[step, body]
            * corridor.alignment(run.places[step, body, 0], run.poses[step, body, 3])
            for body in (0, row)
        ]
        ahead = run.places[step, row, 0] - run.places[step, 0, 0]
        ours = ahead / (speeds[0] - speeds[1]) if speeds[0] != speeds[1] else np.inf
        worst = max(worst, abs(its - ours) / abs(ours))
    return float(worst)


def replays(scenes: list[Scene], catalogue: Catalogue, folder: Path) -> None:
    simulator, worst, misses, others = UnrenderedSimulator(catalogue), [], [], []
    one_driver = _OneDriver(catalogue)
    for scene in scenes:
        path = to_openscenario(scene, catalogue, target="esmini", action="stop").save(folder)
        truth = replayed(scene, simulator, "stop", 0)
        run = played(path, truth.dt, len(truth.time) - 1)
        path.unlink()
        if run.error or len(run.time) != len(truth.time):
            misses.append(f"{scene.id}: {run.error or 'ended early'}")
            continue
        ours = simulate(
            scene, one_driver, actions=("stop",), render=False, reaction=(NOMINAL_REACTION_S,)
        ).episode
        its = verdict(scene, PlayedPoses(run.names, run.time, run.poses), catalogue)
        if not agree(its, ours):
            others.append(f"{scene.id}: {its.decision_s:g} s for {ours.decision_s:g} s")
        far, high, turned = errors(run.poses, run.names, truth)
        worst.append((far.max(), high.max(), turned.max()))
        if far.max() > 1e-3 or high.max() > 1e-3 or turned.max() > 1.0:
            misses.append(
                f"{scene.id}: {far.max():.4f} m, {high.max():.4f} m up, {turned.max():.2f} deg"
            )
    most = np.max(worst, axis=0)
    tell(
        "replays in esmini within 1 mm and 1 degree",
        f"{len(scenes) - len(misses)} of {len(scenes)}; worst {1e3 * most[0]:.3f} mm, {1e3 * most[1]:.3f} mm in "
        f"height, {most[2]:.3f} deg",
        misses,
    )
    tell(
        "verdicts from the poses of esmini equal to ours",
        f"{len(worst) - len(others)} of {len(scenes)}",
        others,
    )


def agree(its: PlayedVerdict, ours: Episode) -> bool:
    """Return whether two verdicts on the same run are the same."""
    outcome = ours.actions["stop"]
    margins = (its.outcome.margin_m or 0.0, outcome.margin_m or 0.0)
    return (
        its.is_complete
        and its.decision_s == ours.decision_s
        and its.decision_fired == ours.decision_fired
        and its.outcome.safe == outcome.safe
        and its.outcome.contacts == outcome.contacts
        and its.outcome.off_road == outcome.off_road
        and abs(margins[0] - margins[1]) <= 0.01
    )


def errors(poses: np.ndarray, names: tuple[str, ...], truth: RecordedRun) -> list[np.ndarray]:
    """Return the errors of position, height and heading: [steps, bodies] each."""
    rows = [names.index(name) for name in truth.ids]
    count = min(len(poses), len(truth.time))
    its, ours = poses[:count, rows], truth.poses[:count]
    apart = its - ours
    turned = np.abs((apart[:, :, 3] + np.pi) % (2.0 * np.pi) - np.pi)
    return [np.hypot(apart[:, :, 0], apart[:, :, 1]), np.abs(apart[:, :, 2]), np.degrees(turned)]


def reactive(scenes: list[Scene], catalogue: Catalogue, folder: Path) -> None:
    simulator = UnrenderedSimulator(catalogue)
    fired, near, through, misses = Counter[str](), Counter[str](), 0, []
    for scene in scenes:
        run = reactions(scene, catalogue, 0)
        written = to_openscenario(scene, catalogue, mode="reactive", target="esmini", ego=False)
        corridor = load_corridor(scene.map, catalogue)
        steps = len(run.nominal.time) - 1
        for label, make in EGOS.items():
            states = driven(scene, simulator, make, steps)
            ours = {name: simulator.world.motion(name).triggered for name in states[0].ids[1:]}
            contact = next((state.step for state in states if state.contacts), steps)
            due = (state.time for state in states if is_due(scene.decision, None, state, corridor))
            truth = RecordedRun.of(states, corridor, next(due, None))
            path = written.save(folder)
            path.write_bytes(with_ego(written.xosc, scene, catalogue, truth))
            found = played(path, truth.dt, contact, truth.speeds[:, 0])
            path.unlink()
            if found.error:
                misses.append(f"{scene.id}, {label}: {found.error}")
                continue
            judge(scene, label, truth, ours, found, fired, near, misses)
            behind = followers(scene, run)
            rows = [found.names.index(name) for name in behind]
            ego = found.names.index("ego")
            for row, name in zip(rows, behind, strict=True):
                through += int(overlaps(scene, catalogue, found.poses, ego, row, name))
    total, decisions = sum(fired.values()), sum(near.values())
    tell("triggers in esmini at the same step", f"{fired['same']} of {total}", misses)
    tell("hazards within 1 cm at the decision", f"{near['same']} of {decisions}")
    tell("followers through the ego", through)


def driven(
    scene: Scene, simulator: Simulator, make: Callable[[], Driver], steps: int
) -> list[State]:
    """Return the states of a drive of so many steps, contacts or not."""
    first, driver = simulator.reset(scene, 0), make()
    return [
        first,
        *(simulator.step(driver.act(simulator.observe())) for _ in range(steps)),
    ]


def judge(
    scene: Scene,
    label: str,
    truth: RecordedRun,
    ours: dict[str, float],
    found: object,
    fired: Counter[str],
    near: Counter[str],
    misses: list[str],
) -> None:
    last = found.time[-1]
    for actor in scene.actors:
        event = f"react_{actor.id}_0"
        its = found.started.get(event)
        mine = ours[actor.id] if ours[actor.id] <= last else -1.0
        if actor.behaviour.trigger.kind == "time" or (its is None and mine < 0.0):
            continue
        same = its is not None and mine >= 0.0 and abs(its - mine) < 0.5 * truth.dt
        fired["same" if same else "other"] += 1
        if not same:
            misses.append(f"{scene.id}, {label}: {actor.id} fires at {its}, not {mine}")
    step = round(truth.decision_s / truth.dt) if truth.decision_s is not None else None
    if step is None or step >= len(found.time):
        return
    far, _, _ = errors(found.poses, found.names, truth)
    rows = [row for row, name in enumerate(truth.ids) if name in scene.hazard.actors]
    apart = far[step, rows].max(initial=0.0)
    near["same" if apart <= 0.01 else "other"] += 1
    if apart > 0.01:
        misses.append(f"{scene.id}, {label}: hazard {apart:.3f} m off at the decision")


def overlaps(
    scene: Scene, catalogue: Catalogue, poses: np.ndarray, ego: int, row: int, name: str
) -> bool:
    sizes = {entity.name: entity.asset for entity in entities(scene, catalogue)}
    for its, own in zip(poses[:, row], poses[:, ego], strict=True):
        boxes = [
            Footprint(pose[0], pose[1], pose[3], sizes[who].length, sizes[who].width)
            for who, pose in ((name, its), ("ego", own))
        ]
        if gap(*boxes) <= 0.0:
            return True
    return False


def with_ego(xosc: bytes, scene: Scene, catalogue: Catalogue, truth: RecordedRun) -> bytes:
    """Add the course of another ego to a file without one."""
    root = etree.fromstring(xosc, etree.XMLParser(remove_blank_text=True))
    corridor = load_corridor(scene.map, catalogue)
    course = reference_poses(truth, 0, entities(scene, catalogue)[0], corridor)
    board = Storyboard(etree.Element("parent"), scene, "other")
    write_course(board.maneuver("ego"), "ego", truth.time, course, phases(course))
    act = root.find("Storyboard/Story/Act")
    for group in act.findall("ManeuverGroup"):
        if group.get("name") == "group_ego":
            act.remove(group)
    act.insert(len(act.findall("ManeuverGroup")), board.act[0])
    return etree.tostring(root)


if __name__ == "__main__":
    sys.exit(main())

import dataclasses
import gc
import itertools
import math
import mmap
import os
import subprocess
import threading

import numpy as np
import pytest

from oodscen.data._catalogue import RoadMap
from oodscen.data._weather import Weather
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import SpawnError, UnknownComponent, UsageError
from oodscen.protocols import Control, Frame, State
from oodscen.testing import check_simulator, simulator_checks
from oodscen.testing._check import PARTS, QUICK, examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._kit.findings import Finding, NotApplicable, PartResult
from oodscen.testing._kit.isolation import process_faults
from oodscen.testing._new.adapter import MySimulator
from tests.driving.networks import file, lane, road
from tests.driving.staging import actor, scene

SMALL = FLAT_CATALOGUE.model_copy(
    update={
        "assets": tuple(map(FLAT_CATALOGUE.asset, ("car", "cyclist", "adult"))),
        "behaviours": FLAT_CATALOGUE.behaviours[:2],
        "maps": SHIPPED_MAPS[:1],
    }
)


class Small(FlatSimulator):
    """Offers little, so that the check is quick."""

    def catalogue(self):
        return SMALL


def replaced(state: State, **fields: object) -> State:
    return State(**{**vars(state), **fields})


class WrongTime(Small):
    def step(self, control):
        super().step(control)
        return replaced(super().step(control))


class WrongTypes(Small):
    def _publish(self):
        state = super()._publish()
        return replaced(state, speeds=state.speeds.astype(np.float32))


class WrongIds(Small):
    def _publish(self):
        state = super()._publish()
        return replaced(state, ids=tuple(reversed(state.ids)))


class SlimBodies(Small):
    def _publish(self):
        state = super()._publish()
        return replaced(state, gaps=state.gaps + 0.1)


class Remembers(Small):
    resets = itertools.count()

    def reset(self, scene, seed):
        return super().reset(scene, seed + next(self.resets))


class Blank(Small):
    def draw(self, camera):
        frame = super().draw(camera)
        return Frame(np.zeros_like(frame.rgb), frame.depth, frame.ids)


class FlippedIds(Small):
    def draw(self, camera):
        frame = super().draw(camera)
        return Frame(frame.rgb, frame.depth, np.where(frame.ids > 1, 0, frame.ids))


class Refuses(Small):
    def spawn(self, actor_id, asset, state, pose):
        if asset.id == "cyclist":
            raise SpawnError(actor_id, asset.id, pose, "no mesh")
        super().spawn(actor_id, asset, state, pose)


class ClosesOnce(Small):
    closed = 0

    def release(self):
        self.closed += 1
        if self.closed > 1:
            raise RuntimeError("already closed")


class Untyped(Small):
    def reset(self, scene, seed):
        if scene.map not in [road.id for road in SMALL.maps]:
            raise KeyError(scene.map)
        return super().reset(scene, seed)


class Boastful(Small):
    def catalogue(self):
        road = SHIPPED_MAPS[0].model_copy(update={"lanes": 2, "length_m": 5000.0})
        return SMALL.model_copy(update={"maps": (road,)})


class SteersRight(Small):
    def step(self, control):
        return super().step(Control(control.acceleration, -control.steering))


class Reuses(Small):
    kept = None

    def _publish(self):
        state = super()._publish()
        if state.step == 0:
            self.kept = state
        else:
            self.kept.poses.setflags(write=True)
            self.kept.poses[:] = state.poses
        return state


class ReusesFrames(Small):
    """Draws into the same arrays every time; `draw` may, since the base class copies."""

    def render(self, camera):
        frame = super().render(camera)
        buffers = vars(self).setdefault("buffers", {})
        kept = buffers.setdefault(frame.rgb.shape, frame)
        for name in ("rgb", "depth", "ids"):
            getattr(kept, name)[:] = getattr(frame, name)
        return kept


class Rewrites(Small):
    """Changes the scene that it is given."""

    def reset(self, scene, seed):
        state = super().reset(scene, seed)
        object.__setattr__(scene.ego, "speed", 1.0)
        return state


class NamesAText(Small):
    packages = "numpy"


class ForgetsSpeed(Small):
    def restore(self, snapshot):
        state = super().restore(snapshot)
        self.world.ego.speed = 0.0
        return state


class Hopeful(Small):
    def rehearse(self, action, seconds, **variation):
        return True


class Hopeless(Small):
    def rehearse(self, action, seconds, **variation):
        return False


class RehearsesForReal(Small):
    def rehearse(self, action, seconds, **variation):
        self.step(Control())
        return super().rehearse(action, seconds, **variation)


class Swallows(Small):
    def draw(self, camera):
        hidden = [asset.id == "adult" for asset in self._assets]
        frame = super().draw(camera)
        ids = np.where(np.isin(frame.ids - 1, np.flatnonzero(hidden)), 0, frame.ids)
        return dataclasses.replace(frame, ids=ids)


class Sunny(Small):
    def load(self, corridor, scene, seed):
        super().load(corridor, scene, seed)
        self._weather = Weather()


class Hoards(Small):
    kept: list[mmap.mmap] = []

    def reset(self, scene, seed):
        block = mmap.mmap(-1, 4_000_000)
        block.write(b"x" * 4_000_000)
        self.kept.append(block)
        return super().reset(scene, seed)

    def release(self):
        while self.kept:
            self.kept.pop().close()


class KeepsFiles(Small):
    kept: list[object] = []

    def reset(self, scene, seed):
        self.kept.append(open(os.devnull))  # noqa: SIM115
        return super().reset(scene, seed)

    def release(self):
        while self.kept:
            self.kept.pop().close()


class Floating(Small):
    def draw(self, camera):
        frame = super().draw(camera)
        return dataclasses.replace(
            frame, depth=np.where(frame.ids > 1, np.inf, frame.depth).astype(np.float32)
        )


def test_the_flat_simulator_keeps_the_protocol() -> None:
    told: list[tuple[str, int, int]] = []
    check_simulator("flat", resets=40, progress=lambda *counts: told.append(counts))
    assert told == [("check", done, len(PARTS)) for done in range(len(PARTS) + 1)]


@pytest.mark.parametrize("name", ["Carla/Maps/Town10HD", "Rue de l’Église", "x" * 300])
def test_maps_may_have_names_that_no_scene_can_have(name) -> None:
    class Foreign(Small):
        def catalogue(self):
            road = SHIPPED_MAPS[0].model_copy(update={"id": name})
            return SMALL.model_copy(update={"maps": (road,)})

    check_simulator(Foreign, parts=("determinism",))


def test_unknown_parts_are_refused() -> None:
    with pytest.raises(UnknownComponent):
        check_simulator(FlatSimulator, parts=("framez",))


@pytest.mark.parametrize(
    "options",
    [
        {"parts": ()},
        {"parts": ("leaks", "process"), "quick": True},
        *({"parts": ("leaks",), "resets": resets} for resets in (0, -3, 4, 7.5)),
    ],
)
def test_a_check_of_nothing_is_refused(options) -> None:
    with pytest.raises(UsageError, match="|".join(options)):
        check_simulator(FlatSimulator, **options)


def test_a_result_that_depends_on_the_process_is_found(tmp_path, monkeypatch) -> None:
    (tmp_path / "process_bound.py").write_text(
        "import os\n"
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Bound(FlatSimulator):\n"
        "    def reset(self, scene, seed):\n"
        "        weather = scene.weather.model_copy(\n"
        "            update={'sun_elevation_deg': float(os.getpid() % 7)}\n"
        "        )\n"
        "        return super().reset(scene.model_copy(update={'weather': weather}), seed)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.syspath_prepend(str(tmp_path))
    scenes = [scene(map="residential_two_lane")]
    with FlatSimulator() as simulator:
        assert process_faults(simulator, "flat", scenes) == []
    faults = process_faults(_Fixed(), "process_bound:Bound", scenes)
    assert faults == [Finding("scene test", "another result in a fresh process")]


def test_what_a_fresh_process_cannot_import_does_not_apply() -> None:
    with FlatSimulator() as simulator:
        for source in (lambda: FlatSimulator(), "__main__:Mine"):
            with pytest.raises(NotApplicable, match="cannot import"):
                process_faults(simulator, source, [])


def test_a_script_without_a_main_guard_is_named(tmp_path, monkeypatch) -> None:
    (tmp_path / "unguarded.py").write_text(
        "from oodscen.testing import check_simulator\n"
        "from oodscen.testing._flat import FlatSimulator\n\n\n"
        "class Mine(FlatSimulator):\n    pass\n\n\n"
        "check_simulator('unguarded:Mine', parts=('process',))\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.syspath_prepend(str(tmp_path))
    with FlatSimulator() as simulator:
        faults = process_faults(simulator, "unguarded:Mine", [scene(map="residential_two_lane")])
    assert ["if __name__ == '__main__'" in fault.message for fault in faults] == [True]


def test_findings_that_are_alike_are_one_line() -> None:
    alike = tuple(Finding(f"behaviour {n}", f"is {n} m off") for n in range(9))
    lines = PartResult("motion", (*alike, Finding("", "is late"))).lines()
    assert lines == [
        "motion: 9 behaviours (0, 1, 2, 3, 4, 5 and 3 more): is 0 m off (the first)",
        "motion: is late",
    ]


def test_every_part_is_one_named_check() -> None:
    checks = simulator_checks(Small)
    assert [str(check) for check in checks] == list(PARTS)
    assert [str(check) for check in simulator_checks(Small, quick=True)] == list(QUICK)
    named = {str(check): check for check in checks}
    named["catalogue"]()
    with pytest.raises(AssertionError, match="controls: left must be positive"):
        {str(check): check for check in simulator_checks(SteersRight)}["controls"]()


class Noisy(Small):
    noise = np.random.default_rng(0)

    def draw(self, camera):
        frame = super().draw(camera)
        noise = self.noise.integers(0, 3, frame.rgb.shape, dtype=np.uint8)
        return dataclasses.replace(frame, rgb=np.minimum(frame.rgb, 250) + noise)


def test_pixels_that_do_not_repeat_pass_when_only_states_count() -> None:
    with pytest.raises(AssertionError, match="another result"):
        check_simulator(Noisy, parts=("determinism",))
    check_simulator(Noisy, parts=QUICK, states_only=True)


def test_what_cannot_be_tried_says_why() -> None:
    plain = type("Plain", (Small,), {"snapshot": None, "restore": None})
    results = {
        examine_part.part: examine_part
        for examine_part in examine_parts(plain, parts=("snapshot", "catalogue"))
    }
    assert results["snapshot"].inapplicable
    assert results["snapshot"].holds
    assert not results["catalogue"].inapplicable


class Own(Small):
    """Has a behaviour that no other simulator has."""

    def catalogue(self):
        kind = FLAT_CATALOGUE.behaviour("follow_lane").model_copy(
            update={"id": "mobil", "like": "follow_lane"}
        )
        return SMALL.model_copy(update={"behaviours": (*SMALL.behaviours, kind)})


class OwnElsewhere(Own):
    """Starts that behaviour beside its place."""

    def reset(self, scene, seed):
        moved = [
            one.model_copy(update={"placement": one.placement.model_copy(update={"offset_m": 0.8})})
            if one.behaviour.name == "mobil"
            else one
            for one in scene.actors
        ]
        return super().reset(scene.model_copy(update={"actors": tuple(moved)}), seed)


def test_of_a_behaviour_of_its_own_the_start_is_compared_and_the_rest_is_said() -> None:
    result, _ = examine_parts(Own, parts=("motion",))
    assert result.holds
    assert result.note.endswith("only starts are compared: mobil")
    result, _ = examine_parts(OwnElsewhere, parts=("motion",))
    (line,) = result.lines()
    assert "(mobil, mobil in an oncoming lane): starts 0.8 m from its place" in line


class StraightOn(MySimulator):
    """Drivers keep their heading in bends."""

    def _follow(self, mover, acceleration):
        x, y, yaw = mover.x, mover.y, mover.yaw
        super()._follow(mover, acceleration)
        way = mover.speed * self.dt
        mover.x, mover.y, mover.yaw = x + way * math.cos(yaw), y + way * math.sin(yaw), yaw


class Gripping(MySimulator):
    """The tyres of the ego never slide, on roads that are always dry."""

    def catalogue(self):
        kept = super().catalogue()
        dry = kept.weather.model_copy(update={"min_friction": 1.0})
        return kept.model_copy(update={"weather": dry})

    def begin(self, staged, seed):
        super().begin(staged, seed)
        self.friction = 10.0


def test_a_catalogue_without_anything_to_hit_needs_no_contact() -> None:
    class Flat(Small):
        def catalogue(self):
            return SMALL.model_copy(update={"assets": (FLAT_CATALOGUE.asset("puddle"),)})

    result, _ = examine_parts(Flat, parts=("motion",))
    assert result.holds, result.lines()
    assert "contact not tried, no asset blocks the way" in result.note


def test_runs_without_room_are_named() -> None:
    class Long(Small):
        def catalogue(self):
            long = FLAT_CATALOGUE.asset("car").model_copy(update={"length": 80.0})
            return SMALL.model_copy(update={"assets": (long,)})

    result, _ = examine_parts(Long, parts=("motion",))
    assert "no room to stage" in result.note, (result.note, result.lines())


def test_impossible_scenes_are_impossible_on_every_map_and_with_every_asset(tmp_path) -> None:
    right = "".join(lane(-index) for index in range(1, 9))
    (tmp_path / "wide.xodr").write_bytes(file(road("1", 600.0, right=right)))
    wide = RoadMap(
        id="wide", description="a motorway", file=str(tmp_path / "wide.xodr"), start_m=100.0,
        lanes=8, speed_limit=30.0, length_m=600.0,
    )  # fmt: skip
    puddle = FLAT_CATALOGUE.asset("puddle")
    for changes in (
        {"assets": (puddle,)},
        {"assets": (puddle, *SMALL.assets)},
        {"maps": (wide, *SMALL.maps)},
    ):
        offered = SMALL.model_copy(update=changes)
        factory = type("Offering", (Small,), {"catalogue": lambda _, offered=offered: offered})
        result, _ = examine_parts(factory, parts=("refusals",))
        assert result.holds, result.lines()


def test_what_motion_has_nothing_to_try_with_is_said() -> None:
    result, _ = examine_parts(Small, parts=("motion",))
    assert result.holds
    assert "bends not tried, no map has a bend" in result.note


class _Fixed(FlatSimulator):
    """What a process-bound simulator gives in no process: a sun that no process has."""

    def reset(self, scene, seed):
        weather = scene.weather.model_copy(update={"sun_elevation_deg": 30.0})
        return super().reset(scene.model_copy(update={"weather": weather}), seed)


@pytest.mark.parametrize(
    ("factory", "part", "words"),
    [
        (WrongTime, "maps", ["step is 2, not 1", "time is 0.1"]),
        (WrongTypes, "maps", ["speeds is float32"]),
        (WrongIds, "behaviours", ["ids are"]),
        (SlimBodies, "behaviours", ["the gap to", "between the boxes"]),
        (Remembers, "determinism", ["another result"]),
        (Rewrites, "determinism", ["changed the scene"]),
        (NamesAText, "catalogue", ["packages is 'numpy', not a list of names"]),
        (Blank, "frames", ["blank"]),
        (FlippedIds, "frames", ["no pixel with id 2"]),
        (Refuses, "assets", ["cyclist", "no mesh"]),
        (ClosesOnce, "catalogue", ["close may be called twice"]),
        (Untyped, "refusals", ["an unknown map is refused by a KeyError"]),
        (Boastful, "maps", ["has 1 lanes, not 2", "lie ahead"]),
        (ForgetsSpeed, "snapshot", ["snapshot"]),
        (Hopeful, "rehearsal", ["is True, not False"]),
        (Hopeless, "rehearsal", ["is False, not True"]),
        (RehearsesForReal, "rehearsal", ["changes what follows"]),
        (SteersRight, "controls", ["left must be positive"]),
        (Reuses, "maps", ["a later step changed an earlier state"]),
        (ReusesFrames, "frames", ["a later render changed an earlier frame"]),
        (Swallows, "appearance", ["asset adult", "pixels"]),
        (Sunny, "weather", ["lowest sun", "looks like a clear day"]),
        (Hoards, "leaks", ["MiB of memory behind"]),
        (KeepsFiles, "leaks", ["open files behind"]),
        (Floating, "frames", ["no finite depth"]),
        (StraightOn, "motion", ["follow_lane in a bend", "than in the reference world"]),
        (Gripping, "motion", ["steering at friction 1 changes its speed by", "turns it by"]),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_broken_promises_are_found(factory, part: str, words: list[str]) -> None:
    weaving = scene(actor("a", "cyclist", "follow_lane"), map="residential_two_lane")
    if factory is Remembers:
        factory = type("Remembers", (Remembers,), {"catalogue": FlatSimulator.catalogue})
        weaving = scene(actor("a", "cyclist", "wobble"), map="residential_two_lane")
    with pytest.raises(AssertionError) as caught:
        check_simulator(factory, scenes=[weaving], parts=(part,), resets=40)
    for word in words:
        assert word in str(caught.value)


def test_threads_and_processes_that_stay_are_found() -> None:
    ends, started = threading.Event(), []

    class Leaky(Small):
        def reset(self, scene, seed):
            threading.Thread(target=ends.wait, name="poller").start()
            started.append(subprocess.Popen(["sleep", "600"]))
            return super().reset(scene, seed)

    try:
        result, *_ = examine_parts(Leaky, parts=("leaks",), resets=10)
    finally:
        ends.set()
        for process in started:
            process.kill()
            process.wait()
    assert [finding.message for finding in result.findings] == [
        "10 resets leave 6 threads behind",
        "10 resets leave 6 processes behind",
        "close leaves threads behind: poller",
        "close leaves 1 processes behind",
    ]


def test_what_the_caller_froze_stays_frozen() -> None:
    gc.freeze()
    examine_parts(Small, parts=("leaks",), resets=5)
    assert gc.get_freeze_count() > 0


def test_all_findings_are_listed() -> None:
    broken = type("Broken", (Blank, WrongTypes, ClosesOnce), {})
    with pytest.raises(AssertionError) as caught:
        check_simulator(broken, parts=QUICK)
    assert str(caught.value).count("\n  - ") >= 3

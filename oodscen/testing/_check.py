"""The conformance check that every simulator should pass."""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

import numpy as np

from oodscen._progress import Progress, reporting
from oodscen._registry import make_simulator
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, RoadMap
from oodscen.data._scene import Actor, Behaviour, Placement, Scene, Trigger
from oodscen.driving._roads.building import load_corridor
from oodscen.errors import OodscenError, SceneError, SpawnError, UnknownComponent
from oodscen.protocols import Camera, Control, Frame, Simulator, Snapshots, State
from oodscen.testing._appearance import appearance_faults, weather_faults
from oodscen.testing._contact import gap_fault
from oodscen.testing._isolation import leak_faults, process_faults
from oodscen.testing._samples import SMALL, STEPS, follow_lane, plain_scene, run_bytes, sample_scene

Factory = Callable[[], Simulator]

PARTS = (
    "catalogue",
    "maps",
    "assets",
    "appearance",
    "behaviours",
    "weather",
    "determinism",
    "process",
    "controls",
    "snapshot",
    "frames",
    "refusals",
    "leaks",
)
"""The parts of `check_simulator`, in order.

`appearance` renders every asset in every state, `process` repeats the runs in a fresh process, and
`leaks` watches memory and open files over many resets: these three take the longest.
"""

QUICK = tuple(part for part in PARTS if part not in ("appearance", "process", "leaks"))
"""The parts that together take only seconds."""

RESETS = 200
"""Number of resets in the `leaks` part."""


def check_simulator(
    simulator: Factory | str,
    *,
    scenes: Sequence[Scene] | None = None,
    quick: bool = False,
    parts: Collection[str] = PARTS,
    resets: int = RESETS,
    progress: Progress | bool | None = None,
) -> None:
    """Check whether a simulator keeps the promises of the protocol.

    The checks cover:

    - an honest catalogue: every map, behaviour, weather extreme and asset in every state is available and shows;
    - one `dt` per step, and the ids, shapes and dtypes of states and frames;
    - frames that show something, with finite depth and the true ids of bodies;
    - the same bytes for the same scene and seed, whatever ran before, also in a fresh process;
    - gaps that equal those between the catalogue's boxes;
    - snapshots if offered, typed refusals, and a `close` that may be called twice;
    - memory and open files that do not grow.

    Args:
        simulator: A factory of fresh simulators, or a name as in `make_simulator`. Only names, and the
            classes and functions of importable modules, can run in a fresh process; for anything defined in a
            script or notebook that part is skipped with a warning.
        scenes: Additional scenes that must run; by default one per map is made.
        quick: Skip the parts that take more than seconds: `appearance`, `process` and `leaks`.
        parts: The parts to check, of `PARTS`.
        resets: Number of resets in the `leaks` part.
        progress: True for a progress bar, or a callable; it counts the parts.

    Raises:
        AssertionError: Lists every finding, one per line.
        UnknownComponent: If there is no such part.
    """
    for part in parts:
        if part not in PARTS:
            raise UnknownComponent("part", part, PARTS)
    if quick:
        parts = [part for part in parts if part in QUICK]
    factory = partial(make_simulator, simulator) if isinstance(simulator, str) else simulator
    with reporting(progress) as told:
        check = _Check(parts, told)
        with check.finding("the factory works"):
            with factory() as opened:
                check.run(opened, factory, simulator, scenes, resets)
            with check.finding("close may be called twice"):
                opened.close()
                opened.close()
        told("check", len(parts), len(parts))
    if check.findings:
        lines = "".join(f"\n  - {finding}" for finding in check.findings)
        raise AssertionError(f"the simulator breaks its protocol:{lines}")


class _Check:
    """Collects findings, so that one run reports all of them."""

    def __init__(self, parts: Collection[str], progress: Progress) -> None:
        self.findings: list[str] = []
        self.parts = parts
        self.progress = progress
        self.begun = 0

    @contextmanager
    def finding(self, what: str) -> Iterator[None]:
        """Record an exception as a finding instead of stopping."""
        try:
            yield
        except (Exception, SystemExit) as error:
            self.findings.append(f"{what}: {type(error).__name__}: {error}")

    def that(self, holds: bool, what: str) -> None:
        """Record a finding if the condition does not hold."""
        if not holds:
            self.findings.append(what)

    def wants(self, part: str) -> bool:
        """Return whether a part was requested, and if so report that it begins."""
        if part in self.parts:
            self.progress("check", self.begun, len(self.parts))
            self.begun += 1
        return part in self.parts

    def run(
        self,
        simulator: Simulator,
        factory: Factory,
        source: Factory | str,
        scenes: Sequence[Scene] | None,
        resets: int,
    ) -> None:
        """Run all groups of checks."""
        self.that(isinstance(simulator, Simulator), "some members of the protocol are missing")
        self.that(bool(simulator.name), "name is empty")
        self.that(simulator.dt > 0.0, "dt must be positive")
        catalogue = simulator.catalogue()
        if not catalogue.maps or not catalogue.assets:
            self.findings.append("catalogue: has no map or no asset")
            return
        chosen = list(scenes or (plain_scene(catalogue, road) for road in catalogue.maps))
        checks: tuple[tuple[str, Callable[[], None]], ...] = (
            ("catalogue", lambda: self.check_catalogue(simulator, catalogue)),
            ("maps", lambda: self.check_maps(simulator, catalogue)),
            ("assets", lambda: self.check_assets(simulator, catalogue)),
            ("appearance", lambda: self.findings.extend(appearance_faults(simulator))),
            ("behaviours", lambda: self.check_behaviours(simulator, catalogue)),
            ("weather", lambda: self.findings.extend(weather_faults(simulator))),
            ("determinism", lambda: self.check_determinism(simulator, factory, chosen)),
            ("process", lambda: self.findings.extend(process_faults(simulator, source, chosen))),
            ("controls", lambda: self.check_controls(simulator, catalogue)),
            ("snapshot", lambda: self.check_snapshot(simulator, chosen[0])),
            ("frames", lambda: self.check_frames(simulator, catalogue)),
            ("refusals", lambda: self.check_refusals(simulator, catalogue)),
            ("leaks", lambda: self.findings.extend(leak_faults(simulator, chosen, resets))),
        )
        for part, check in checks:
            if self.wants(part):
                with self.finding(part):
                    check()

    def check_maps(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check every map, one after the other."""
        for road in catalogue.maps:
            with self.finding(f"map {road.id}"):
                self.check_map(simulator, catalogue, road)

    def check_behaviours(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check every behaviour, one after the other."""
        for kind in catalogue.behaviours:
            with self.finding(f"behaviour {kind.id}"):
                self.check_behaviour(simulator, catalogue, kind)

    # ------------------------------------------------------------------ the catalogue

    def check_catalogue(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check that the catalogue is static data without duplicates."""
        again = simulator.catalogue()
        self.that(again == catalogue, "catalogue: differs from one call to the next")
        copy = Catalogue.parse(catalogue.to_json())
        self.that(copy == catalogue, "catalogue: changes when it is written and read as JSON")
        for noun, names in (
            ("asset", [asset.id for asset in catalogue.assets]),
            ("behaviour", [kind.id for kind in catalogue.behaviours]),
            ("map", [road.id for road in catalogue.maps]),
        ):
            doubles = sorted({name for name in names if names.count(name) > 1})
            self.that(not doubles, f"catalogue: {noun} ids occur more than once: {doubles}")
        for kind in catalogue.behaviours:
            for name, parameter in kind.parameters.items():
                inside = parameter.minimum <= parameter.default <= parameter.maximum
                self.that(inside, f"behaviour {kind.id}: the default of {name} is out of range")

    def check_map(self, simulator: Simulator, catalogue: Catalogue, road: RoadMap) -> None:
        """Check that a map's entry matches its file and that the map can be driven."""
        corridor = load_corridor(road)
        ego_lanes = len(corridor.ego_lanes)
        oncoming = len(corridor.driving) - ego_lanes
        ahead = corridor.length - corridor.start
        has_shoulder = any(strip.kind == "shoulder" for strip in corridor.strips)
        where = f"map {road.id}"
        self.that(ego_lanes == road.lanes, f"{where}: has {ego_lanes} lanes, not {road.lanes}")
        self.that(
            oncoming == road.oncoming_lanes,
            f"{where}: has {oncoming} oncoming lanes, not {road.oncoming_lanes}",
        )
        self.that(ahead >= road.length_m, f"{where}: only {ahead:.0f} m lie ahead of the start")
        self.that(
            not road.has_shoulder or has_shoulder, f"{where}: says it has a shoulder, has none"
        )
        for lane in range(road.lanes):
            scene = sample_scene(road, (), lane=lane, speed=road.speed_limit)
            self.drive(simulator, scene, f"{where}, lane {lane}")

    def check_assets(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check that every asset can be placed, in every state."""
        road = max(catalogue.maps, key=lambda road: road.length_m)
        wanted = [(asset, state) for asset in catalogue.assets for state in (asset.states or ("",))]
        group: list[Actor] = []
        position, limit = 12.0, min(280.0, road.length_m - 20.0)
        for index, (asset, state) in enumerate(wanted):
            room = 0.5 * max(asset.length, asset.width) + 1.0
            if position + 2.0 * room > limit and group:
                self.reset(simulator, sample_scene(road, tuple(group)))
                group, position = [], 12.0
            place = Placement(ahead_m=position + room)
            group.append(Actor(id=f"a{index}", asset=asset.id, placement=place, state=state))
            position += 2.0 * room
        self.reset(simulator, sample_scene(road, tuple(group)))

    def reset(self, simulator: Simulator, scene: Scene) -> None:
        """Load one scene; record the actors that it refuses."""
        names = {actor.id: f"{actor.asset} {actor.state}".strip() for actor in scene.actors}
        try:
            state = simulator.reset(scene, 0)
        except SpawnError as error:
            self.findings.append(f"asset {names.get(error.actor, error.actor)}: {error}")
        except OodscenError as error:
            self.findings.append(f"assets {', '.join(sorted(set(names.values())))}: {error}")
        else:
            self.check_state(simulator, scene, state, 0, "assets")

    def check_behaviour(
        self, simulator: Simulator, catalogue: Catalogue, kind: BehaviourKind
    ) -> None:
        """Check that a behaviour runs with its defaults, for an asset of each of its categories."""
        offered = {asset.category for asset in catalogue.assets}
        able = [category for category in kind.categories if category in offered]
        self.that(bool(able), f"behaviour {kind.id}: no asset has one of its categories")
        road = max(catalogue.maps, key=lambda road: road.lanes + road.oncoming_lanes)
        for category in able:
            asset = next(one for one in catalogue.assets if one.category == category)
            parameters = {}
            if "lanes" in kind.parameters:
                parameters["lanes"] = 1.0 if len(load_corridor(road).driving) > 1 else 0.0
            belongs = kind.needs_other
            actor = Actor(
                id="a",
                asset=asset.id,
                placement=Placement(ahead_m=35.0),
                behaviour=Behaviour(
                    name=kind.id,
                    trigger=Trigger(value=0.5),
                    parameters=parameters,
                    other="owner" if belongs else None,
                ),
            )
            actors = (actor, *(self.owners(catalogue) if belongs else ()))
            scene = sample_scene(road, actors, speed=5.0)
            self.drive(simulator, scene, f"behaviour {kind.id} of {asset.id}")

    def owners(self, catalogue: Catalogue) -> tuple[Actor, ...]:
        """Return a vehicle for another actor to belong to."""
        vehicle = next(one for one in catalogue.assets if one.category == "vehicle")
        return (Actor(id="owner", asset=vehicle.id, placement=Placement(ahead_m=41.0)),)

    # ------------------------------------------------------------------ states

    def drive(self, simulator: Simulator, scene: Scene, what: str) -> None:
        """Run a scene for some steps and check every state."""
        first = simulator.reset(scene, 0)
        self.check_state(simulator, scene, first, 0, what)
        kept, states = first.fingerprint(), [first]
        for step in range(1, STEPS + 1):
            control = follow_lane(simulator.observe())
            before = len(self.findings)
            states.append(simulator.step(control))
            self.check_state(simulator, scene, states[-1], step, what)
            if len(self.findings) > before:
                return
        fault = gap_fault(states, scene, simulator.catalogue())
        self.that(not fault, f"{what}: {fault}")
        self.that(first.fingerprint() == kept, f"{what}: a later step changed an earlier state")

    def check_state(
        self, simulator: Simulator, scene: Scene, state: State, step: int, what: str
    ) -> None:
        """Check ids, shapes, dtypes, finite values and time."""
        ids = ("ego", *(actor.id for actor in scene.actors))
        count = len(ids)
        self.that(state.ids == ids, f"{what}: ids are {state.ids}, not {ids}")
        for name, array, shape in (
            ("poses", state.poses, (count, 4)),
            ("speeds", state.speeds, (count,)),
            ("gaps", state.gaps, (count,)),
        ):
            good = array.shape == shape and array.dtype == np.float64
            self.that(good, f"{what}: {name} is {array.dtype} {array.shape}, not float64 {shape}")
        finite = bool(np.isfinite(state.poses).all() and np.isfinite(state.speeds).all())
        self.that(finite, f"{what}: poses or speeds are not finite")
        self.that(bool((state.gaps >= 0.0).all()), f"{what}: a gap is negative or not a number")
        self.that(math.isinf(float(state.gaps[0])), f"{what}: the ego's own gap must be infinite")
        self.that(state.step == step, f"{what}: step is {state.step}, not {step}")
        right_time = abs(state.time - step * simulator.dt) < 1e-6
        self.that(right_time, f"{what}: time is {state.time} after {step} steps")

    def check_determinism(
        self, simulator: Simulator, factory: Callable[[], Simulator], scenes: Sequence[Scene]
    ) -> None:
        """Check that a run repeats to the byte: again, after another scene, and in a new simulator."""
        first = [run_bytes(simulator, scene, seed=3) for scene in scenes]
        with factory() as other:
            for scene, expected in list(zip(scenes, first, strict=True))[::-1]:
                again = run_bytes(simulator, scene, seed=3)
                fresh = run_bytes(other, scene, seed=3)
                what = f"scene {scene.id}"
                self.that(again == expected, f"{what}: another result after other scenes had run")
                self.that(fresh == expected, f"{what}: another result from a fresh simulator")

    def check_controls(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check that the ego obeys its control, left is positive, and the observation agrees."""
        road = max(catalogue.maps, key=lambda road: road.length_m)
        scene = sample_scene(road, (), speed=8.0)
        ends = {}
        for name, control in (
            ("coasting", Control()),
            ("accelerating", Control(acceleration=1.0)),
            ("braking", Control(acceleration=-6.0)),
            ("steering left", Control(steering=0.03)),
            ("steering right", Control(steering=-0.03)),
        ):
            simulator.reset(scene, 0)
            for _ in range(STEPS):
                state = simulator.step(control)
            ends[name] = simulator.observe()
            speed = float(state.speeds[0])
            agrees = (
                abs(ends[name].speed - speed) < 1e-6 and abs(ends[name].time - state.time) < 1e-6
            )
            self.that(agrees, f"controls: after {name} observation and state disagree")
        faster = ends["accelerating"].speed > ends["coasting"].speed > ends["braking"].speed
        self.that(faster, "controls: accelerating and braking do not change the speed so")
        self.that(ends["braking"].speed >= 0.0, "controls: braking makes the ego reverse")
        left, right = ends["steering left"].offset_m, ends["steering right"].offset_m
        self.that(left > ends["coasting"].offset_m > right, "controls: left must be positive")

    def check_snapshot(self, simulator: Simulator, scene: Scene) -> None:
        """Check that a run from a restored snapshot repeats the original run, if snapshots are offered."""
        if not isinstance(simulator, Snapshots):
            return
        simulator.reset(scene, 1)
        for _ in range(10):
            simulator.step(Control(acceleration=-1.0, steering=0.01))
        kept = simulator.snapshot()
        runs = []
        for _ in range(2):
            states = [simulator.step(Control(steering=-0.02)) for _ in range(20)]
            runs.append([state.fingerprint() for state in states])
            simulator.restore(kept)
        self.that(runs[0] == runs[1], "snapshot: what follows a restored snapshot differs")

    # ------------------------------------------------------------------ frames and refusals

    def check_frames(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check shapes, dtypes, visible content, and that an actor appears where it stands."""
        size = max(catalogue.assets, key=_visibility)
        actor = Actor(id="a", asset=size.id, placement=Placement(ahead_m=20.0))
        simulator.reset(sample_scene(catalogue.maps[0], (actor,)), 0)
        for camera in (SMALL, Camera(width=64, height=64, fov_deg=90.0)):
            frame = simulator.render(camera)
            self.check_frame(frame, camera)
            shown = frame.ids == 2
            self.that(bool(shown.any()), f"frames: {size.id} 20 m ahead has no pixel with id 2")
            if shown.any():
                depth = float(np.median(frame.depth[shown]))
                reach = 0.5 * (size.length + size.width) + 1.0
                near = abs(depth - (20.0 - camera.x)) <= reach
                self.that(near, f"frames: {size.id} 20 m ahead has depth {depth:.1f} m")

    def check_frame(self, frame: Frame, camera: Camera) -> None:
        """Check one picture."""
        size = (camera.height, camera.width)
        for name, array, shape, kind in (
            ("rgb", frame.rgb, (*size, 3), np.uint8),
            ("depth", frame.depth, size, np.float32),
            ("ids", frame.ids, size, np.int32),
        ):
            good = array.shape == shape and array.dtype == kind
            what = f"frames: {name} is {array.dtype} {array.shape}, not {np.dtype(kind)} {shape}"
            self.that(good, what)
        colours = len(np.unique(frame.rgb.reshape(-1, frame.rgb.shape[-1]), axis=0))
        self.that(colours >= 4, f"frames: the picture is blank ({colours} colours)")
        known = bool((frame.ids >= 0).all() and (frame.ids <= 2).all())
        self.that(known, "frames: ids are not 0 (scenery), 1 (ego) or 2 + the actor's index")
        good_depth = bool((frame.depth > 0.0).all())
        self.that(good_depth, "frames: depth must be positive, infinite for the sky")
        self.that(bool(np.isfinite(frame.depth).any()), "frames: nothing has a finite depth")
        bodies = bool(np.isfinite(frame.depth[frame.ids > 0]).all())
        self.that(bodies, "frames: a pixel of a body has no finite depth")
        if frame.unhidden is not None:
            counts = np.bincount(frame.ids.ravel(), minlength=3)[1:3]
            good = frame.unhidden.shape == (2,) and bool((frame.unhidden >= counts).all())
            self.that(good, "frames: unhidden must count at least the visible pixels of each body")

    def check_refusals(self, simulator: Simulator, catalogue: Catalogue) -> None:
        """Check that impossible scenes raise typed errors and that the next scene still runs."""
        road = catalogue.maps[0]
        box = Actor(id="a", asset=catalogue.assets[0].id, placement=Placement(ahead_m=30.0))
        good = sample_scene(road, (box,))
        unknown = box.model_copy(update={"asset": "no-such-asset"})
        double = box.model_copy(update={"id": "b"})
        strange = box.model_copy(update={"behaviour": Behaviour(name="no-such-behaviour")})
        for what, scene in (
            ("an unknown asset", sample_scene(road, (unknown,))),
            ("an unknown behaviour", sample_scene(road, (strange,))),
            ("an unknown map", good.model_copy(update={"map": "no-such-map"})),
            ("a lane that is not there", sample_scene(road, (), lane=6)),
            ("two bodies in one place", sample_scene(road, (box, double))),
        ):
            try:
                simulator.reset(scene, 0)
            except (SceneError, SpawnError, UnknownComponent):
                pass
            except Exception as error:
                name = type(error).__name__
                self.findings.append(f"{what} is refused by a {name}, not a SceneError")
            else:
                self.findings.append(f"{what} is not refused")
            simulator.reset(good, 0)


def _visibility(asset: Asset) -> float:
    """Return how much of an asset is visible from behind."""
    return asset.width * asset.height

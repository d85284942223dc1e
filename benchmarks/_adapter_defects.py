"""Simulators with one defect each: what the author of an adapter can get wrong.

Every defect is a subclass of the flat simulator or of the tutorial's, which has dynamics of its own; both keep the
protocol.
"""

import math
import random
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from oodscen.data import Catalogue
from oodscen.data._scene import Behaviour, Scene, Trigger
from oodscen.protocols import Camera, Control, Frame, Observation, Simulator, State
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._new.adapter import Mover, MySimulator


class Defective(FlatSimulator):
    """A flat simulator whose inputs and outputs can be altered."""

    scene: Scene | None = None

    def altered_scene(self, scene: Scene) -> Scene:
        return scene

    def altered_state(self, state: State) -> State:
        return state

    def altered_observation(self, seen: Observation) -> Observation:
        return seen

    def altered_frame(self, frame: Frame, camera: Camera) -> Frame:
        return frame

    def altered_camera(self, camera: Camera) -> Camera:
        return camera

    def reset(self, scene, seed):
        self.scene = scene
        state = super().reset(self.altered_scene(scene), seed)
        return self.altered_state(state)

    def step(self, control):
        return self.altered_state(super().step(control))

    def restore(self, snapshot):
        return self.altered_state(super().restore(snapshot))

    def observe(self):
        return self.altered_observation(super().observe())

    def render(self, camera):
        return self.altered_frame(super().render(self.altered_camera(camera)), camera)


def _acting(scene: Scene, **changes: object) -> Scene:
    """Return a scene with changes to the behaviours of all actors."""
    actors = tuple(
        actor.model_copy(update={"behaviour": actor.behaviour.model_copy(update=changes)})
        for actor in scene.actors
    )
    return scene.model_copy(update={"actors": actors})


# ------------------------------------------------------------------ motion


class TriggersNeverFire(Defective):
    def altered_scene(self, scene):
        return _acting(scene, trigger=Trigger(value=500.0))


class TriggersFireEarly(Defective):
    def altered_scene(self, scene):
        actors = tuple(
            actor.model_copy(
                update={
                    "behaviour": actor.behaviour.model_copy(
                        update={"trigger": _doubled(actor.behaviour.trigger)}
                    )
                }
            )
            for actor in scene.actors
        )
        return scene.model_copy(update={"actors": actors})


def _doubled(trigger: Trigger) -> Trigger:
    is_time = trigger.kind == "time"
    return trigger if is_time else trigger.model_copy(update={"value": 1.5 * trigger.value})


class VehiclesFrozen(Defective):
    def altered_scene(self, scene):
        return _acting(scene, name="stand", parameters={}, other=None)


class StartsAtTwenty(Defective):
    def altered_scene(self, scene):
        actors = []
        for actor in scene.actors:
            known = self.catalogue().behaviours
            kind = next((each for each in known if each.id == actor.behaviour.name), None)
            if (
                kind is not None
                and "speed" in kind.parameters
                and actor.behaviour.name == "follow_lane"
            ):
                behaviour = actor.behaviour.model_copy(update={"parameters": {"speed": 20.0}})
                actor = actor.model_copy(update={"behaviour": behaviour})
            actors.append(actor)
        return scene.model_copy(update={"actors": tuple(actors)})


class ParametersIgnored(Defective):
    def altered_scene(self, scene):
        return _acting(scene, parameters={})


class WalkersNeverStop(MySimulator):
    """Moves who crosses the road like who walks along."""

    def catalogue(self) -> Catalogue:
        kept = super().catalogue()
        kinds = (*kept.behaviours, FlatSimulator().catalogue().behaviour("cross_road"))
        return kept.model_copy(update={"behaviours": kinds})

    def begin(self, staged, seed):
        super().begin(staged, seed)
        for mover in self.movers:
            if mover.body.behaviour == "cross_road":
                mover.body = replace(mover.body, behaviour="walk_along")


class Ignoring(Defective):
    """Does not know some parameters, and uses their defaults."""

    ignored: tuple[str, ...] = ()

    def altered_scene(self, scene):
        actors = []
        for actor in scene.actors:
            known = actor.behaviour.parameters.items()
            kept = {name: value for name, value in known if name not in self.ignored}
            behaviour = actor.behaviour.model_copy(update={"parameters": kept})
            actors.append(actor.model_copy(update={"behaviour": behaviour}))
        return scene.model_copy(update={"actors": tuple(actors)})


class PausesIgnored(Ignoring):
    ignored = ("pause",)


class DurationsIgnored(Ignoring):
    ignored = ("duration",)


class HeadwaysIgnored(Ignoring):
    ignored = ("headway",)


class AmplitudesIgnored(Ignoring):
    ignored = ("amplitude", "radius", "lift")


class PeriodsIgnored(Ignoring):
    ignored = ("period",)


class TriggersMeasureToTheirActor(Defective):
    def altered_scene(self, scene):
        actors = tuple(
            actor.model_copy(
                update={
                    "behaviour": actor.behaviour.model_copy(
                        update={
                            "trigger": actor.behaviour.trigger.model_copy(update={"actor": None})
                        }
                    )
                }
            )
            for actor in scene.actors
        )
        return scene.model_copy(update={"actors": actors})


class NobodyTows(Defective):
    def altered_scene(self, scene):
        actors = tuple(
            actor.model_copy(update={"behaviour": Behaviour()})
            if actor.behaviour.name == "towed"
            else actor
            for actor in scene.actors
        )
        return scene.model_copy(update={"actors": actors})


class DriftsToTheWrongSide(Defective):
    def altered_scene(self, scene):
        actors = []
        for actor in scene.actors:
            if actor.behaviour.name == "drift" and actor.placement.lane > 0:
                behaviour = actor.behaviour.model_copy(update={"parameters": {"lateral": -0.5}})
                actor = actor.model_copy(update={"behaviour": behaviour})
            actors.append(actor)
        return scene.model_copy(update={"actors": tuple(actors)})


class NobodyReacts(Defective):
    def altered_scene(self, scene):
        actors = tuple(
            actor.model_copy(
                update={"behaviour": actor.behaviour.model_copy(update={"name": "run_red"})}
            )
            if actor.behaviour.name == "follow_lane"
            else actor
            for actor in scene.actors
        )
        actors = tuple(
            actor.model_copy(
                update={
                    "behaviour": actor.behaviour.model_copy(
                        update={
                            "parameters": {
                                name: value
                                for name, value in actor.behaviour.parameters.items()
                                if name == "speed"
                            }
                            or {"speed": 10.0}
                        }
                    )
                }
            )
            if actor.behaviour.name == "run_red"
            else actor
            for actor in actors
        )
        return scene.model_copy(update={"actors": actors})


class RestoreForgetsTriggers(Defective):
    def restore(self, snapshot):
        super().restore(snapshot)
        self.world._state[1:, 9] = -1.0
        return self._publish()


class BrakesAtThirtyPercent(Defective):
    def step(self, control):
        weak = 0.3 * control.acceleration if control.acceleration < 0.0 else control.acceleration
        return super().step(Control(weak, control.steering))


class SteersTwiceAsMuch(Defective):
    def step(self, control):
        return super().step(Control(control.acceleration, 2.0 * control.steering))


class FrictionIgnored(Defective):
    def altered_scene(self, scene):
        return scene.model_copy(
            update={"weather": scene.weather.model_copy(update={"friction": 1.0})}
        )

    def altered_observation(self, seen):
        assert self.scene is not None
        return replace(seen, friction=self.scene.weather.friction)


class EgoIgnoresGrip(MySimulator):
    def catalogue(self) -> Catalogue:
        kept = super().catalogue()
        dry = kept.weather.model_copy(update={"min_friction": 1.0})
        return kept.model_copy(update={"weather": dry})

    def _drive(self, ego: Mover, control: Control) -> None:
        friction, self.friction = self.friction, 100.0
        super()._drive(ego, control)
        self.friction = friction


class DriversIgnoreBends(MySimulator):
    def _follow(self, mover: Mover, acceleration: float) -> None:
        acceleration = max(acceleration, -9.0 * self.friction)
        after = max(0.0, mover.speed + acceleration * self.dt)
        way = 0.5 * (mover.speed + after) * self.dt
        mover.x += way * math.cos(mover.yaw)
        mover.y += way * math.sin(mover.yaw)
        mover.speed = after


class StopsAtContact(Defective):
    def step(self, control):
        if self.state().contacts and self.world.ego.speed > 0.0:
            self.world._state[0, 6] = 0.0
        return super().step(control)


class TwoStepsAtOnce(Defective):
    def step(self, control):
        self.world.step(control)
        self.world.step_count -= 1
        return super().step(control)


class UnseededNoise(Defective):
    def step(self, control):
        return super().step(
            Control(control.acceleration, control.steering + random.gauss(0.0, 1e-3))
        )


class RenderingMoves(Defective):
    def render(self, camera):
        self.world._state[0, 0] += 0.01
        return super().render(camera)


# ------------------------------------------------------------------ states


def _posed(state: State, **columns: object) -> State:
    poses = state.poses.copy()
    for name, change in columns.items():
        column = "xyza".index(name)
        poses[:, column] = change(poses[:, column])  # type: ignore[operator]
    return replace(state, poses=poses)


class YawMirrored(Defective):
    def altered_state(self, state):
        return _posed(state, a=lambda yaw: 0.3 - yaw)


class YawInDegrees(Defective):
    def altered_state(self, state):
        return _posed(state, a=np.degrees)


class MetreAboveTheRoad(Defective):
    def altered_state(self, state):
        return _posed(state, z=lambda z: z + 1.0)


class ActorsMirrored(Defective):
    def altered_scene(self, scene):
        actors = tuple(
            actor.model_copy(
                update={
                    "placement": actor.placement.model_copy(
                        update={"offset_m": -actor.placement.offset_m}
                    )
                }
            )
            for actor in scene.actors
        )
        return scene.model_copy(update={"actors": actors})


class ActorsFiveMetresOff(Defective):
    def altered_scene(self, scene):
        actors = tuple(
            actor.model_copy(
                update={
                    "placement": actor.placement.model_copy(
                        update={"ahead_m": actor.placement.ahead_m + 5.0}
                    )
                }
            )
            for actor in scene.actors
        )
        return scene.model_copy(update={"actors": actors})


class GapsBetweenCentres(Defective):
    def altered_state(self, state):
        away = np.linalg.norm(state.poses[:, :2] - state.poses[0, :2], axis=1)
        return replace(state, gaps=np.where(np.isfinite(state.gaps), away, np.inf))


class NeverOffRoad(Defective):
    def altered_state(self, state):
        return replace(state, off_road=False)


class PlacesSwapped(Defective):
    def altered_state(self, state):
        return replace(state, places=state.places[:, ::-1].copy())


class AccelerationsOf99(Defective):
    def altered_state(self, state):
        return replace(state, accelerations=np.full_like(state.speeds, 99.0))


class SpeedsInKilometresPerHour(Defective):
    def altered_state(self, state):
        return replace(state, speeds=3.6 * state.speeds)

    def altered_observation(self, seen):
        return replace(seen, speed=3.6 * seen.speed)


class OneStepLate(Defective):
    before: State | None = None

    def altered_state(self, state):
        late = state if self.before is None or state.step == 0 else self.before
        self.before = state
        return replace(late, step=state.step, time=state.time)


# ------------------------------------------------------------------ observations


class WrongWheelbase(Defective):
    def altered_observation(self, seen):
        return replace(seen, wheelbase=1.5 * seen.wheelbase)


class OffsetToTheRight(Defective):
    def altered_observation(self, seen):
        return replace(seen, offset_m=-seen.offset_m)


class NoCurvature(Defective):
    def altered_observation(self, seen):
        return replace(seen, curvature=0.0)


class LanesSwapped(Defective):
    def altered_observation(self, seen):
        return replace(seen, lane_left_m=seen.lane_right_m, lane_right_m=seen.lane_left_m)


class RoadsideOneLaneOver(Defective):
    def altered_observation(self, seen):
        return replace(seen, roadside_m=-2.75)


class AnySpeedInCurves(Defective):
    def altered_observation(self, seen):
        return replace(seen, curve_speed=math.inf)


# ------------------------------------------------------------------ pictures


class ColoursFlipped(Defective):
    def altered_frame(self, frame, camera):
        return replace(frame, rgb=frame.rgb[:, ::-1].copy())


class BodiesRoadGrey(Defective):
    def altered_frame(self, frame, camera):
        rgb = frame.rgb.copy()
        rgb[frame.ids > 1] = (76, 76, 82)
        return replace(frame, rgb=rgb)


class FieldOfViewIgnored(Defective):
    def altered_camera(self, camera):
        return replace(camera, fov_deg=60.0)


class PitchIgnored(Defective):
    def altered_camera(self, camera):
        return replace(camera, pitch_deg=2.0)


class TurnIgnored(Defective):
    def altered_camera(self, camera):
        return replace(camera, yaw_deg=0.0)


class PlaceIgnored(Defective):
    def altered_camera(self, camera):
        return replace(camera, x=0.6, y=0.0, z=1.4)


class DepthAlongTheRay(Defective):
    def altered_frame(self, frame, camera):
        focal = 0.5 * camera.width / math.tan(0.5 * math.radians(camera.fov_deg))
        u = (np.arange(camera.width) + 0.5 - 0.5 * camera.width) / focal
        v = (np.arange(camera.height) + 0.5 - 0.5 * camera.height) / focal
        longer = np.sqrt(1.0 + u[None, :] ** 2 + v[:, None] ** 2)
        return replace(frame, depth=(frame.depth * longer).astype(np.float32))


class IdsSwapped(Defective):
    def altered_frame(self, frame, camera):
        most = len(self.world.ids)
        ids = np.where(frame.ids > 1, most + 2 - frame.ids, frame.ids)
        return replace(frame, ids=ids.astype(np.int32))


class FogHalfAsThick(Defective):
    def altered_scene(self, scene):
        weather = scene.weather
        if weather.fog_visual_range_m < 5_000.0:
            weather = weather.model_copy(
                update={"fog_visual_range_m": 2.0 * weather.fog_visual_range_m}
            )
        return scene.model_copy(update={"weather": weather})

    def altered_observation(self, seen):
        assert self.scene is not None
        return replace(seen, visual_range_m=min(10_000.0, self.scene.weather.fog_visual_range_m))


class HeadingsDrawnAtTheirStart(FlatSimulator):
    started: list[list[float]] | None = None

    def load(self, *args):
        self.started = None
        super().load(*args)

    def place(self, poses, speeds):
        super().place(poses, speeds)
        self.started = self.started or self._poses
        for pose, start in zip(self._poses[1:], self.started[1:], strict=True):
            pose[3] = start[3]


class Drawn(MySimulator):
    """The tutorial's simulator, whose pictures can show other poses than its states have."""

    def shown(self, poses: np.ndarray) -> np.ndarray:
        return poses

    def draw(self, camera):
        weather = self.staged.scene.weather.model_copy(update={"sun_elevation_deg": 45.0})
        return self.staged.draw(camera, self.shown(self.state().poses.copy()), weather)


class ActorsDrawnAtTheirStart(Drawn):
    started: np.ndarray | None = None

    def begin(self, staged, seed):
        super().begin(staged, seed)
        self.started = None

    def shown(self, poses):
        if self.started is None:
            self.started = poses.copy()
        poses[1:] = self.started[1:]
        return poses


class RestoreShowsTheOtherBranch(Drawn):
    moved: np.ndarray | None = None

    def begin(self, staged, seed):
        super().begin(staged, seed)
        self.moved = None

    def move(self, control):
        super().move(control)
        self.moved = np.array([(mover.x, mover.y, mover.yaw) for mover in self.movers])

    def shown(self, poses):
        if self.moved is not None:
            poses[:, (0, 1, 3)] = self.moved
        return poses


class FourthActorInvisible(Drawn):
    most = 3

    def shown(self, poses):
        poses[1 + self.most :, 0] += 5_000.0
        return poses


class IdsSwappedFromThreeActors(Drawn):
    def draw(self, camera):
        frame, ids = super().draw(camera), np.arange(len(self.movers) + 1, dtype=np.int32)
        if len(self.movers) > 3:
            ids[[3, 4]] = ids[[4, 3]]
        return replace(frame, ids=ids[frame.ids])


class PicturesOneStepLate(Drawn):
    steps = 1
    past: tuple[np.ndarray, ...] = ()

    def begin(self, staged, seed):
        super().begin(staged, seed)
        self.past = ()

    def move(self, control):
        self.past = (*self.past, self.state().poses.copy())
        super().move(control)

    def resume(self, saved):
        super().resume(saved)
        self.past = ()

    def shown(self, poses):
        return (*self.past, poses)[-1 - self.steps :][0]


class PicturesTwoStepsLate(PicturesOneStepLate):
    steps = 2


DEFECTS: tuple[Callable[[], Simulator], ...] = tuple(
    one
    for one in list(globals().values())
    if isinstance(one, type)
    and one.__module__ == __name__
    and one not in (Defective, Drawn, Ignoring)
)
"""All defects, in the order of this file."""

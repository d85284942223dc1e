"""Scenes and short runs shared by the conformance checks."""

import math
from collections.abc import Callable

from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._checked_simulator import scene_copy
from oodscen.protocols import Camera, Control, Frame, Observation, Simulator
from oodscen.tree._labels import slug

SMALL = Camera(width=160, height=120)
"""The camera of the checks."""
STEPS = 40
"""Number of steps that a check drives."""


def sample_scene(
    road: RoadMap,
    actors: tuple[Actor, ...],
    *,
    lane: int = 0,
    speed: float = 8.0,
    weather: Weather | None = None,
) -> Scene:
    """Return a scene with some actors, in good weather by default."""
    return Scene(
        id="check",
        scenario_id="check",
        map=road.id,
        ego=Ego(speed=speed, lane=lane),
        weather=weather or Weather(),
        actors=actors,
        hazard=Hazard(weather=weather or Weather()),
        decision=Trigger(kind="time", value=1.0),
    )


def plain_scene(catalogue: Catalogue, road: RoadMap, weather: Weather | None = None) -> Scene:
    """Return a scene with up to three moving actors, as far as the catalogue has them."""
    kinds = {kind.id: kind for kind in catalogue.behaviours}
    actors = []
    for index, name in enumerate(("follow_lane", "wobble", "cross_road")):
        categories = kinds[name].categories if name in kinds else ()
        assets = [asset for asset in catalogue.assets if asset.category in categories]
        if assets:
            actor = Actor(
                id=name.replace("_", "-"),
                asset=assets[0].id,
                placement=Placement(ahead_m=25.0 + 20.0 * index),
                behaviour=Behaviour(name=name),
            )
            actors.append(actor)
    scene = sample_scene(road, tuple(actors), weather=weather)
    return scene.model_copy(update={"id": f"check-{slug(road.id)}"})


def constantly(control: Control) -> Callable[[object], Control]:
    """Return the control law that always gives the same control."""
    return lambda _: control


def follow_lane(observation: Observation) -> Control:
    """Keep the lane with the simplest sufficient control law."""
    reach = max(4.0, observation.speed)
    bend = observation.curvature - observation.offset_m / reach**2
    bend -= 2.0 * observation.heading_error / reach
    return Control(0.0, math.atan(observation.wheelbase * bend))


def run_bytes(
    simulator: Simulator, scene: Scene, camera: Camera | None = SMALL, *, seed: int
) -> list[bytes]:
    """Return the bytes of a run: all states, and with a camera the frames at its beginning and end.

    Raises:
        SimulatorError: If the simulator changes the scene.
    """
    with scene_copy(scene, simulator.name) as copy:
        trace = [simulator.reset(copy, seed).fingerprint()]
        trace += frame_bytes(simulator.render(camera)) if camera else []
        for step in range(STEPS):
            control = Control(0.5 if step < 20 else -3.0, 0.01 if step % 8 < 4 else -0.01)
            trace.append(simulator.step(control).fingerprint())
        return trace + (frame_bytes(simulator.render(camera)) if camera else [])


def frame_bytes(frame: Frame) -> list[bytes]:
    """Return the bytes of a frame."""
    return [frame.rgb.tobytes(), frame.depth.tobytes(), frame.ids.tobytes()]

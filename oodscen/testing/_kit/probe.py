"""The input of every part of the conformance check: the simulator, its catalogue and scenes to try."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from oodscen.data._catalogue import Asset, Catalogue, RoadMap
from oodscen.data._category import Category
from oodscen.data._scene import Actor, Behaviour, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.driving._staged_scene import StagedScene
from oodscen.protocols import Camera, Control, Observation, Simulator, State
from oodscen.testing._kit.findings import Findings, NotApplicable
from oodscen.testing._kit.samples import STEPS, sample_scene

Factory = Callable[[], Simulator]
SOON = Trigger(value=0.5)
"""The trigger of behaviours whose onset does not matter."""


@dataclass(kw_only=True)
class Probe:
    """One simulator under test."""

    simulator: Simulator
    catalogue: Catalogue
    factory: Factory
    source: Factory | str
    scenes: Sequence[Scene]
    """Scenes whose runs are repeated."""
    states_only: bool
    """The pixels of the simulator do not repeat: compare states only."""
    resets: int
    """Number of resets in the search for leaks."""
    findings: Findings

    @property
    def is_top(self) -> bool:
        """Return whether the simulator draws views from above only."""
        return self.catalogue.camera == "top"

    @cached_property
    def clear(self) -> Weather:
        """The clearest day that the catalogue offers."""
        return clear_day(self.catalogue)

    @cached_property
    def road(self) -> RoadMap:
        """The plainest map: straight and wide if there is one."""
        return max(
            self.catalogue.maps,
            key=lambda road: (
                is_straight(road),
                not road.landmarks,
                road.lanes + road.oncoming_lanes,
            ),
        )

    @cached_property
    def widest(self) -> RoadMap:
        """The map with the most lanes."""
        return max(self.catalogue.maps, key=lambda road: road.lanes + road.oncoming_lanes)

    @property
    def box_like(self) -> Asset:
        """An asset whose shape is nearly its box.

        Raises:
            NotApplicable: If there is none.
        """
        return self.asset_for("vehicle", "object", "work_zone")

    def can_stage(self, scene: Scene, subject: str) -> bool:
        """Return whether a scene can be staged, and note its subject if it cannot."""
        if staging_issues(scene, self.catalogue):
            self.findings.unstaged.append(subject)
            return False
        return True

    def camera(self, width: int = 160, height: int = 120) -> Camera:
        """Return the camera of the simulator's kind; one above the ego is near enough for small pictures."""
        if self.is_top:
            return Camera.above(width, height, x=12.0, z=60.0)
        return Camera(width, height)

    def scene(
        self,
        *actors: Actor,
        road: RoadMap | None = None,
        lane: int = 0,
        speed: float = 8.0,
        weather: Weather | None = None,
    ) -> Scene:
        """Return a scene on a clear day, on the plainest road by default."""
        weather = weather or self.clear
        return sample_scene(road or self.road, actors, lane=lane, speed=speed, weather=weather)

    def staged(self, scene: Scene) -> StagedScene:
        """Return the scene with what the library measures in it."""
        return StagedScene(scene, self.catalogue, 0, dt=self.simulator.dt)

    def asset_for(self, *categories: Category) -> Asset:
        """Return the first asset that blocks the way, of the first category that has one.

        Raises:
            NotApplicable: If there is none.
        """
        for category in categories:
            for asset in self.catalogue.assets:
                if asset.category == category and not asset.is_passable():
                    return asset
        raise NotApplicable(f"the catalogue has no {' or '.join(categories)}")

    def doing(
        self,
        name: str,
        *,
        id: str = "a",
        ahead: float = 35.0,
        lane: int = 0,
        trigger: Trigger = SOON,
        parameters: Mapping[str, float] = MappingProxyType({}),
    ) -> Actor:
        """Return an actor with a behaviour.

        Raises:
            NotApplicable: If the catalogue lacks the behaviour, or assets for it.
        """
        kinds = {kind.id: kind for kind in self.catalogue.behaviours}
        if name not in kinds:
            raise NotApplicable(f"the catalogue has no behaviour {name!r}")
        behaviour = Behaviour(name=name, trigger=trigger, parameters=dict(parameters))
        asset = self.asset_for(*kinds[name].categories)
        return self.acting(asset, behaviour, id=id, ahead=ahead, lane=lane)

    def acting(
        self,
        asset: Asset,
        behaviour: Behaviour,
        *,
        id: str = "a",
        ahead: float = 35.0,
        lane: int = 0,
    ) -> Actor:
        """Return an asset with a behaviour in the middle of a lane."""
        placement = Placement(ahead_m=ahead, lane=lane)
        return Actor(id=id, asset=asset.id, placement=placement, behaviour=behaviour)

    def still(
        self,
        asset: Asset,
        *,
        id: str = "a",
        ahead: float = 20.0,
        offset: float = 0.0,
        heading: float = 0.0,
    ) -> Actor:
        """Return an asset that stands."""
        placement = Placement(ahead_m=ahead, offset_m=offset, heading_deg=heading)
        return Actor(id=id, asset=asset.id, placement=placement)

    def states(
        self,
        scene: Scene,
        control: Callable[[Observation], Control] = lambda _: Control(),
        *,
        steps: int = STEPS,
    ) -> Iterator[State]:
        """Reset to a scene and yield its states; the control is computed between them."""
        yield self.simulator.reset(scene, 0)
        for _ in range(steps):
            yield self.simulator.step(control(self.simulator.observe()))

    def run(
        self,
        scene: Scene,
        control: Callable[[Observation], Control] = lambda _: Control(),
        *,
        steps: int = STEPS,
    ) -> list[State]:
        """Return the states of a run."""
        return list(self.states(scene, control, steps=steps))


def clear_day(catalogue: Catalogue) -> Weather:
    """Return the clearest day that a catalogue offers."""
    return Weather(sun_elevation_deg=max(45.0, catalogue.weather.min_sun_elevation_deg))


def is_straight(road: RoadMap) -> bool:
    """Return whether the first 200 m of a road are straight and level."""
    corridor = load_corridor(road)
    is_near = (corridor.s >= corridor.start - 20.0) & (corridor.s <= corridor.start + 200.0)
    curvature = abs(corridor.curvature[is_near]).max(initial=0.0)
    return bool(curvature < 1e-4 and np.ptp(corridor.z[is_near]) < 0.2)

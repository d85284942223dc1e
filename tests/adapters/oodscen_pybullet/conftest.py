"""One simulator and small scenes that the adapter's tests share."""

from collections.abc import Callable, Iterator

import pytest
from oodscen_pybullet import PyBulletSimulator

from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.protocols import Camera

CAMERA = Camera(width=160, height=120)

MakeScene = Callable[..., Scene]


@pytest.fixture(scope="session")
def simulator() -> Iterator[PyBulletSimulator]:
    with PyBulletSimulator() as one:
        yield one


@pytest.fixture(scope="session")
def camera() -> Camera:
    return CAMERA


@pytest.fixture(scope="session")
def make_actor() -> Callable[..., Actor]:
    def make(
        asset: str, ahead: float, *, name: str = "a", offset: float = 0.0, heading: float = 0.0,
        state: str = "", behaviour: str = "stand", **parameters: float,
    ) -> Actor:  # fmt: skip
        place = Placement(ahead_m=ahead, offset_m=offset, heading_deg=heading)
        acts = Behaviour(name=behaviour, parameters=parameters)
        return Actor(id=name, asset=asset, placement=place, behaviour=acts, state=state)

    return make


@pytest.fixture(scope="session")
def make_scene() -> MakeScene:
    def make(*actors: Actor, road: str = "urban_three_lane", **weather: object) -> Scene:
        return Scene(
            id="test",
            scenario_id="test",
            map=road,
            ego=Ego(speed=8.0, lane=1 if road == "urban_three_lane" else 0),
            weather=Weather.model_validate(weather),
            actors=actors,
            hazard=Hazard(weather=Weather()),
            decision=Trigger(kind="time", value=1.0),
        )

    return make

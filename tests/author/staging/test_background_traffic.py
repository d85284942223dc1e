import numpy as np
import pytest

from oodscen.author._knowledge.base import AmbientTraffic, Recipe, RecipeTrigger
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._staging.background_traffic import expected_decision_s, surrounding_traffic
from oodscen.author._staging.layout import Layout
from oodscen.data._scene import Actor, Behaviour, Placement, Scene, Trigger
from oodscen.prompts._digest import CatalogueDigest, MapLine
from oodscen.stages._simulate import simulate
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

DIGEST = CatalogueDigest.of(FlatSimulator().catalogue())
RECIPE = Recipe(speed=(10.0, 10.0), decision=RecipeTrigger())
LEFT = AmbientTraffic(side="left", share=1.0, asset=("car",), gap=(1.0, 3.0))
RIGHT = AmbientTraffic(side="right", share=1.0, asset=("car",), gap=(1.0, 3.0))
ONCOMING = AmbientTraffic(
    side="oncoming", share=1.0, asset=("van",), gap=(50.0, 60.0), speed=(8.0, 8.0)
)
DECISION = Trigger(kind="distance", value=20.0, actor="a")


def road(lanes: int, oncoming: int, *traits: str) -> MapLine:
    return MapLine(
        id="x",
        description="",
        lanes=lanes,
        oncoming_lanes=oncoming,
        speed_limit=14.0,
        traits=traits,
    )


def actor(lane: int = 0, offset: float = 0.0, name: str = "stand", **parameters: float) -> Actor:
    return Actor(
        id="a",
        asset="car",
        placement=Placement(ahead_m=70.0, lane=lane, offset_m=offset),
        behaviour=Behaviour(name=name, parameters=parameters),
    )


def drawn(line: MapLine, lane: int, *actors: Actor, free: int = 0) -> dict[str, Actor]:
    rng = np.random.default_rng(0)
    layout = Layout(DIGEST, line, RECIPE, rng, 10.0, 1.0, ego_lane=lane, escape=free)
    decision_s = expected_decision_s(DECISION, actors, layout.speed)
    found = surrounding_traffic((LEFT, RIGHT, ONCOMING), layout, actors, decision_s)
    return {one.id: one for one in found}


@pytest.mark.parametrize(
    ("line", "lane", "ids"),
    [
        (road(3, 0), 0, {"left-traffic"}),
        (road(3, 0), 1, {"left-traffic", "right-traffic"}),
        (road(2, 2), 1, {"right-traffic", "oncoming-traffic"}),
        (road(1, 1), 0, {"oncoming-traffic"}),
        (road(2, 2, "divided"), 1, {"right-traffic"}),
    ],
)
def test_it_drives_where_the_road_has_a_lane(line: MapLine, lane: int, ids: set[str]) -> None:
    assert set(drawn(line, lane, actor())) == ids


@pytest.mark.parametrize(
    "other",
    [
        actor(lane=1),
        actor(offset=1.5),
        actor(name="cut_in", lanes=1.0, speed=8.0),
        actor(lane=1, offset=-4.0, name="cross_road"),
    ],
)
def test_a_lane_that_the_hazard_needs_stays_free(other: Actor) -> None:
    assert "left-traffic" not in drawn(road(3, 0), 1, other)
    assert "right-traffic" in drawn(road(3, 0), 1, other)


def test_the_way_out_stays_free() -> None:
    assert set(drawn(road(3, 0), 1, actor(), free=1)) == {"right-traffic"}


def test_oncoming_traffic_is_near_when_the_ego_decides() -> None:
    one = drawn(road(1, 1), 0, actor())["oncoming-traffic"]
    decided = (70.0 - 20.0) / 10.0
    gap = one.placement.ahead_m - (10.0 + 8.0) * decided
    assert 50.0 <= gap <= 60.0


def test_traffic_beside_the_ego_is_beside_it_when_the_ego_decides_and_moves_in_the_picture() -> (
    None
):
    one = drawn(road(3, 0), 0, actor())["left-traffic"]
    own = one.behaviour.parameters["speed"]
    assert 8.0 < own < 9.5
    assert one.placement.lane == 1
    decided = (70.0 - 20.0) / 10.0
    assert 1.0 <= one.placement.ahead_m - (10.0 - own) * decided <= 3.01
    assert one.placement.ahead_m > 3.5


@pytest.mark.parametrize("asset", ["car", "van", "truck"])
def test_a_neighbour_as_near_as_can_be_is_in_the_picture_at_the_decision(asset: str) -> None:
    kinds = [one for one in load_knowledge().company if one.side in ("left", "right")]
    scene = example_scene()
    neighbour = Actor(
        id="beside",
        asset=asset,
        placement=Placement(ahead_m=min(kind.gap[0] for kind in kinds), lane=1, offset_m=0.3),
    )
    beside = {
        **scene.model_dump(),
        "actors": [*scene.actors, neighbour],
        "decision": Trigger(kind="time", value=0.0),
    }
    with FlatSimulator() as simulator:
        run = simulate(Scene.model_validate(beside), simulator, actions=("stop",))
    assert run.episode.visible["last"].get("beside", 0) >= 40

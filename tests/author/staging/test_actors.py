import pytest

from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._knowledge.designs import load_designs
from oodscen.data._catalogue import Catalogue
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene


def staged(author: BuiltinAuthor, ask, digest: CatalogueDigest, text: str) -> list[SceneDraft]:
    return [
        ask(author, StageScene(text=f"{text} {'.' * number}", path=(), catalogue=digest))
        for number in range(12)
    ]


RUNNER = (
    "The ego vehicle drives on a four-lane avenue towards a signalised intersection. A car comes "
    "from the {side} through a red light and cuts across the junction in front of the ego vehicle."
)


@pytest.mark.parametrize(("side", "sign"), [("right", -1.0), ("left", 1.0)])
def test_crossing_traffic_reaches_the_ego_s_lane_when_the_ego_does(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest, side: str, sign: float
) -> None:
    for draft in staged(author, ask, rich_digest, RUNNER.format(side=side)):
        assert draft.map == "urban_junction"
        (runner,) = (actor for actor in draft.actors if actor.id == "runner")
        place, speed = runner.placement, runner.behaviour.parameters["speed"]
        assert sign * place.offset_m > 0.0
        late = abs(place.offset_m) / speed - place.ahead_m / draft.ego.speed
        assert -0.5 <= late <= 0.2
        twin = draft.hazard.actors["runner"]
        assert twin is not None
        assert twin.behaviour.name == "stand"
        assert sign * twin.placement.offset_m > 10.0
        assert twin.placement.heading_deg == place.heading_deg


def test_every_light_that_faces_the_ego_fails(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest
) -> None:
    text = (
        "The ego vehicle drives on a four-lane city road towards a large junction. The traffic "
        "lights at the junction have gone dark, and crossing traffic from the left simply goes first."
    )
    line = next(line for line in rich_digest.maps if line.id == "urban_junction")
    lights = [mark for mark in line.landmarks if mark.kind == "traffic_light"]
    for draft in staged(author, ask, rich_digest, text):
        dark = [actor for actor in draft.actors if actor.asset == "traffic_light"]
        assert [actor.placement.ahead_m for actor in dark] == [mark.ahead_m for mark in lights]
        for actor, mark in zip(dark, lights, strict=True):
            assert actor.state == "off"
            assert actor.placement.lane == -draft.ego.lane
            assert actor.placement.offset_m == pytest.approx(mark.left_m)
            twin = draft.hazard.actors[actor.id]
            assert twin is not None
            assert (twin.state, twin.placement) == ("green", actor.placement)


def test_what_is_towed_hangs_behind_its_car(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest
) -> None:
    text = (
        "The ego vehicle drives on a divided highway with two lanes in its direction. The caravan "
        "behind the car ahead swings from side to side, farther with every second."
    )
    for draft in staged(author, ask, rich_digest, text):
        by_id = {actor.id: actor for actor in draft.actors}
        car, caravan = by_id["tow-car"], by_id["trailer"]
        assert caravan.behaviour.other == "tow-car"
        assert car.placement.ahead_m - caravan.placement.ahead_m == pytest.approx(5.3)
        assert caravan.placement.lane == car.placement.lane
        twin = draft.hazard.actors["trailer"]
        assert twin is not None
        assert twin.behaviour.other == "tow-car"


def test_a_lorry_that_the_text_mentions_is_behind(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest
) -> None:
    text = (
        "The ego vehicle drives on a two-lane rural road, with a lorry close behind. An overturned "
        "car lies on its roof in the ego's lane."
    )
    drafts = staged(author, ask, rich_digest, text)
    behind = [a for d in drafts for a in d.actors if a.placement.ahead_m < 0.0]
    assert len(behind) == len(drafts)
    for draft, actor in zip(drafts, behind, strict=True):
        assert actor.id not in draft.hazard.actors
        assert -25.0 < actor.placement.ahead_m < -9.0
        assert actor.behaviour.parameters["speed"] > draft.ego.speed
        assert actor.behaviour.parameters["headway"] < 0.5


def test_whoever_follows_stops_behind_a_calm_ego(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest
) -> None:
    text = "The ego vehicle drives on a two-lane rural road. An overturned car lies on its roof."
    found = 0
    for draft in staged(author, ask, rich_digest, text):
        if any(actor.id == "behind-traffic" for actor in draft.actors):
            found += 1
            assert draft.decision.value > draft.ego.speed**2 / 7.0 + 4.5
    assert found


def test_poses_and_damage_are_only_where_something_is_made_to_order(
    knowledge: Knowledge, rich_digest: CatalogueDigest
) -> None:
    known = {asset.id for asset in rich_digest.assets}
    posed = [
        hazard
        for hazard in knowledge.hazards
        if hazard.stage and any(actor.details for actor in hazard.stage.actors)
    ]
    assert len(posed) >= 4
    assert all(set(hazard.needs.assets) - known for hazard in posed)


def test_a_child_runs_with_its_arms_out_where_the_simulator_can_show_it(
    author: BuiltinAuthor, ask, rich_catalogue: Catalogue, catalogue: Catalogue
) -> None:
    text = "In a residential street a ball rolls across the ego's lane, and a child runs after it."
    made = [load_designs()["ball"]]
    for simulator, pose in ((rich_catalogue, "arms_out"), (catalogue, None)):
        digest = CatalogueDigest.of(simulator.with_made(made))
        (draft,) = staged(author, ask, digest, text)[:1]
        (child,) = (actor for actor in draft.actors if actor.id == "child")
        assert (child.details.pose if child.details else None) == pose
        twin = draft.hazard.actors["child"]
        assert twin is not None
        assert twin.details is None

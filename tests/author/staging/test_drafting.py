import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._seeding import stream
from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._realisation import realise
from oodscen.author._writing.compose import Composer
from oodscen.data._catalogue import Catalogue, WeatherRange
from oodscen.data._scene import Scene
from oodscen.data._weather import PRECIPITATIONS
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import LLMError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._scenario.stage_scene import SceneDraft, StageScene


def scene_of(draft: SceneDraft) -> Scene:
    fields = {
        name: getattr(draft, name) for name in Scene.model_fields if name in SceneDraft.model_fields
    }
    return Scene(id="x", scenario_id="x", **fields)


def texts_of(knowledge: Knowledge, digest: CatalogueDigest, count: int) -> list[tuple[str, str]]:
    composer = Composer(knowledge)
    return [
        (hazard.id, text)
        for hazard in knowledge.hazards
        if hazard.stage is not None and not realise(hazard, digest, knowledge).missing
        for text, _ in zip(
            composer.texts(hazard, stream(5, hazard.label), set()), range(count), strict=False
        )
    ]


@pytest.fixture(scope="module")
def rich_texts(knowledge: Knowledge, rich_digest: CatalogueDigest) -> list[tuple[str, str]]:
    return texts_of(knowledge, rich_digest, 1)


def renamed(catalogue: Catalogue) -> Catalogue:
    """Return a catalogue whose assets have other ids, and their old ones as names."""
    assets = [
        asset.model_copy(update={"id": f"my_{asset.id}", "names": (asset.id, *asset.names)})
        for asset in catalogue.assets
    ]
    return catalogue.model_copy(update={"assets": tuple(assets)})


def test_assets_are_found_by_their_other_names(
    author, ask, rich_catalogue, rich_digest, rich_texts
):
    own = renamed(rich_catalogue)
    digest = CatalogueDigest.of(own)
    for _, text in rich_texts[::9]:
        draft = ask(author, StageScene(text=text, path=("a",), catalogue=digest))
        assert not own.lacks(scene_of(draft))
        plain = ask(author, StageScene(text=text, path=("a",), catalogue=rich_digest))
        assert [actor.asset for actor in draft.actors] == [
            f"my_{actor.asset}" for actor in plain.actors
        ]


def test_drafts_pass_the_check_at_once_or_after_a_refusal(
    author: BuiltinAuthor,
    ask,
    rich_catalogue: Catalogue,
    rich_digest: CatalogueDigest,
    rich_texts: list[tuple[str, str]],
) -> None:
    refused = []
    assert len({name for name, _ in rich_texts}) >= 120
    for name, text in rich_texts[::2]:
        for attempt in (1, 2, 3):
            question = StageScene(text=text, path=(), catalogue=rich_digest)
            draft = ask(author, question, attempt=attempt)
            issues = check_scene(scene_of(draft), rich_catalogue)
            if not issues:
                break
            refused.append((name, attempt, issues))
        else:
            pytest.fail(f"{name}: {text} {refused[-1]}")
    assert len(refused) <= 0.025 * len(rich_texts), refused


def test_nobody_drives_in_the_very_middle_of_a_lane(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest, rich_texts: list[tuple[str, str]]
) -> None:
    """Neither a hazard nor an ordinary road user, so that the exact place tells nothing."""
    offsets = []
    for _, text in rich_texts[::3]:
        draft = ask(author, StageScene(text=text, path=(), catalogue=rich_digest))
        everybody = [*draft.actors, *filter(None, draft.hazard.actors.values())]
        tied = {one.behaviour.other for one in everybody}
        offsets += [
            one.placement.offset_m
            for one in everybody
            if one.behaviour.name == "follow_lane" and one.id not in tied
        ]
    assert len(offsets) >= 50
    assert sum(offset == 0.0 for offset in offsets) <= 0.05 * len(offsets)


def test_a_refused_scene_is_drawn_again(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    text = "Ego drives on a two-lane residential road. A fallen tree blocks the ego's lane ahead."
    question = StageScene(text=text, path=(), catalogue=digest)
    first, again, second = (ask(author, question, attempt=attempt) for attempt in (1, 1, 2))
    assert first == again
    assert first.actors != second.actors
    assert [a.asset for a in first.actors] == [a.asset for a in second.actors]


@pytest.mark.parametrize("metres", [35, 45, 60, 80])
@pytest.mark.parametrize("hazard", ["An overturned car lies on its roof", "An old sofa stands"])
def test_a_distance_in_the_text_is_kept(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, metres: int, hazard: str
) -> None:
    text = f"Ego drives on a two-lane residential road. {hazard} in its lane {metres} metres ahead."
    draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
    assert draft.actors[0].placement.ahead_m == pytest.approx(metres)
    assert draft.decision.value < metres


@pytest.mark.parametrize(
    ("road", "trait"),
    [
        ("on a two-lane residential street", "residential"),
        ("on a three-lane urban road", "three_lane"),
        ("on a four-lane urban avenue", "four_lane"),
        ("on a highway with two lanes in each direction", "highway"),
        ("along a winding country road", "rural"),
    ],
)
def test_the_map_fits_the_road(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, road: str, trait: str
) -> None:
    text = f"Ego is travelling {road}. A large cardboard box lies in its lane."
    draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
    assert trait in next(line.traits for line in digest.maps if line.id == draft.map)


@pytest.mark.parametrize(
    ("told", "holds"),
    [
        ("at night", lambda w: w.sun_elevation_deg < -6 and w.precipitation == "none"),
        ("on a sunny day", lambda w: w.sun_elevation_deg > 20 and w.fog_visual_range_m >= 10_000),
        ("in steady rain", lambda w: w.precipitation == "rain" and w.friction < 0.8),
        ("at night in the rain", lambda w: w.precipitation == "rain" and w.sun_elevation_deg < -6),
        ("on a snowy day", lambda w: w.precipitation == "snow" and w.friction < 0.7),
        ("in light fog", lambda w: w.fog_visual_range_m < 400),
    ],
)
def test_the_weather_is_that_of_the_text(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, told: str, holds
) -> None:
    text = (
        f"Ego drives on a two-lane residential road {told}. A large cardboard box lies in its lane."
    )
    draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
    assert holds(draft.weather)
    assert draft.hazard.weather is None


@given(
    sun=st.floats(-90.0, 90.0),
    fog_m=st.floats(20.0, 4_000.0),
    most=st.floats(0.1, 50.0),
    friction=st.floats(0.1, 0.9),
    told=st.sampled_from(["at night", "in steady rain", "on a snowy day", "in light fog"]),
)
@settings(max_examples=30)
def test_the_weather_is_one_that_the_simulator_shows(
    author: BuiltinAuthor, ask, catalogue: Catalogue, sun, fog_m, most, friction, told
) -> None:
    weather = WeatherRange(
        min_sun_elevation_deg=sun,
        min_fog_visual_range_m=fog_m,
        precipitation=PRECIPITATIONS,
        max_precipitation_mm_h=most,
        min_friction=friction,
    )
    dim = catalogue.model_copy(update={"weather": weather})
    text = (
        f"Ego drives on a two-lane residential road {told}. A large cardboard box lies in its lane."
    )
    draft = ask(author, StageScene(text=text, path=(), catalogue=CatalogueDigest.of(dim)))
    assert not check_scene(scene_of(draft), dim)


def test_twilight_needs_no_simulator_that_shows_the_night(
    author: BuiltinAuthor, ask, catalogue: Catalogue
) -> None:
    weather = WeatherRange(min_sun_elevation_deg=-4.0)
    dusky = CatalogueDigest.of(catalogue.model_copy(update={"weather": weather}))
    text = "Ego drives on a two-lane residential road at twilight. A large cardboard box lies in its lane."
    draft = ask(author, StageScene(text=text, path=(), catalogue=dusky))
    assert -4.0 <= draft.weather.sun_elevation_deg < 0.0


def test_weather_as_hazard_has_an_ordinary_counterpart(
    author: BuiltinAuthor, ask, knowledge: Knowledge, digest: CatalogueDigest
) -> None:
    seen = 0
    for hazard in knowledge.of_class("environmental"):
        if hazard.stage is None or not hazard.stage.ordinary_weather:
            continue
        text = Composer(knowledge).text(hazard, stream(0, hazard.id))
        draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
        assert draft.hazard.weather is not None
        assert draft.hazard.weather != draft.weather
        assert draft.decision.actor in {actor.id for actor in draft.actors}
        seen += 1
    assert seen >= 5


def test_the_car_ahead_in_bad_weather_is_as_quick_as_the_ego_on_an_ordinary_day(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    text = (
        "Ego drives on a two-lane rural road. Black ice has formed on the road in the early cold, "
        "and a vehicle in front of the ego vehicle has slowed to walking pace."
    )
    draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
    lead = next(actor for actor in draft.actors if actor.id == "lead")
    twin = draft.hazard.actors["lead"]
    assert lead.behaviour.parameters["speed"] < 0.5 * draft.ego.speed
    assert twin is not None
    assert twin.behaviour.parameters["speed"] == draft.ego.speed
    assert twin.placement == lead.placement


def test_only_vehicles_go_slower_on_slower_roads(
    author: BuiltinAuthor, ask, knowledge: Knowledge, digest: CatalogueDigest
) -> None:
    recipe = knowledge.by_id["jaywalker"].stage
    assert recipe is not None
    low, high = recipe.actors[0].parameters["speed"]
    for number in range(12):
        text = (
            "Ego drives on a two-lane residential road. A pedestrian steps off the right-hand edge "
            f"of the road, far from any crossing, and walks across the ego's lane {'.' * number}"
        )
        draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
        assert low <= draft.actors[0].behaviour.parameters["speed"] <= high


def test_the_edge_of_the_lane_in_the_text_leaves_room(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    text = (
        "Ego drives on a two-lane residential road. A large cardboard box lies at the very edge of "
        "the ego's lane 60 metres ahead."
    )
    draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
    assert draft.actors[0].placement.offset_m < -1.5


def test_traffic_in_the_text_is_on_the_road(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    text = (
        "Ego drives on a two-lane residential road, with another car approaching in the oncoming "
        "lane. A large cardboard box lies in its lane."
    )
    draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
    other = next(actor for actor in draft.actors if actor.id == "oncoming")
    assert other.placement.lane == 1
    assert "oncoming" not in draft.hazard.actors


def test_texts_on_their_own_decide(author: BuiltinAuthor, ask, digest: CatalogueDigest) -> None:
    text = "Ego drives on a two-lane residential road. A large cardboard box lies in its lane."
    one = ask(author, StageScene(text=text, path=("x", "Large cardboard box"), catalogue=digest))
    other = ask(author, StageScene(text=text, path=("x", "Fallen tree"), catalogue=digest))
    assert one == other


@pytest.mark.parametrize(
    "text",
    ["Lava from a volcano creeps over the asphalt.", "Nothing to see here."],
)
def test_what_cannot_be_staged_is_refused(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, text: str
) -> None:
    with pytest.raises(LLMError):
        ask(author, StageScene(text=text, path=(), catalogue=digest))


def test_speeds_stay_within_the_limit(
    author: BuiltinAuthor, ask, knowledge: Knowledge, digest: CatalogueDigest
) -> None:
    limits = {line.id: line.speed_limit for line in digest.maps}
    for _, text in texts_of(knowledge, digest, 1):
        draft = ask(author, StageScene(text=text, path=(), catalogue=digest))
        assert draft.ego.speed <= limits[draft.map]
        assert not re.search(r"[A-Z]{3}", draft.reasoning)

import pytest

from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._knowledge.designs import load_motions
from oodscen.author._realisation import realise
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._tree.judge_branch import JudgeBranch
from oodscen.prompts._weather_line import WeatherLimits


def branch(hazard) -> tuple[str, ...]:
    return ("Out-of-distribution", hazard.class_name.title(), hazard.family, hazard.label)


def test_every_branch_is_judged(
    author: BuiltinAuthor, ask, knowledge: Knowledge, digest: CatalogueDigest
) -> None:
    for hazard in knowledge.hazards:
        judged = ask(author, JudgeBranch(path=branch(hazard), catalogue=digest))
        assert judged.simulatable <= (hazard.stage is not None)
        assert judged.missing if not judged.simulatable else True
        assert bool(judged.missing) == (not judged.simulatable or bool(judged.substitutes))


def test_all_that_the_paper_simulated_is_simulatable(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    for hazard in author._trees.simulated:
        assert ask(author, JudgeBranch(path=branch(hazard), catalogue=digest)).simulatable


@pytest.mark.parametrize(
    ("label", "asset"),
    [("Fallen tree across the road", "fallen_tree"), ("Truck tyre lying in the lane", "tyre")],
)
def test_a_missing_asset_is_named_and_restores_the_branch(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, label: str, asset: str
) -> None:
    poorer = digest.model_copy(
        update={"assets": tuple(line for line in digest.assets if line.id != asset)}
    )
    judged = ask(author, JudgeBranch(path=("x", label), catalogue=poorer))
    assert not judged.simulatable
    (missing,) = judged.missing
    assert (missing.kind, missing.name) == ("asset", asset)
    assert missing.category is not None
    judged = ask(author, JudgeBranch(path=("x", label), catalogue=digest))
    assert judged.simulatable
    assert asset in judged.assets


@pytest.mark.parametrize(
    ("label", "line", "missing"),
    [
        ("Heavy snowfall covering the road", "night; no fog; rain up to 50 mm/h", "snow"),
        ("Thick fog at night with a vehicle ahead", "no night; fog down to 20 m", "night"),
        ("Black ice on the road", "night; road friction down to 0.5", "slippery"),
    ],
)
def test_missing_weather_is_named(
    author: BuiltinAuthor, ask, digest: CatalogueDigest, label: str, line: str, missing: str
) -> None:
    poorer = digest.model_copy(update={"weather": line})
    judged = ask(author, JudgeBranch(path=("x", label), catalogue=poorer))
    assert not judged.simulatable
    assert any(missing in item.words for item in judged.missing)


def test_an_unknown_branch_is_not_claimed(
    author: BuiltinAuthor, ask, digest: CatalogueDigest
) -> None:
    judged = ask(author, JudgeBranch(path=("x", "Alien invasion"), catalogue=digest))
    assert not judged.simulatable


def test_the_line_on_the_weather_is_read(digest: CatalogueDigest) -> None:
    assert WeatherLimits.of(
        "night; fog down to 30 m visual range; rain and snow up to 60 mm/h; road friction down to 0.15"
    ) == WeatherLimits(-90.0, 30.0, True, True, 60.0, 0.15)
    assert WeatherLimits.of("no night; no fog; no precipitation; road friction down to 1") == (
        WeatherLimits(0.0, 10_000.0, False, False, 0.0, 1.0)
    )
    assert WeatherLimits.of(digest.weather).offers("night")


def test_a_map_without_the_landmark_is_named(
    author: BuiltinAuthor, ask, rich_digest: CatalogueDigest
) -> None:
    label = "Cross traffic running a red light"
    assert ask(author, JudgeBranch(path=("x", label), catalogue=rich_digest)).simulatable
    bare = tuple(line.model_copy(update={"landmarks": ()}) for line in rich_digest.maps)
    poorer = rich_digest.model_copy(update={"maps": bare})
    judged = ask(author, JudgeBranch(path=("x", label), catalogue=poorer))
    assert [one.words for one in judged.missing] == ["a map with: junction, signalised"]


def test_a_recipe_can_be_shown_or_its_things_are_missing(
    knowledge: Knowledge, rich_digest: CatalogueDigest
) -> None:
    shown = 0
    for hazard in knowledge.hazards:
        if hazard.stage is not None:
            missing = realise(hazard, rich_digest, knowledge).missing
            assert {one.kind for one in missing} <= {"asset", "map", "behaviour"}, hazard.id
            moves = {one.name for one in missing if one.kind == "behaviour"}
            assert moves <= load_motions().keys(), hazard.id
            shown += not missing
    assert shown >= 211


def test_weather_that_no_scene_can_ask_for_is_not_offered():
    line = "night; no fog; no precipitation; road friction down to 0.1; also freezing rain, blowing snow, which no scene can ask for"
    limits = WeatherLimits.of(line)
    assert (limits.rain, limits.snow) == (False, False)
    assert limits.others == ("freezing rain", "blowing snow")
    assert limits.offers("freezing rain")

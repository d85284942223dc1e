"""Labels that somebody else wrote are taken apart, and every part is looked for."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._registry import make_catalogue
from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._reading.alternatives import alternatives, conjuncts, subject
from oodscen.author._reading.recognition import Recogniser
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._tree.judge_branch import JudgeBranch

THINGS = {
    "Deer": "deer",
    "Dog": "dog",
    "Fallen tree": "fallen_tree",
    "Mattress": "mattress",
    "Large cardboard box": "cardboard_box",
    "Cow": "cow",
    "Sofa": "sofa",
}
ENDS = ("", " on the road", " in the lane")


@pytest.fixture(scope="module")
def carla() -> CatalogueDigest:
    return CatalogueDigest.of(make_catalogue("carla-0.9.16"))


@pytest.fixture(scope="module")
def judge(author, ask, rich_digest):
    def judging(label, catalogue=rich_digest):
        return ask(author, JudgeBranch(path=("x", label), catalogue=catalogue))

    return judging


@pytest.mark.parametrize(
    ("label", "readings"),
    [
        ("Deer or dog on the road", ["Deer on the road", "dog on the road"]),
        ("Dog, cow or box in the lane", ["Dog in the lane", "cow in the lane", "box in the lane"]),
        ("Deer / dog", ["Deer", "dog"]),
        ("Either fog or snow", ["fog", "snow"]),
        ("Dog running or walking in the lane", ["Dog running in the lane", "Dog walking in the lane"]),
        ("Deer or awning on the road", ["Deer on the road", "awning on the road"]),
        ("Fire on or beside the road", ["Fire on or beside the road"]),
        ("Deer on the road or on the pavement", ["Deer on the road or on the pavement"]),
    ],
)  # fmt: skip
def test_alternatives_share_what_follows_them(label: str, readings: list[str]) -> None:
    assert [share.readings[0] for share in alternatives(label).shares] == readings


def test_and_joins_and_or_divides() -> None:
    assert len(alternatives("Fog and deer").shares) == 1
    assert [share.name for share in conjuncts("Fog and deer").shares] == ["Fog", "deer"]
    assert subject("A large dog running onto the road") == ["large", "dog"]
    assert subject("Collapsed scaffolding across the road") == ["Collapsed", "scaffolding"]


@given(st.lists(st.sampled_from(sorted(THINGS)), min_size=2, max_size=4, unique=True),
       st.sampled_from(ENDS), st.sampled_from([" or ", ", or ", " / "]))  # fmt: skip
@settings(max_examples=25)
def test_alternatives_are_united_and_narrowed_to_what_is_there(judge, names, end, joint) -> None:
    label = f"{', '.join(names[:-1])}{joint}{names[-1]}{end}"
    judged = judge(label)
    assert judged.simulatable
    assert judged.label == ""
    assert {THINGS[name] for name in names} <= set(judged.assets)


@given(st.lists(st.sampled_from(sorted(THINGS)), min_size=2, max_size=4, unique=True),
       st.sampled_from(ENDS), st.data())  # fmt: skip
@settings(max_examples=25)
def test_a_narrowed_label_names_what_is_left_and_is_shown_in_full(
    judge, rich_digest, names, end, data
) -> None:
    gone = data.draw(st.lists(st.sampled_from(names), min_size=1, unique=True))
    left = [name for name in names if name not in gone]
    away = {THINGS[name] for name in gone}
    poorer = rich_digest.model_copy(
        update={
            "assets": tuple(
                a for a in rich_digest.assets if a.id not in away and not away & set(a.names)
            )
        }
    )
    judged = judge(f"{', '.join(names[:-1])} or {names[-1]}{end}", poorer)
    assert judged.simulatable == bool(left)
    lacking = {one.name for one in judged.missing}
    if not left:
        assert lacking & away
        assert all(name.casefold() in judged.reasoning.casefold() for name in gone)
        return
    assert lacking == away
    words = judged.label.casefold()
    assert all((name.casefold() in words) == (name in left) for name in names)
    again = judge(judged.label, poorer)
    assert again.label == ""
    assert (again.assets, again.weather) == (judged.assets, judged.weather)


@pytest.mark.parametrize(
    ("label", "narrower"),
    [
        ("Heavy rain or heavy snowfall", "Heavy rain"),
        ("Dog, cow or large cardboard box on the road", "Large cardboard box on the road"),
        ("Fog or deer", "Fog"),
    ],
)
def test_carla_shows_only_the_part_without_snow_and_animals(
    judge, carla: CatalogueDigest, label: str, narrower: str
) -> None:
    judged = judge(label, carla)
    assert judged.simulatable
    assert judged.label == narrower
    assert judged.missing
    assert "Not " in judged.reasoning


def test_snowfall_needs_snow_and_ridges_need_a_ridge(judge, carla: CatalogueDigest) -> None:
    judged = judge("Snowfall or snow ridges")
    assert judged.weather == ["snow"]
    assert "snow_pile" in judged.assets
    judged = judge("Snowfall or snow ridges", carla)
    assert not judged.simulatable
    assert "snow (weather)" in judged.reasoning
    assert "snow pile" in judged.reasoning


def test_all_parts_of_a_conjunction_are_needed(judge, carla: CatalogueDigest) -> None:
    judged = judge("Fog and deer")
    assert judged.weather == ["fog"]
    assert "deer" in judged.assets
    assert [one.name for one in judge("Fog and deer", carla).missing] == ["deer"]
    assert not judge("Deer and elephant").simulatable
    assert judge("Deer on the road at night").weather == ["night"]


@pytest.mark.parametrize("label", ["Not a deer on the road", "No pedestrians anywhere", "Road without deer"])  # fmt: skip
def test_what_is_said_not_to_be_there_is_not_shown(judge, label: str) -> None:
    assert not judge(label).simulatable


@pytest.mark.parametrize("label", ["Animals on the road", "Wildlife crossing", "Elephant", "Elephant running onto the road"])  # fmt: skip
def test_a_catalogue_without_animals_says_so(judge, carla: CatalogueDigest, label: str) -> None:
    judged = judge(label, carla)
    assert not judged.simulatable
    assert "no animals at all" in judged.reasoning
    assert judged.missing[0].category == "animal"


@pytest.mark.parametrize("label", ["UFO or fallen tree on the road", "Fallen tree or UFO"])
def test_an_abbreviation_keeps_its_capitals_in_a_reason(judge, label: str) -> None:
    assert "Not UFO" in judge(label).reasoning


def test_a_word_for_a_category_is_shown_by_any_of_its_members(judge) -> None:
    judged = judge("Animals on the road")
    assert judged.simulatable
    assert {"deer", "dog", "cow"} <= set(judged.assets)
    assert judged.label == ""


def test_another_animal_and_another_costume_are_not_taken_for_the_known_one(judge) -> None:
    assert not judge("Elephant running onto the road").simulatable
    (standing,) = judge("Pedestrian in a dog costume").substitutes
    assert standing.stands_for == "dog costume"


@given(st.text(max_size=120), st.text(max_size=40))
@settings(max_examples=60)
def test_any_label_can_be_read(recogniser: Recogniser, first: str, second: str) -> None:
    for label in (first, f"{first} or {second}", f"{first} and {second}", f"{first}/{second}"):
        read = recogniser.reading(label)
        assert read == recogniser.reading(label)
        if read.split is not None:
            assert len(read.split.shares) == len(read.alternatives)


def test_what_the_author_wrote_is_read_as_it_was_meant(
    knowledge: Knowledge, recogniser: Recogniser, author: BuiltinAuthor
) -> None:
    for hazard in knowledge.hazards:
        if hazard.wider:
            assert recogniser.covered_by(hazard.wider) == (hazard, *knowledge.kin(hazard))
        joined = f"{hazard.label}, or {knowledge.hazards[0].label}"
        assert recogniser.covered_by(joined)[0] == hazard

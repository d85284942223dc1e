"""Lists of kinds: eight options, near kin, nothing that tells which is right."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scenario import Scenario
from oodscen.judging._kinds import LISTED, Kinds, merge_kinds

FAMILIES = ("Animals", "Debris", "Stranded")
LABELS = tuple(
    f"{thing} on the road"
    for thing in (
        *("Deer", "Moose", "Dog", "Cat", "Bear", "Wild boar", "Sofa", "Mattress", "Pallet"),
        *("Ladder", "Wardrobe", "Suitcase", "Boat", "Balloon", "Fire", "Tram"),
    )
)


def scenario(number: int) -> Scenario:
    label = LABELS[number]
    leaf = label.casefold().replace(" ", "-")
    path = ("OOD", "Class", FAMILIES[number % 3], label)
    return Scenario(id=f"{leaf}-001", path=path, leaf=leaf, text=label)


@given(st.lists(st.sampled_from(range(len(LABELS))), min_size=1, unique=True), st.integers(1, 3))
def test_every_kind_of_a_map_is_in_one_of_its_lists_which_tells_nothing_else(chosen, roads):
    scenarios = [scenario(number) for number in chosen]
    maps = {one.id: f"road-{index % roads}" for index, one in enumerate(scenarios)}
    kinds = Kinds.of(scenarios, maps, seed=3)
    for one in scenarios:
        place = maps[one.id]
        listed = kinds.offered(one.leaf, place)
        assert len(listed) == len(set(listed)) == min(LISTED, len(scenarios))
        assert sum(kind.holds(one.leaf) for kind in listed) == 1
        others = [other for other in scenarios if maps[other.id] == place]
        own = [other for other in others if any(kind.holds(other.leaf) for kind in listed)]
        assert any(kinds.offered(other.leaf, place) == listed for other in own)


def test_what_frames_cannot_tell_apart_is_one_kind_in_visible_words():
    labels = {
        "a": "Jogger with headphones running in the lane",
        "b": "Jogger running in the lane",
        "c": "Deer running onto the road",
    }
    kinds = merge_kinds(labels)
    assert [kind.leaves for kind in kinds] == [("a", "b"), ("c",)]
    assert kinds[0].label == "Jogger running in the lane"


def test_a_label_stays_whole_if_nothing_but_a_missing_value_would_be_left_of_it():
    kinds = merge_kinds({"a": "Sudden NA", "b": "Unexpected nothing is out of the ordinary"})
    assert [kind.label for kind in kinds] == [
        "Sudden NA",
        "Unexpected nothing is out of the ordinary",
    ]


def test_a_leaf_without_a_map_is_offered_all_the_same():
    scenarios = [scenario(number) for number in range(10)]
    listed = Kinds.of(scenarios, {}).offered(scenarios[9].leaf, "nowhere")
    assert sum(kind.holds(scenarios[9].leaf) for kind in listed) == 1
    assert len(listed) == LISTED

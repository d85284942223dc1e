"""Options of a vision model: the thing once, others that share no word with it, and none of these."""

from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.prop import Prop
from oodscen.stages._making.recognition import NONE, OPTIONS, options
from tests.made import WALL

CATALOGUE = load_catalogue()
DESCRIPTIONS = st.sampled_from(
    [
        "a low wall of red bricks",
        "a cow",
        "a dog",
        "a bus",
        *(a.description for a in CATALOGUE.assets),
    ]
)


def prop_of(description: str) -> Prop:
    return Prop.parse({**WALL, "description": description})


@given(DESCRIPTIONS)
def test_a_thing_is_one_of_several_different_labels(description):
    labels = options(prop_of(description), CATALOGUE)
    assert labels.count(description) == 1
    assert labels[-1] == NONE
    assert len(set(labels)) == len(labels) <= OPTIONS + 1
    assert options(prop_of(description), CATALOGUE) == labels


def test_things_that_share_a_word_with_it_are_no_options():
    (wall, *_) = walls = [a for a in CATALOGUE.assets if "cone" in a.description.split()]
    labels = options(prop_of(wall.description), CATALOGUE)
    assert not {a.description for a in walls if a is not wall} & {*labels}


def test_an_empty_catalogue_leaves_the_thing_and_none_of_these():
    empty = Catalogue.model_construct(assets=())
    assert options(prop_of("a cow"), empty) == ("a cow", NONE)

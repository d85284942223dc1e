from hypothesis import given
from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.stages._redteam.families import corner, thin
from tests.stages.redteam.grown import grown, shapes


def test_the_thinnest_groups_are_named():
    tree = grown([5, 1, 4, 2, 4, 9])
    assert thin(tree)[:3] == ("Family 1", "Family 3", "Family 2")
    assert set(thin(tree)) == {"Family 1", "Family 2", "Family 3"}
    assert "Interactional" in thin(grown([5]))
    assert thin(ScenarioTree.initial()) == ()
    assert set(thin(grown([2, 4]))) == {"Family 0"}
    assert set(thin(grown([2, 3, 1, 4, 3]))) == {"Family 2", "Family 0", "Family 4"}


@given(shapes, st.integers(2, 8), st.integers(1, 30))
def test_proposals_in_flight_together_look_at_different_families(shape, flying, first):
    tree = grown(shape)
    found = [corner(tree, number, of=flying) for number in range(first, first + flying)]
    assert len(set(found)) == min(flying, len(shape))
    assert set(found) <= {f"Family {number}" for number in range(len(shape))}
    assert corner(tree, first, of=1) == ""

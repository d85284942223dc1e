"""What an episode says about a choice of action."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data import Episode
from oodscen.data._episode import ACTIONS, ActionOutcome, in_order, moments, share_of
from oodscen.errors import UnknownComponent

outcomes = st.sampled_from(
    [
        ActionOutcome(safe=True),
        ActionOutcome(safe=False),
        ActionOutcome(safe=False, unavailable=True),
    ]
)
episodes = st.builds(
    Episode,
    id=st.just("a"),
    scene_id=st.just("a"),
    status=st.just("ok"),
    actions=st.dictionaries(st.sampled_from(ACTIONS), outcomes),
)


@given(episodes)
def test_the_choice_matters_where_one_action_is_safe_and_another_can_go_wrong(episode):
    ends = [(action.safe, action.unavailable) for action in episode.actions.values()]
    assert episode.is_decidable == ((True, False) in ends and (False, False) in ends)
    assert [name for name in episode.actions if name in episode.safe_set] == [
        name for name, one in episode.actions.items() if one.safe
    ]


@given(st.integers(2, 50))
def test_moments_are_in_order_at_even_distances(count):
    names = moments(count)
    assert len(set(names)) == count
    assert in_order(reversed(names)) == names
    for index, name in enumerate(names):
        assert abs(share_of(name) - index / (count - 1)) <= 0.005 + 1e-9


@pytest.mark.parametrize("name", ["", "at-0", "at-100", "at-5.5", "First", "at-٣", None])
def test_other_moments_are_a_typed_error(name):
    with pytest.raises(UnknownComponent):
        share_of(name)


def test_a_notebook_shows_what_an_action_touched():
    outcome = ActionOutcome(safe=False, contacts=("deer",), off_road=True, ran_red=True)
    episode = Episode(id="a", scene_id="a", status="ok", actions={"stop": outcome})
    assert "deer, off the road, past the red light" in episode._repr_html_()

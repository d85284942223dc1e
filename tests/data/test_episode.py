"""What an episode says about a choice of action."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data import Episode
from oodscen.data._episode import ACTIONS, ActionOutcome

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

from types import MappingProxyType

import pytest
from hypothesis import given as drawn
from hypothesis import strategies as st

from oodscen.data._episode import ActionOutcome
from oodscen.errors import LLMError, LLMTimeout
from oodscen.judging._references import AspectOption
from oodscen.judging._scoring import AnswerKey, GivenAnswers, score_answers

OUTCOMES = {
    "stop": ActionOutcome(safe=True),
    "keep_speed": ActionOutcome(safe=False, contacts=("deer",)),
    "slow_down": ActionOutcome(safe=True, marginal=True),
    "pull_over": ActionOutcome(safe=False, unavailable=True),
}
OPTIONS = (
    AspectOption(id="deer", label="Deer", leaves=("deer", "elk")),
    AspectOption(id="none", label="-"),
)
PATH = ("Everything", "Animals", "Deer on the road")

said = st.fixed_dictionaries(
    {},
    optional={
        "choice": st.sampled_from(["deer", "none", "other"]),
        "action": st.sampled_from([*OUTCOMES, None]),
    },
)


@drawn(
    said,
    st.sampled_from(["x-001", "x-001~twin"]),
    st.sampled_from(["ours", "paper"]),
    st.booleans(),
)
def test_a_verdict_adds_what_is_right_to_the_answers(fields, item, protocol, repeats) -> None:
    key = AnswerKey(item=item, path=PATH, leaf="elk", options=OPTIONS, actions=OUTCOMES,
                    is_deterministic=repeats)  # fmt: skip
    verdict = score_answers(key, GivenAnswers("m", MappingProxyType(fields), protocol=protocol))
    assert {name: getattr(verdict, name) for name in fields} == fields
    right = "none" if verdict.is_ordinary else "deer"
    assert verdict.choice_is_right == (fields["choice"] == right if "choice" in fields else None)
    action = fields.get("action")
    assert verdict.success == (action in ("stop", "slow_down") and repeats if action else None)
    assert verdict.action_is_marginal == (action == "slow_down" and protocol == "ours")
    assert (verdict.action_is_safe is None) == (action is None or verdict.action_is_marginal)
    assert (verdict.outcome == "unavailable") == (action == "pull_over")
    assert verdict.id == f"{item}@m{'#paper' if protocol == 'paper' else ''}"


@pytest.mark.parametrize(
    ("error", "outcome"),
    [(LLMTimeout("late", retryable=True), "timeout"), (LLMError("out of time, in time"), "error")],
)
def test_the_first_failure_gives_the_outcome_by_its_type(error, outcome) -> None:
    given = GivenAnswers("m", {"action": "pull_over"}, [error, LLMError("later", retryable=True)])
    verdict = score_answers(AnswerKey(item="x-001", actions=OUTCOMES), given)
    assert (verdict.outcome, verdict.status, verdict.retryable) == (outcome, "failed", True)
    assert verdict.error_type == type(error).__name__


def test_a_stored_error_holds_no_key_even_where_it_is_cut() -> None:
    key = "sk-abcdefghijklmnopqrstuvwx1234567890"
    for padding in (0, 1_980):
        error = LLMError(f"{'.' * padding} refused {key}")
        verdict = score_answers(AnswerKey(item="x-001"), GivenAnswers("m", {}, [error]))
        assert verdict.error is not None
        assert "abcdef" not in verdict.error
        assert len(verdict.error) <= 2_000

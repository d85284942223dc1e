"""The cacheable prefix of a request is what an earlier one began with."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._messages import Message
from oodscen.llm._prefix import LEAST_TOKENS, cacheable_share
from oodscen.prompts import ImagineScenario
from oodscen.protocols import Request

PROMPT = ImagineScenario(shown=("A deer crosses.",))
sizes = st.integers(0, 20_000)


def request(*turns):
    roles = ("system", *("user", "assistant") * len(turns))
    messages = [
        Message(role=role, text="x" * size) for role, size in zip(roles, turns, strict=False)
    ]
    return Request(PROMPT, tuple(messages), {})


@given(sizes, sizes)
def test_a_question_shares_its_instructions(system, user):
    share = cacheable_share(request(system, user))
    if system / 4 < LEAST_TOKENS:
        assert share == 0.0
    else:
        assert share == system / (system + user)


@given(st.integers(4 * LEAST_TOKENS, 20_000), sizes, sizes, sizes)
def test_a_repair_shares_everything_up_to_the_question(system, user, answer, faults):
    share = cacheable_share(request(system, user, answer, faults))
    assert share == (system + user) / (system + user + answer + faults)

"""What a server says that a call took is believed only where it can be true."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import BudgetExceeded, ContentFiltered, UsageError
from oodscen.llm._accounting import Ledger, accounts
from oodscen.llm._call_log import LoggedLLM
from oodscen.llm._capped import CappedLLM
from oodscen.llm._remote.budget import ANSWER_TOKENS, Price
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.llm._remote.usage import (
    MOST_ANSWERED,
    MOST_USD,
    count,
    estimate_tokens,
    plausible_usage,
)
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Completion, Request, Usage
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.llm.rogue import BEGINNING, saying, talking

PROMPT = ImagineScenario(shown=("A deer crosses.",))
REQUEST = Request(PROMPT, PROMPT.messages(), PROMPT.answer_schema())
LIES = [
    {"prompt_tokens": -1_000_000, "completion_tokens": 3},
    {"prompt_tokens": 9, "completion_tokens": -3},
    {"prompt_tokens": 10**12, "completion_tokens": 3},
    {"prompt_tokens": 9, "completion_tokens": 10**12},
    {"prompt_tokens": 1e300, "completion_tokens": 3},
    {"prompt_tokens": math.nan, "completion_tokens": 3},
    {"prompt_tokens": 9, "completion_tokens": math.inf},
    {"prompt_tokens": -math.inf, "completion_tokens": 3},
    {"prompt_tokens": 9.5, "completion_tokens": 3},
    {"prompt_tokens": "many", "completion_tokens": [3]},
    {"prompt_tokens": 0, "completion_tokens": 0},
    {},
    None,
    "nothing",
]


def serving(usage):
    choice = {"index": 0, "finish_reason": "stop", "message": {"role": "assistant", "content": "x"}}
    document = {
        "id": "0",
        "object": "chat.completion",
        "created": 0,
        "choices": [choice],
        "model": "m",
    }
    body = json.dumps({**document, "usage": usage}).encode()
    head = BEGINNING + f"content-length: {len(body)}\r\n\r\n".encode()
    return talking(saying(head + body))


@pytest.mark.parametrize("usage", LIES, ids=str)
def test_impossible_usage_is_charged_at_the_estimate(usage):
    most = estimate_tokens(REQUEST) + ANSWER_TOKENS
    limits = Limits(tokens=2 * most, prices={"m": Price(1.0, 1.0)}, patience_s=None)
    with serving(usage) as server:
        llm = LiteLLM("m", api_base=server.address, retries=0, limits=limits)
        for _ in range(2):
            try:
                completion = llm.complete(REQUEST)
            except BudgetExceeded:
                raise
            except Exception:
                continue
            assert completion.usage.input_tokens == completion.usage.output_tokens == 0
        with pytest.raises(BudgetExceeded):
            llm.complete(REQUEST)
    assert limits.budget.spent.tokens == 2 * most
    assert limits.budget.spent.cost_usd == pytest.approx(2 * most / 1e6)
    assert limits.budget.answer_tokens == ANSWER_TOKENS


@pytest.mark.parametrize(("fault", "is_billed"), [("withheld", 1), ("flagged", 1), ("filtered", 0)])
def test_an_answer_that_a_filter_withheld_counts_what_the_provider_states(fault, is_billed):
    limits = Limits(tokens=10**6, prices={"m": Price(1.0, 1.0)}, patience_s=None)
    ledger, lines = Ledger(), []
    with AnsweringServer(
        ScriptedLLM(lambda request: {"text": "A deer."}), faults=lambda index, request: fault
    ) as server:
        client = server.client("m", limits=limits)
        llm = LoggedLLM(client, lambda call: (ledger.add(call), lines.append(call.model_dump())))
        with pytest.raises(ContentFiltered) as caught:
            llm.complete(REQUEST)
    assert (caught.value.usage is not None) == bool(is_billed)
    (account,) = accounts(lines)
    tokens = account.input_tokens + account.output_tokens
    assert (tokens > 0) == bool(is_billed)
    assert limits.budget.spent.tokens == ledger.tokens == tokens
    assert account.cost_usd == pytest.approx(tokens / 1e6) == pytest.approx(ledger.cost_usd)


def test_a_discount_that_cannot_be_makes_no_cost_negative():
    usage = {
        "prompt_tokens": 9,
        "completion_tokens": 3,
        "prompt_tokens_details": {"cached_tokens": 10**9},
    }
    limits = Limits(cost_usd=1.0, patience_s=None)
    with serving(usage) as server:
        llm = LiteLLM("gpt-4o", api_base=server.address, retries=0, limits=limits)
        found = llm.complete(REQUEST).usage
    assert found.cached_tokens <= 9
    assert found.cost_usd is None or found.cost_usd >= 0
    assert limits.budget.spent.cost_usd > 0


@given(
    st.integers(-10, 10**7) | st.integers(),
    st.integers(-10, 10**6) | st.integers(),
    st.integers(),
    st.none() | st.floats(allow_nan=False, allow_infinity=False),
)
def test_what_is_believed_can_be(asked, answered, cached, cost):
    usage = Usage(input_tokens=asked, output_tokens=answered, cached_tokens=cached, cost_usd=cost)
    found = plausible_usage(usage, REQUEST)
    assert 0 <= found.cached_tokens <= found.input_tokens <= 10**6
    assert 0 <= found.output_tokens <= MOST_ANSWERED
    assert found.cost_usd is None or 0 <= found.cost_usd <= MOST_USD
    assert plausible_usage(found, REQUEST) == found
    if (asked, answered, cached, cost) == tuple(found.model_dump().values()):
        assert found == usage


@pytest.mark.parametrize("character", "\u9e7f\u306e\ub3c4\u0e01")
def test_a_character_of_a_script_without_spaces_counts_as_a_token(character):
    prompt = ImagineScenario(shown=(1_000 * character,))
    more = Request(prompt, prompt.messages(), prompt.answer_schema())
    assert estimate_tokens(more) - estimate_tokens(REQUEST) >= 990


def test_numbers_of_tokens_are_told_from_other_things():
    assert [count(value) for value in (None, 0, 7, 7.0)] == [0, 0, 7, 7]
    for value in (True, 7.5, math.nan, math.inf, -math.inf, "7", [7], -7):
        assert count(value) < 0


def test_a_model_of_ones_own_is_held_to_the_same():
    lying = Usage(input_tokens=-(10**9), output_tokens=4)
    limits = Limits(tokens=6_000, prices={"own": Price(1, 1)})
    llm = ScriptedLLM(lambda asked: Completion(text="x", usage=lying), name="own")
    calls = []
    metered = LoggedLLM(CappedLLM(llm, limits), calls.append)
    assert metered.complete(REQUEST).usage == Usage()
    with pytest.raises(BudgetExceeded):
        metered.complete(REQUEST)
    LoggedLLM(llm, calls.append).complete(REQUEST)
    ledger = Ledger()
    for call in calls:
        assert call.input_tokens == 0
        ledger.add(call)
    assert ledger.tokens == 0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -1, 1e300, "9", None, [], True])
def test_an_account_of_any_file_is_finite(value):
    names = ("input_tokens", "output_tokens", "cached_tokens", "requests", "attempt", "seconds")
    (found,) = accounts([dict.fromkeys((*names, "cost_usd"), value)])
    assert all(0 <= getattr(found, name) < 1e15 for name in (*names[:4], "seconds"))
    assert found.cost_usd is None or found.cost_usd == 1


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, 1e12])
def test_a_price_or_a_time_that_is_none_is_refused(value):
    for wrong in (
        {"prices": {"m": Price(value, 0.0)}},
        {"prices": {"m": Price(0.0, value)}},
        {"timeout_s": value},
        {"patience_s": value},
    ):
        with pytest.raises(UsageError):
            Limits(**wrong)

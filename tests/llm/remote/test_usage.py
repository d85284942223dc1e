"""What a server says that a call took is believed only where it can be true."""

import contextlib
import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._registry import make_llm
from oodscen.errors import ContentFiltered, LLMError, UsageError
from oodscen.llm._accounting import Ledger, accounts
from oodscen.llm._call_log import LoggedLLM
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
    {"prompt_tokens": 9},
    {"completion_tokens": 3},
    {"prompt_tokens": 0, "completion_tokens": 3},
    {"prompt_tokens": 9, "completion_tokens": 0},
    {},
    None,
    "nothing",
]


def serving(usage, content="x"):
    message = {"role": "assistant", "content": content}
    choice = {"index": 0, "finish_reason": "stop", "message": message}
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


def served(limits):
    """Return a function that asks a server, which answers with some text and usage, and returns what it logs."""

    def ask(usage, text):
        with serving(usage, text) as server:
            return logged(LiteLLM("m", api_base=server.address, retries=0, limits=limits))

    return ask


def own(limits):
    """Return a function that asks a class, which answers with some text and usage, and returns what it logs."""

    def ask(usage, text):
        stated = Usage(
            input_tokens=usage.get("prompt_tokens", 0),
            output_tokens=usage.get("completion_tokens", 0),
        )
        llm = ScriptedLLM(lambda request: Completion(text=text, usage=stated), name="m")
        return logged(make_llm(llm, limits=limits))

    return ask


def logged(llm):
    calls = []
    with contextlib.suppress(LLMError):
        LoggedLLM(llm, calls.append).complete(REQUEST)
    (call,) = calls
    return call


def is_stated(usage, name):
    value = usage.get(name) if isinstance(usage, dict) else None
    return isinstance(value, int) and 0 < value < MOST_ANSWERED


@pytest.mark.parametrize("usage", LIES, ids=str)
def test_the_estimate_is_charged_for_what_is_not_stated_or_impossible(usage):
    limits = Limits(tokens=10**6, prices={"m": Price(1.0, 2.0)}, patience_s=None)
    call = served(limits)(usage, "x")
    # litellm refuses a response whose usage is not made of whole numbers.
    is_read = call.status == "ok"
    asked = 9 if is_read and is_stated(usage, "prompt_tokens") else estimate_tokens(REQUEST)
    told = 3 if is_read and is_stated(usage, "completion_tokens") else ANSWER_TOKENS
    assert limits.budget.spent.tokens == asked + told
    assert limits.budget.spent.cost_usd == pytest.approx((asked + 2 * told) / 1e6)
    assert limits.budget.answer_tokens == ANSWER_TOKENS
    assert (call.input_tokens, call.output_tokens) == (
        asked % estimate_tokens(REQUEST),
        told % ANSWER_TOKENS,
    )
    assert call.cost_usd is None
    (account,) = accounts([call.model_dump()])
    assert account.cost_usd is None or not is_read


numbers = st.integers(-2, 60) | st.integers(10**6, 10**7)


@pytest.mark.parametrize("asking", [own, served])
@settings(max_examples=25)
@given(
    asked=numbers,
    told=numbers,
    text=st.sampled_from(["", "x", " "]),
    price=st.sampled_from([Price(1, 2), None]),
)
def test_each_number_is_charged_as_stated_or_else_as_estimated(asking, asked, told, text, price):
    limits = Limits(prices={} if price is None else {"m": price}, patience_s=None)
    call = asking(limits)({"prompt_tokens": asked, "completion_tokens": told}, text)
    is_asked, is_told = 0 < asked < 100, 0 < told < 100
    is_empty = is_asked and told == 0 and not text
    tokens_in = asked if is_asked else estimate_tokens(REQUEST)
    tokens_out = told if is_told or is_empty else ANSWER_TOKENS
    spent = limits.budget.spent
    assert spent.tokens == tokens_in + tokens_out
    assert spent.cost_usd == pytest.approx(price.of(tokens_in, tokens_out) if price else 0.0)
    assert call.input_tokens == is_asked * asked
    assert call.output_tokens == is_told * told
    is_known = price is not None and is_asked and (is_told or is_empty)
    assert call.cost_usd == (pytest.approx(spent.cost_usd) if is_known else None)


@pytest.mark.parametrize("asking", [own, served])
def test_what_costs_nothing_costs_nothing_whatever_its_tokens(asking):
    limits = Limits(cost_usd=0.0, prices={"m": Price(0, 0)}, patience_s=None)
    assert asking(limits)({}, "x").cost_usd == 0


@pytest.mark.parametrize(
    ("stated_usd", "logged_usd"), [(None, None), (0.0, 0.0), (0.5, 0.5), (-1.0, None), (1e9, None)]
)
def test_a_cost_that_is_stated_alone_counts_but_not_as_none_against_a_price(stated_usd, logged_usd):
    stated = Usage(cost_usd=stated_usd)
    llm = ScriptedLLM(lambda request: Completion(text="x", usage=stated), name="m")
    assert logged(llm).cost_usd == logged_usd
    limits = Limits(prices={"m": Price(1, 1)})
    assert logged(make_llm(llm, limits=limits)).cost_usd == (logged_usd or None)
    estimate = (estimate_tokens(REQUEST) + ANSWER_TOKENS) / 1e6
    assert limits.budget.spent.cost_usd == pytest.approx(logged_usd or estimate)


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


@pytest.mark.parametrize("character", "\u9e7f\u306e\ub3c4\u0e01")
def test_a_character_of_a_script_without_spaces_counts_as_a_token(character):
    prompt = ImagineScenario(shown=(1_000 * character,))
    more = Request(prompt, prompt.messages(), prompt.answer_schema())
    assert estimate_tokens(more) - estimate_tokens(REQUEST) >= 990


def test_numbers_of_tokens_are_told_from_other_things():
    assert [count(value) for value in (None, 0, 7, 7.0)] == [0, 0, 7, 7]
    for value in (True, 7.5, math.nan, math.inf, -math.inf, "7", [7], -7):
        assert count(value) < 0


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

"""Sums over calls, a second model, and caps for models of one's own."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._registry import make_llm
from oodscen.errors import AnswerError, BudgetExceeded, EndpointDown, LLMError, UsageError
from oodscen.llm._accounting import Ledger, account, accounts
from oodscen.llm._ask import ask
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.llm._capped import CappedLLM
from oodscen.llm._fallback import FallbackLLM
from oodscen.llm._remote.budget import Price
from oodscen.llm._remote.limits import Limits
from oodscen.llm._replay import RecordingLLM
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Completion, Usage
from oodscen.testing import ScriptedLLM

QUESTION = ImagineScenario(shown=("A deer crosses.",))
GOOD = {"text": "A grand piano lies across the ego vehicle's lane."}


def call(**changes):
    fields = {"purpose": "p", "prompt_version": "v", "model": "m", "sample": 0, "attempt": 1}
    return Call(**{**fields, "status": "ok", **changes})


def test_calls_are_summed_per_stage_and_model():
    calls = [
        call(stage="grow", input_tokens=10, output_tokens=1, cost_usd=0.25, requests=3, seconds=1),
        call(stage="grow", input_tokens=20, cached_tokens=5, cost_usd=0.25, attempt=2, seconds=3),
        call(stage="grow", status="failed", requests=6, seconds=2),
        call(stage="prune", cost_usd=None, input_tokens=7),
    ]
    grow, prune = accounts(item.model_dump() for item in calls)
    assert grow.group == ("grow", "m")
    assert (grow.calls, grow.requests, grow.retries) == (3, 10, 7)
    assert (grow.repairs, grow.failed) == (1, 1)
    assert (grow.input_tokens, grow.output_tokens, grow.cached_tokens) == (30, 1, 5)
    assert (grow.cost_usd, grow.p50_s, grow.p95_s, grow.seconds) == (0.5, 2, 3, 6)
    assert prune.cost_usd is None
    ledger = Ledger()
    assert str(ledger) == ""
    for item in calls[:3]:
        ledger.add(item)
    assert str(ledger) == "3 calls, 0k tokens, $0.50, 7 retries, 1 repairs, 1 failed"
    ledger.add(calls[3])
    assert "cost not known" in str(ledger)


@pytest.mark.parametrize("model", ["builtin", "constant:stop"])
def test_only_what_is_asked_of_nobody_is_free_without_a_cost(model):
    ledger = Ledger()
    ledger.add(call(model=model))
    assert str(ledger) == "1 calls"
    ledger.add(call(status="failed"))
    ledger.add(call(input_tokens=1_000, cost_usd=0.5))
    assert "1k tokens, $0.50" in str(ledger)
    ledger.add(call(cost_usd=None))
    assert "1k tokens, cost not known" in str(ledger)


@given(st.lists(st.floats(0, 100), min_size=1, max_size=50))
def test_percentiles_are_values_that_enough_calls_keep(seconds):
    found = account(("x",), [{"seconds": value} for value in seconds])
    assert found.p50_s in seconds
    assert sum(value <= found.p50_s for value in seconds) >= len(seconds) / 2
    assert sum(value <= found.p95_s for value in seconds) >= 0.95 * len(seconds)


def test_lines_of_any_kind_are_summed():
    found = account(("x",), [{}, {"seconds": "long", "cost_usd": "much", "requests": None}])
    assert (found.calls, found.requests, found.retries, found.seconds) == (2, 0, 0, 0)
    assert account(("x",), [{"requests": True, "cost_usd": True}]).requests == 0


def test_a_second_model_answers_where_the_first_does_not():
    first = ScriptedLLM([LLMError("gone"), GOOD], name="a")
    second = ScriptedLLM([GOOD], name="b")
    calls = []
    llm = FallbackLLM(LoggedLLM(first, calls.append), LoggedLLM(second, calls.append))
    assert llm.name == "a, else b"
    for sample in range(2):
        ask(llm, QUESTION, sample)
    assert [(c.model, c.status) for c in calls] == [("a", "failed"), ("b", "ok"), ("a", "ok")]


def test_the_model_that_answered_is_recorded_and_blamed(tmp_path):
    def model(is_recording):
        first = ScriptedLLM([LLMError("gone"), "no JSON"] if is_recording else [], name="a")
        fallback = FallbackLLM(first, ScriptedLLM([GOOD] if is_recording else [], name="b"))
        return RecordingLLM(fallback, tmp_path / "answers.jsonl")

    for is_recording in (True, False):
        llm = model(is_recording)
        ask(llm, QUESTION)
        with pytest.raises(AnswerError, match=r"^a gave no valid answer"):
            ask(llm, QUESTION, 1, attempts=1)
    lines = map(json.loads, (tmp_path / "answers.jsonl").read_text().splitlines())
    assert [(x["model"], x["answered_by"]) for x in lines] == [(llm.name, "b"), (llm.name, "a")]


@pytest.mark.parametrize("fault", [RuntimeError("no socket"), None])
def test_a_second_model_answers_where_the_first_breaks_its_contract(fault):
    class Broken:
        name = "broken"

        def complete(self, request):
            if fault is not None:
                raise fault
            return "words"

    assert ask(FallbackLLM(Broken(), ScriptedLLM([GOOD])), QUESTION)


def test_a_first_model_that_is_down_is_left_alone():
    first = ScriptedLLM([EndpointDown("a", "dead")] * 2, name="a")
    llm = FallbackLLM(first, ScriptedLLM(lambda asked: GOOD))
    for sample in range(3):
        ask(llm, QUESTION, sample)
    assert len(first.requests) == 1


def test_a_cap_is_no_reason_to_ask_another_model():
    second = ScriptedLLM([GOOD])
    llm = FallbackLLM(ScriptedLLM([BudgetExceeded("requests", 1, 1)]), second)
    with pytest.raises(BudgetExceeded):
        ask(llm, QUESTION)
    assert not second.requests


def test_models_of_ones_own_are_held_to_the_caps():
    usage = Usage(input_tokens=100, output_tokens=10)
    author = ScriptedLLM(
        lambda asked: Completion(text='{"text": "A sofa lies on the road there."}', usage=usage)
    )
    with pytest.raises(UsageError, match="--price function="):
        CappedLLM(author, Limits(cost_usd=1))
    limits = Limits(requests=3, cost_usd=1, prices={"function": Price(1, 1)})
    llm = CappedLLM(author, limits)
    for sample in range(3):
        ask(llm, QUESTION, sample)
    with pytest.raises(BudgetExceeded):
        ask(llm, QUESTION, 3)
    assert limits.budget.spent.tokens == 330
    assert isinstance(make_llm(author, limits=limits), CappedLLM)
    assert limits.budget.spent.cost_usd == pytest.approx(330e-6)


@pytest.mark.parametrize(("reported_usd", "spent_usd"), [(None, 3e-6), (0.0, 3e-6), (0.5, 0.5)])
def test_a_stated_price_stands_in_for_a_cost_that_is_not_reported(reported_usd, spent_usd):
    usage = Usage(input_tokens=1, output_tokens=1, cost_usd=reported_usd)
    limits = Limits(cost_usd=1, prices={"function": Price(1, 2)})
    llm = ScriptedLLM(lambda asked: Completion(text=json.dumps(GOOD), usage=usage))
    ask(CappedLLM(llm, limits), QUESTION)
    assert limits.budget.spent.cost_usd == pytest.approx(spent_usd)


def test_a_call_under_way_costs_what_the_dearest_did():
    usage = Usage(input_tokens=1, output_tokens=1, cost_usd=0.3)
    limits = Limits(cost_usd=1, prices={"function": Price(0, 0)})
    llm = CappedLLM(
        ScriptedLLM(lambda asked: Completion(text=json.dumps(GOOD), usage=usage)), limits
    )
    for sample in range(3):
        ask(llm, QUESTION, sample)
    with pytest.raises(BudgetExceeded):
        ask(llm, QUESTION, 3)


@pytest.mark.parametrize("reported", [0, 1, 3])
def test_a_call_that_fails_counts_the_requests_that_it_reports_and_at_least_one(reported):
    error = LLMError("down", requests=reported)
    limits = Limits(requests=9)
    calls = []
    llm = LoggedLLM(CappedLLM(ScriptedLLM([error]), limits), calls.append)
    with pytest.raises(LLMError):
        ask(llm, QUESTION)
    expected = max(1, reported)
    assert (limits.budget.spent.requests, calls[0].requests) == (expected, expected)


class Costly:
    """States its price, and how many requests a call took."""

    name = "costly"
    price = (1.0, 1.0)

    def complete(self, request):
        usage = Usage(input_tokens=100, output_tokens=100, cost_usd=0.5)
        return Completion(
            text='{"text": "A sofa lies on the road there."}', usage=usage, requests=7
        )


@pytest.mark.parametrize("more", [{}, {"cost_usd": 1}, {"prices": {"plain": (3.0, 1.0)}}])
def test_what_a_model_of_ones_own_is_charged_is_logged(more):
    class Plain:
        name = "plain"
        price = (1.0, 2.0)

        def complete(self, request):
            return Completion(
                text=json.dumps(GOOD), usage=Usage(input_tokens=100, output_tokens=10)
            )

    limits, calls = Limits(**more), []
    ask(make_llm(Plain(), limits=limits, log=calls.append), QUESTION)
    charged = limits.budget.spent.cost_usd
    assert charged == pytest.approx((310 if "prices" in more else 120) / 1e6)
    assert [call.cost_usd for call in calls] == [charged]


@pytest.mark.parametrize("cap", [{"requests": 7}, {"tokens": 10_000}, {"cost_usd": 0.5}])
@pytest.mark.parametrize("name", [Costly(), f"{__name__}:Costly"])
def test_limits_hold_for_every_model_that_is_made_with_them(cap, name):
    limits = Limits(**cap)
    llm = make_llm(name, limits=limits)
    with pytest.raises(BudgetExceeded):
        [ask(llm, QUESTION, sample) for sample in range(100)]
    assert limits.budget.spent.requests % 7 == 0 < limits.budget.spent.requests


class Misstated(Costly):
    """States a price, which may be none."""

    name = "misstated"


@pytest.mark.parametrize("price", [("1", "2"), (math.nan, 1), 5, (-1, -1), "free"])
def test_a_malformed_price_is_called_so(price, monkeypatch):
    monkeypatch.setattr(Misstated, "price", price)
    with pytest.raises(
        UsageError, match=r"(?s)'misstated' states is malformed.*--price misstated="
    ):
        make_llm(Misstated(), limits=Limits(cost_usd=1))
    make_llm(Misstated(), limits=Limits(requests=1))


@pytest.mark.parametrize("called", ["misstated", f"{__name__}:Misstated"])
def test_a_price_is_given_under_either_name_of_a_class(called, monkeypatch):
    monkeypatch.setattr(Misstated, "price", None)
    name = f"{__name__}:Misstated"
    with pytest.raises(UsageError, match="is not known"):
        make_llm(name, limits=Limits(cost_usd=1))
    make_llm(name, limits=Limits(cost_usd=1, prices={called: (1.0, 1.0)}))


@pytest.mark.parametrize("name", ["builtin", "constant:stop"])
def test_what_costs_nothing_is_not_capped(name):
    assert not isinstance(make_llm(name, limits=Limits(cost_usd=0)), CappedLLM)

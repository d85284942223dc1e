"""Caps are never exceeded, rates are followed, dead endpoints are given up."""

import math
import threading
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._parallel.threads import as_finished
from oodscen.errors import BudgetExceeded, EndpointDown, LLMError, RunStopped, UsageError
from oodscen.llm._remote.budget import ANSWER_TOKENS, Budget, Caps, Price, Spent
from oodscen.llm._remote.failures import FailedAttempt
from oodscen.llm._remote.limits import GRACE_S, Limits
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.llm._remote.rate_limit import JUDGING, PATIENCE_S, STRIKES, Endpoint
from oodscen.llm._remote.usage import estimate_tokens
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Request
from oodscen.testing import AnsweringServer, ScriptedLLM

PROMPT = ImagineScenario(shown=("A deer crosses.",))
AUTHOR = ScriptedLLM(lambda asked: {"text": f"A sofa. ({asked.sample})"})


def request(sample=0):
    return Request(PROMPT, PROMPT.messages(), PROMPT.answer_schema(), sample)


def ask_often(llm):
    for sample in range(200):
        llm.complete(request(sample))


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def of_kind(kind, **more):
    return FailedAttempt("no answer", kind, retryable=True, **more)


# ------------------------------------------------------------------ caps


@given(st.lists(st.tuples(st.integers(0, 50), st.integers(0, 50)), max_size=30))
def test_what_is_under_way_counts_at_what_it_may_cost(calls):
    budget = Budget(Caps(tokens=200))
    under_way = []
    for most, used in calls:
        try:
            budget.reserve(Spent(1, most))
        except BudgetExceeded:
            assert budget.spent.tokens + sum(m for m, _ in under_way) + most > 200
        else:
            under_way.append((most, min(used, most)))
        if len(under_way) > 3:
            most, used = under_way.pop(0)
            budget.settle(Spent(1, most), Spent(1, used), 0)
        assert budget.spent.tokens <= 200


def test_a_time_is_a_cap_too():
    clock = Clock()
    budget = Budget(Caps(seconds=60), clock=clock)
    clock.now = 59.0
    budget.reserve(Spent(1))
    clock.now = 60.0
    with pytest.raises(BudgetExceeded) as caught:
        budget.reserve(Spent(1))
    assert (caught.value.cap, caught.value.limit, caught.value.spent) == ("seconds", 60.0, 60.0)


@pytest.mark.parametrize("fault", [None, "http500"])
def test_a_cap_of_requests_is_never_exceeded_by_one(fault):
    limits = Limits(requests=50, concurrency=32, patience_s=None)

    def ask(sample):
        try:
            llm.complete(request(sample))
        except BudgetExceeded:
            return "stopped"
        except LLMError:
            return "failed"
        return "ok"

    faults = lambda index, asked: fault if index % 3 == 0 else None  # noqa: E731
    with AnsweringServer(AUTHOR, faults=faults) as server:
        llm = server.client("m", limits=limits)
        outcomes = [outcome for _, outcome in as_finished(ask, range(120), threads=32)]
    assert len(server.received) == limits.budget.spent.requests == 50
    assert "stopped" in outcomes


def test_a_cap_of_tokens_is_kept():
    each = estimate_tokens(request()) + 100
    limits = Limits(tokens=5 * each, patience_s=None)
    with AnsweringServer(AUTHOR) as server:
        llm = server.client("m", limits=limits, max_tokens=100)
        with pytest.raises(BudgetExceeded) as caught:
            ask_often(llm)
    assert caught.value.cap == "tokens"
    assert 4 * each < limits.budget.spent.tokens <= 5 * each


def test_a_cap_of_cost_needs_a_price_and_says_how_to_give_one():
    with pytest.raises(UsageError, match="--price nobody-knows-it="):
        LiteLLM(
            "nobody-knows-it",
            api_base="http://127.0.0.1:1/v1",
            limits=Limits(cost_usd=1),
        )
    limits = Limits(cost_usd=0.05, prices={"nobody-knows-it": Price(10.0, 0.0)}, patience_s=None)
    with AnsweringServer(AUTHOR) as server:
        llm = server.client("nobody-knows-it", limits=limits)
        usage = llm.complete(request()).usage
        assert usage.cost_usd == pytest.approx(usage.input_tokens * 1e-5)
        with pytest.raises(BudgetExceeded) as caught:
            ask_often(llm)
    assert caught.value.cap == "cost_usd"
    assert 0.03 < limits.budget.spent.cost_usd <= 0.05


def test_a_known_price_is_enough():
    with AnsweringServer(AUTHOR) as server:
        limits = Limits(cost_usd=0.001, patience_s=None)
        llm = server.client("gpt-4o", limits=limits)
        assert llm.client.price == Price(2.5, 10.0)
        with pytest.raises(BudgetExceeded):
            llm.complete(request())
    assert not server.received


def test_long_answers_raise_what_is_set_aside():
    budget = Budget()
    assert budget.answer_tokens == ANSWER_TOKENS
    budget.settle(Spent(), Spent(), 9_000)
    assert budget.answer_tokens == 9_000


# ------------------------------------------------------------------ the rate


def test_the_window_halves_once_per_wave_of_refusals_and_grows_with_answers():
    clock = Clock()
    endpoint = Endpoint("e", concurrency=16, clock=clock)
    clock.now = 1.0
    for _ in range(10):
        endpoint.note_failed_attempt(of_kind("limit", retry_after=3.0), begun=0.5)
    assert endpoint.window == 8.0
    assert endpoint.pause() == 3.0
    clock.now = 2.0
    endpoint.note_failed_attempt(of_kind("limit"), begun=1.5)
    assert endpoint.window == 4.0
    for _ in range(400):
        endpoint.note_answer()
    assert endpoint.window == 16.0


def test_a_wait_beyond_the_longest_begins_with_the_refusal_and_not_with_every_call():
    clock = Clock()
    endpoint = Endpoint("e", clock=clock)
    endpoint.note_failed_attempt(of_kind("limit", retry_after=math.inf), begun=0.0)
    clock.now = 45.0
    assert endpoint.pause(60.0) == 15.0
    clock.now = 60.0
    assert endpoint.pause(60.0) == 0.0


def test_it_never_closes():
    clock = Clock()
    endpoint = Endpoint("e", concurrency=4, clock=clock)
    for second in range(1, 20):
        clock.now = float(second)
        endpoint.note_failed_attempt(of_kind("limit"), begun=second - 0.5)
    assert endpoint.window == 1.0
    with endpoint.slot():
        pass


def test_no_more_than_the_window_are_under_way():
    limits = Limits(concurrency=3)
    lock, three = threading.Lock(), threading.Barrier(3)
    running, most = 0, 0

    def count(asked):
        nonlocal running, most
        with lock:
            running += 1
            most = max(most, running)
        three.wait(timeout=60.0)  # Each goes on once three are under way.
        with lock:
            running -= 1
        return {"text": "A sofa."}

    with AnsweringServer(ScriptedLLM(count)) as server:
        llm = server.client("m", limits=limits)
        list(as_finished(lambda n: llm.complete(request(n)), range(30), threads=12))
    assert most == 3


# ------------------------------------------------------------------ the circuit


def test_an_endpoint_that_does_not_respond_is_given_up_within_a_minute():
    clock = Clock()
    waits = []

    def sleep(seconds):
        waits.append(seconds)
        clock.now += seconds

    limits = Limits(clock=clock)
    with AnsweringServer(AUTHOR) as server:
        llm = server.client("m", limits=limits, sleep=sleep)
    stopped = None
    failed = 0
    for sample in range(20):
        try:
            llm.complete(request(sample))
        except LLMError:
            failed += 1
        except EndpointDown as error:
            stopped = error
            break
    assert clock.now <= 60.0
    assert failed <= 2
    assert server.received == []
    assert "no response" in stopped.reason
    with pytest.raises(EndpointDown):
        llm.complete(request())


def test_one_answer_is_enough_to_go_on():
    clock = Clock()
    endpoint = Endpoint("e", clock=clock)
    for second in range(0, 200, 30):
        clock.now = float(second)
        endpoint.note_failed_attempt(of_kind("unreachable"), begun=clock.now)
        endpoint.note_failed_call(of_kind("unreachable"))
        endpoint.note_answer()
    endpoint.check()


def test_an_item_that_always_fails_does_not_stop_the_others():
    def faults(index, asked):
        return "http500" if asked.sample % 7 == 3 else None

    with AnsweringServer(AUTHOR, faults=faults) as server:
        llm = server.client("m", limits=Limits(), retries=1)
        for sample in range(30):
            if sample % 7 == 3:
                with pytest.raises(LLMError):
                    llm.complete(request(sample))
            else:
                llm.complete(request(sample))


@pytest.mark.parametrize(("fault", "calls"), [("http401", 1), ("http500", 5), ("html", 5)])
def test_an_endpoint_that_fails_everybody_is_given_up(fault, calls):
    with AnsweringServer(AUTHOR, faults=lambda index, asked: fault) as server:
        llm = server.client("m", limits=Limits(), retries=0)
        for sample in range(calls - 1):
            with pytest.raises(LLMError):
                llm.complete(request(sample))
        with pytest.raises(EndpointDown):
            llm.complete(request())
        with pytest.raises(EndpointDown):
            llm.complete(request())
    assert len(server.received) == calls


def test_those_who_wait_for_a_place_are_told():
    endpoint = Endpoint("e", concurrency=1)
    told = []

    def wait():
        try:
            with endpoint.slot():
                told.append("in")
        except EndpointDown:
            told.append("down")

    with endpoint.slot():
        thread = threading.Thread(target=wait)
        thread.start()
        endpoint.note_failed_attempt(of_kind("denied"), begun=0.0)
        thread.join(5)
    assert told == ["down"]


def calls_until_given_up(endpoint, kind, most=200):
    """Give up one call after the other; return how many it took, `most` if it never was enough."""
    for count in range(1, most):
        endpoint.note_failed_attempt(of_kind(kind), begun=0.0, model="bad")
        endpoint.note_failed_call(of_kind(kind), "bad")
        try:
            endpoint.check("bad")
        except EndpointDown:
            return count
    return most


@pytest.mark.parametrize(
    ("kind", "strict", "judging", "again"),
    [
        ("erring", STRIKES, JUDGING * STRIKES, math.inf),
        ("late", STRIKES, JUDGING * STRIKES, math.inf),
        ("unreachable", STRIKES, 2 * STRIKES, 2 * STRIKES),
        ("limit", STRIKES, STRIKES, STRIKES),
        ("denied", 1, 1, 1),
        ("item", math.inf, math.inf, math.inf),
        ("filtered", math.inf, math.inf, math.inf),
    ],
)
def test_how_long_failures_count_as_the_item_s_own(kind, strict, judging, again):
    for leniency, wanted in ((1.0, strict), (JUDGING, judging), (math.inf, again)):
        endpoint = Endpoint("e", leniency=leniency, clock=lambda: 0.0)
        assert calls_until_given_up(endpoint, kind) == min(wanted, 200)
        endpoint.check("good")


def test_a_model_that_is_given_up_blocks_no_other_at_its_address():
    def faults(index, asked):
        return "http500" if asked.sample else None

    limits = Limits()
    with AnsweringServer(AUTHOR, faults=faults) as server:
        bad = server.client("bad", limits=limits, retries=0)
        for sample in range(1, STRIKES):
            with pytest.raises(LLMError):
                bad.complete(request(sample))
        with pytest.raises(EndpointDown, match="bad at "):
            bad.complete(request(STRIKES))
        assert server.client("good", limits=limits).complete(request()).text


def test_a_doubted_model_gets_one_try_until_it_answers():
    def faults(index, asked):
        return "http500" if asked.sample else None

    limits = Limits()
    with AnsweringServer(AUTHOR, faults=faults) as server, limits.lenient(math.inf):
        llm = server.client("m", limits=limits, retries=2)
        tries = []
        for sample in (*range(1, STRIKES + 3), 0, 9):
            before = len(server.received)
            with suppress(LLMError):
                llm.complete(request(sample))
            tries.append(len(server.received) - before)
    assert tries == [3] * STRIKES + [1, 1, 1, 3]


@given(st.lists(st.sampled_from(["late", "erring", "answer", "unreachable"]), max_size=40))
def test_silence_counts_from_the_last_response_of_anybody(events):
    clock = Clock()
    endpoint = Endpoint("e", leniency=math.inf, strikes=1_000, clock=clock)
    heard, waiting = -math.inf, []
    for event in events:
        begun, clock.now = clock.now - 5.0, clock.now + 15.0
        if event == "answer":
            endpoint.note_answer()
        else:
            endpoint.note_failed_attempt(of_kind(event), begun)
        if event == "unreachable":
            waiting.append(begun)
        else:
            heard, waiting = clock.now, []
        if waiting and clock.now - max(heard, waiting[0]) >= PATIENCE_S:
            with pytest.raises(EndpointDown, match="no response"):
                endpoint.check("anybody")
            return
        endpoint.check("anybody")


@given(st.floats(0.0, 1e5), st.floats(0.0, 60.0))
def test_the_time_in_which_nobody_asks_is_no_silence(idle_s, refused_s):
    clock = Clock()
    endpoint = Endpoint("e", clock=clock)
    endpoint.note_failed_attempt(of_kind("unreachable"), begun=0.0)
    endpoint.note_failed_call(of_kind("unreachable"))
    begun = clock.now = idle_s
    for at in (begun, begun + refused_s):
        clock.now = at
        endpoint.note_failed_attempt(of_kind("unreachable"), begun=at)
    silence_s = clock.now - begun
    if silence_s < PATIENCE_S:
        endpoint.check()
    else:
        with pytest.raises(EndpointDown, match=f"no response for {silence_s:.0f} s"):
            endpoint.check()


def test_what_is_still_asked_while_a_call_fails_counts_as_silence():
    clock = Clock()
    endpoint = Endpoint("e", clock=clock)
    with endpoint.slot():
        with endpoint.slot() as begun:
            pass
        endpoint.note_failed_attempt(of_kind("unreachable"), begun)
        endpoint.note_failed_call(of_kind("unreachable"))
        clock.now = PATIENCE_S
    endpoint.note_failed_attempt(of_kind("unreachable"), begun=PATIENCE_S)
    with pytest.raises(EndpointDown):
        endpoint.check()


def test_what_hangs_while_others_are_answered_stops_nobody():
    def faults(index, asked):
        return "slow" if asked.sample % 3 == 0 else None

    limits = Limits()
    with AnsweringServer(AUTHOR, faults=faults) as server, limits.lenient(JUDGING):
        llm = server.client("m", limits=limits, timeout_s=0.05, retries=0)

        def ask(sample):
            try:
                return llm.complete(request(sample)).text
            except LLMError as error:
                return type(error).__name__

        found = dict(as_finished(ask, range(15), threads=4))
    late = {sample for sample, said in found.items() if said == "LLMTimeout"}
    assert late >= set(range(0, 15, 3))
    assert "EndpointDown" not in found.values()


def test_an_interrupted_run_begins_nothing_waits_for_nothing_and_can_go_on():
    clock = Clock()
    limits = Limits(clock=clock)
    with AnsweringServer(AUTHOR) as server:
        llm = server.client("m", limits=limits)
        limits.close()
        with pytest.raises(RunStopped):
            llm.complete(request())
        assert not server.received
        limits.sleep(1e6)
        assert not limits.is_over()
        clock.now += GRACE_S
        limits.close()
        assert limits.is_over()
        limits.reopen()
        assert not limits.is_over()
        assert llm.complete(request()).text


def test_models_of_one_address_share_their_endpoint():
    limits = Limits()
    assert limits.endpoint("a") is limits.endpoint("a")
    assert limits.endpoint("a") is not limits.endpoint("b")

"""Every HTTP request is counted once, however its call ends."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from oodscen.errors import EndpointDown, LLMError, ModelSkipped, RunStopped
from oodscen.llm._accounting import Ledger, account
from oodscen.llm._call_log import LoggedLLM
from oodscen.llm._circuit_breaker import CircuitBreakerLLM
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.rate_limit import JUDGING, STRIKES
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Request
from oodscen.testing import AnsweringServer, ScriptedLLM

PROMPT = ImagineScenario(shown=("A deer crosses.",))
AUTHOR = ScriptedLLM(lambda asked: {"text": f"A sofa. ({asked.sample})"})
FAULTS = [None, "http400", "http401", "http429", "http500", "html", "reset", "withheld", "null"]


def request(sample=0):
    return Request(PROMPT, PROMPT.messages(), PROMPT.answer_schema(), sample)


@settings(max_examples=12, deadline=None)
@example(faults=["http429"] * 60, strikes=2, cap=None, last_wait=99)
@example(faults=["http429"] * 60, strikes=9, cap=None, last_wait=3)
@given(
    faults=st.lists(st.sampled_from(FAULTS), max_size=30),
    strikes=st.integers(1, 3),
    cap=st.none() | st.integers(1, 12),
    last_wait=st.integers(0, 20),
)
def test_a_request_is_counted_however_its_call_ends(faults, strikes, cap, last_wait):
    waits, calls, ledger = [], [], Ledger()

    def sleep(seconds):
        waits.append(seconds)
        if len(waits) == last_wait:
            raise KeyboardInterrupt

    limits = Limits(strikes=strikes, requests=cap)
    with AnsweringServer(
        AUTHOR, faults=lambda index, asked: faults[index] if index < len(faults) else None
    ) as server:
        client = server.client("m", limits=limits, retries=2, sleep=sleep)
        llm = CircuitBreakerLLM(LoggedLLM(client, calls.append))
        for sample in range(8):
            before = len(server.received)
            error = None
            try:
                llm.complete(request(sample))
            except (LLMError, RunStopped, KeyboardInterrupt) as caught:
                error = caught
            sent = len(server.received) - before
            assert calls[-1].requests == sent
            if isinstance(error, LLMError):
                assert isinstance(error, ModelSkipped) == (sent == 0)
    total = account(("all",), [call.model_dump() for call in calls])
    for call in calls:
        ledger.add(call)
    assert total.requests == limits.budget.spent.requests == len(server.received)
    assert total.retries == ledger.retries == sum(max(0, call.requests - 1) for call in calls)


def test_a_lasting_rate_limit_gives_a_judged_model_up_after_five_calls():
    limits = Limits()
    with (
        AnsweringServer(AUTHOR, faults=lambda index, asked: "http429") as server,
        limits.lenient(JUDGING),
    ):
        llm = server.client("m", limits=limits, retries=1)
        for sample in range(STRIKES - 1):
            with pytest.raises(LLMError):
                llm.complete(request(sample))
        with pytest.raises(EndpointDown, match="5 calls in a row failed"):
            llm.complete(request(STRIKES))
    assert len(server.received) == 2 * STRIKES

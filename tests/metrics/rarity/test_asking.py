"""Asking a model for rarity: draws, refusals and nonsense."""

import json

import pytest

from oodscen import Metrics
from oodscen.errors import ContentFiltered, LLMError
from oodscen.metrics._rarity.asking import ask_rarity
from oodscen.metrics._rarity.rates import PublishedRate
from oodscen.protocols import Completion, Usage
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder

TEXTS = ["A red light.", "A sofa lies in the lane.", "Whisk two eggs."]


def entry(number, best, problem="none", **other):
    told = best is not None
    found = {
        "number": number,
        "unit": "log10 km",
        "low": best - 1 if told else None,
        "best": best,
        "high": best + 1 if told else None,
        "problem": problem,
    }
    return found | other


def good(request):
    shift = 0.1 * request.sample
    entries = [entry(1, 0.5 + shift), entry(2, 6.0 - shift), entry(3, None, "no driving")]
    return {"estimates": entries}


def test_the_median_of_draws_counts_and_the_interval_holds_all():
    found = ask_rarity(ScriptedLLM(good), TEXTS, draws=3)
    light, sofa, eggs = found.per_text
    assert light.draws == pytest.approx((0.5, 0.6, 0.7))
    assert light.best == pytest.approx(0.6)
    assert light.low <= min(light.draws)
    assert max(sofa.draws) <= sofa.high
    assert eggs.best is None
    assert eggs.flags == ("no driving",)
    assert found.unknown == 1


def test_a_question_that_fails_costs_only_its_own_texts():
    def answer(request):
        if "sofa" in request.messages[-1].text:
            raise LLMError("no")
        return {"estimates": [entry(1, 0.5)]}

    found = ask_rarity(ScriptedLLM(answer), TEXTS[:2], draws=2, per_call=1)
    light, sofa = found.per_text
    assert (light.best, sofa.flags) == (0.5, ("not answered",))


def test_a_model_that_can_answer_nothing_is_an_error():
    def fail(request):
        raise LLMError("nobody listens")

    with pytest.raises(LLMError, match="nobody listens"):
        ask_rarity(ScriptedLLM(fail), TEXTS, draws=2)


def test_the_interval_of_the_median_counts_groups():
    metrics = Metrics(HashEncoder(64), ["A van drives ahead."])
    texts = [f"A sofa of kind {number} lies in the lane." for number in range(6)]
    llm = ScriptedLLM(lambda _: {"estimates": [entry(n, n) for n in range(1, 7)]})
    found = metrics.rarity(texts, llm, groups=list("abcdee"))
    assert (found.interval.method, found.interval.units) == ("cluster bootstrap", 5)
    assert metrics.rarity(texts, llm, groups=list("abcddd")).interval is None


@pytest.mark.parametrize(
    "bad",
    [
        "About once in a blue moon.",
        {"estimates": []},
        {"estimates": [entry(1, 0.5), entry(2, 6.0)]},
        {"estimates": [entry(1, 0.5, unit="miles"), entry(2, 6.0), entry(3, 1.0)]},
        {"estimates": [entry(1, 0.5, unit="log10 miles"), entry(2, 6.0), entry(3, 1.0)]},
        {"estimates": [entry(1, 0.5), entry(2, 6.0) | {"best": "six"}, entry(3, 1.0)]},
        {"estimates": [entry(1, 0.5), entry(2, 1_000_000.0), entry(3, 1.0)]},
        {"estimates": [entry(1, 0.5), entry(2, 6.0, low=9.0), entry(3, 1.0)]},
        {"estimates": [entry(1, 0.5), entry(2, None), entry(3, 1.0)]},
    ],
)
def test_nonsense_is_flagged_and_never_a_figure(bad):
    found = ask_rarity(ScriptedLLM(lambda _: bad), TEXTS, draws=1)
    assert [one.flags for one in found.per_text] == [("not answered",)] * 3
    assert found.median is None


def test_one_failed_draw_leaves_the_others():
    found = ask_rarity(ScriptedLLM(lambda r: "no" if r.sample == 1 else good(r)), TEXTS, draws=3)
    assert len(found.per_text[0].draws) == 2


@pytest.mark.parametrize(("stated_usd", "total_usd"), [(0.5, 0.75), (None, None)])
def test_an_answer_that_a_filter_withheld_costs_what_its_provider_states(stated_usd, total_usd):
    def answer(request):
        if request.sample == 1:
            usage = Usage(input_tokens=100, output_tokens=10, cost_usd=stated_usd)
            raise ContentFiltered("withheld", usage=usage)
        usage = Usage(input_tokens=100, output_tokens=10, cost_usd=0.25)
        return Completion(text=json.dumps(good(request)), usage=usage)

    found = ask_rarity(ScriptedLLM(answer), TEXTS, draws=2)
    assert found.input_tokens + found.output_tokens == 220
    assert found.cost_usd == total_usd


def test_many_texts_are_asked_in_parts_and_keep_their_order():
    def answer(request):
        texts = request.prompt.texts
        return {"estimates": [entry(n, float(t.split()[1])) for n, t in enumerate(texts, 1)]}

    texts = [f"text {n / 10}" for n in range(45)]
    found = ask_rarity(ScriptedLLM(answer), texts, draws=1, per_call=7)
    assert [one.best for one in found.per_text] == [n / 10 for n in range(45)]


@pytest.mark.parametrize("problem", ["impossible", "no driving", "not understood"])
def test_a_rate_with_a_wording_that_the_model_flags_is_left_out(problem):
    rates = [
        PublishedRate(event=f"event {n}", km=(1e3, 1e4, 1e5), source="own", texts=("One.", "Two."))
        for n in range(2)
    ]

    def answer(request):
        if request.prompt.texts == tuple(TEXTS):
            return good(request)
        entries = [entry(number, 5.0) for number in range(1, 5)]
        return {"estimates": [entry(1, None, problem), *entries[1:]]}

    found = ask_rarity(ScriptedLLM(answer), TEXTS, anchors=rates, draws=1)
    assert found.unanswered_rates == 1
    assert found.calibration.anchors == 1


def test_metrics_take_a_model():
    metrics = Metrics(HashEncoder(64), ["A car."])
    assert metrics.rarity(TEXTS, ScriptedLLM(good)).per_text[1].best == pytest.approx(5.9)

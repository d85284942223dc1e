"""Per answer type: a valid answer hidden in noise is found, and damage ends as faults in words.

Each law is tried for each type a fifth as often as other laws are tried.
"""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from oodscen._words.text import whole
from oodscen.data._scene import Actor, Ego, Hazard, Placement, Trigger
from oodscen.data._weather import Weather
from oodscen.llm._reading import read_answer
from oodscen.prompts import QUESTIONS
from oodscen.prompts._scenario.stage_scene import SceneDraft
from oodscen.prompts._tree.place_scenario import PlacedScenario
from tests import strategies  # noqa: F401  # says how claims are drawn

often = settings(
    max_examples=settings.default.max_examples // 5,
    suppress_health_check=[HealthCheck.too_slow],
)
KINDS = list(dict.fromkeys(question.answer for question in QUESTIONS.values()))

words = st.text(min_size=1, max_size=30).filter(str.strip)
numbers = st.floats(0.5, 40.0)
placements = st.builds(Placement, ahead_m=numbers)
actors = st.lists(
    st.builds(
        Actor,
        id=st.from_regex(r"[a-z][a-z0-9]{0,5}", fullmatch=True),
        asset=words,
        placement=placements,
    ),
    max_size=2,
    unique_by=lambda actor: actor.id,
)
drafts = st.builds(
    SceneDraft,
    reasoning=words,
    map=words,
    ego=st.builds(Ego, speed=numbers),
    actors=actors,
    hazard=st.just(Hazard(weather=Weather())),
    decision=st.builds(Trigger, value=numbers),
    horizon_s=numbers,
)

prose = st.text(
    st.characters(exclude_characters="{}", exclude_categories=["Cs"]), max_size=60
) | st.sampled_from(
    ["Sure! ", "The set {x} holds. ", "Open { and ", "f(x) = {1, 2}. ", "**Answer:** "]
)
FORMS = (
    "{before}{answer}{after}",
    "{before}\n```json\n{answer}\n```\n{after}",
    "```\r\n{answer}\r\n```",
    "\ufeff{answer}",
    "<think>{before} {draft}</think>\n{answer}",
    "<thinking>{before}</thinking>{answer}",
    "{before}{answer}\nOnce more: {answer}",
    '{{"answer": {answer}}}',
    "{before}{comma}{after}",
    "{string}",
)


def answers(kind):
    return drafts if kind is SceneDraft else st.from_type(kind)


def dumped(answer, indent):
    return json.dumps(answer.model_dump(mode="json"), indent=indent, ensure_ascii=indent is None)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_valid_answer_hidden_in_noise_is_found(kind):
    @often
    @given(
        answers(kind),
        answers(kind),
        st.sampled_from(FORMS),
        prose,
        prose,
        st.sampled_from([None, 2]),
    )
    def law(answer, draft, form, before, after, indent):
        text = dumped(answer, indent)
        raw = form.format(
            answer=text,
            before=before,
            after=after,
            draft=dumped(draft, None),
            comma=f"{text[:-1]},}}",
            string=json.dumps(text),
        )
        assert read_answer(raw, kind) == (answer, [])

    law()


broken = st.text(
    st.sampled_from('\ud800\udfff\ud83d\ude00\\"u\x00\u202e') | st.characters(), max_size=8
)


@given(broken, broken, st.booleans())
def test_halves_of_characters_never_get_into_an_answer(reasoning, label, is_escaped):
    told = {"reasoning": reasoning, "decision": "add", "node": "a", "label": label}
    found, issues = read_answer(json.dumps(told, ensure_ascii=is_escaped), PlacedScenario)
    assert issues == []
    expected = whole(label) if label.strip() else ""
    assert (found.label or "").encode("utf-8") == expected.encode("utf-8")
    assert json.loads(found.model_dump_json())["reasoning"] == whole(reasoning)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_damage_ends_as_an_answer_or_as_faults(kind):
    @often
    @given(
        answers(kind),
        st.sampled_from(["{", "}", '"', "'", "\\", ",", "]", "[", "", "\x00", "//"]),
        st.data(),
    )
    def law(answer, piece, data):
        text = dumped(answer, None)
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 8)))
        found, issues = read_answer(text[:start] + piece + text[end:], kind)
        assert (found is None) == bool(issues)
        assert found is None or isinstance(found, kind)

    law()

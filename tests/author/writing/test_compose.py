import re

import pytest

from oodscen._seeding import stream
from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._staging.aside import event_aside
from oodscen.author._writing.compose import Composer


def written(knowledge: Knowledge, hazard: HazardKind, count: int, seed: int = 0) -> list[str]:
    texts = Composer(knowledge).texts(hazard, stream(seed, hazard.label), set())
    return [text for text, _ in zip(texts, range(count), strict=False)]


def shared(event: str, text: str) -> float:
    """Return how much of an event a text tells."""
    words = set(folded_words(event.replace("{where}", "")).split()) - {"ego", "s", "the", "vehicle"}
    return len(words & set(folded_words(text).split())) / len(words)


@pytest.fixture(scope="module")
def many(knowledge: Knowledge) -> list[tuple[HazardKind, str]]:
    return [(h, text) for h in knowledge.hazards for text in written(knowledge, h, 12, seed=3)]


def test_every_hazard_yields_many_distinct_texts(many: list[tuple[HazardKind, str]]) -> None:
    by_hazard: dict[str, set[str]] = {}
    for hazard, text in many:
        by_hazard.setdefault(hazard.id, set()).add(folded_words(text))
    assert {len(texts) for texts in by_hazard.values()} == {12}


def test_no_two_texts_of_a_thousand_are_equal(many: list[tuple[HazardKind, str]]) -> None:
    assert len({folded_words(text) for _, text in many}) == len(many)


def test_texts_are_well_formed(many: list[tuple[HazardKind, str]]) -> None:
    for _, text in many:
        assert 20 <= len(text) <= 600
        assert text[0].isupper()
        assert text.endswith(".")
        assert not re.search(r"[{}]|\s\s|\s[,.;]|[,.;]{2}", text), text
        assert len(re.findall(r"\. [A-Z]", text)) <= 1, text
        assert not re.search(r"[,;] The |\b(while|when|and) The ", text), text
        assert re.search(r"\bego\b", text, re.IGNORECASE), text


def test_texts_name_the_place(knowledge: Knowledge, many: list[tuple[HazardKind, str]]) -> None:
    for hazard, text in many:
        phrases = [p for key in hazard.places for q in knowledge.place_keys[key] for p in q.phrases]
        nouns = [re.sub(r"^(on|along|in) (?=an? )", "", phrase) for phrase in phrases]
        assert any(noun.casefold() in text.casefold() for noun in nouns), text


def test_no_text_contradicts_itself(many: list[tuple[HazardKind, str]]) -> None:
    dark = r"\b(at night|after dark|it is night|a clear night)\b"
    for _, text in many:
        low = text.casefold()
        if re.search(dark, low):
            assert "sunny" not in low, text
            assert "in bright daylight" not in low, text
        if "no other" in low or "otherwise empty" in low:
            assert "oncoming car" not in low, text
            assert "another vehicle" not in low, text
        assert not ("residential" in low and "three-lane" in low), text


def test_texts_follow_from_the_stream(knowledge: Knowledge) -> None:
    for hazard in knowledge.hazards[::17]:
        assert written(knowledge, hazard, 5) == written(knowledge, hazard, 5)
        assert written(knowledge, hazard, 5) != written(knowledge, hazard, 5, seed=1)


def test_few_texts_are_varied_ones(knowledge: Knowledge) -> None:
    for hazard in knowledge.hazards:
        texts = written(knowledge, hazard, len(hazard.events))
        wordings = {event: {event, event_aside(event) or event} for event in hazard.events}
        told = {
            event
            for event in hazard.events
            for text in texts
            if any(shared(wording, text) > 0.8 for wording in wordings[event])
        }
        assert len(told) >= len(hazard.events) - 1, hazard.id


def test_what_is_taken_is_avoided(knowledge: Knowledge) -> None:
    hazard = knowledge.by_id["fallen-tree"]
    first = written(knowledge, hazard, 40)
    taken = {folded_words(text) for text in first}
    texts = Composer(knowledge).texts(hazard, stream(0, hazard.label), taken)
    second = [text for text, _ in zip(texts, range(40), strict=False)]
    assert not {folded_words(text) for text in first} & {folded_words(text) for text in second}

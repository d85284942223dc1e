"""Headlines are shorter and say the same."""

import pytest

from oodscen._seeding import stream
from oodscen._words.text import stem
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._reading.stemming import stems
from oodscen.author._writing.compose import Composer
from oodscen.author._writing.headline import headline


@pytest.mark.parametrize(
    ("clause", "line"),
    [
        ("a cat sits in the path of the ego vehicle", "cat sits in ego's path"),
        ("a van has lost a wheel", "van lost wheel"),
        ("a car that has stopped is rolling back", "car that has stopped rolling back"),
        ("a tree has fallen and lies there", "tree has fallen and lies there"),
        ("a few cars come the other way", "a few cars come the other way"),
        ("a road has no markings", "road has no markings"),
    ],
)
def test_articles_and_auxiliaries_go(clause: str, line: str) -> None:
    assert headline(clause) == line


def test_no_event_loses_a_word_that_counts(knowledge: Knowledge) -> None:
    for hazard in knowledge.hazards:
        for event in hazard.events:
            lost = set(stems(event)) - set(stems(headline(event)))
            assert lost <= set(map(stem, ("vehicle", "already", "suddenly"))), (event, lost)
            assert len(headline(event)) <= len(event)


def test_terse_texts_are_short_and_still_recognised(
    knowledge: Knowledge, recogniser: Recogniser
) -> None:
    composer, words, strange = Composer(knowledge), [], []
    for hazard in knowledge.hazards:
        text = composer.text(hazard, stream(2, hazard.id), "terse")
        words.append(len(text.split()))
        told = recogniser.recognise(text).hazard
        if told is not None and told.id != hazard.id:
            strange.append((hazard.id, text))
        assert recogniser.place(text) is not None, text
    assert 14 <= sum(words) / len(words) <= 20
    assert strange == []

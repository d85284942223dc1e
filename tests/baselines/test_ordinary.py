import re
import subprocess
import sys

import pytest

from oodscen._words.text import folded_words
from oodscen.baselines._handwritten import handwritten_driving
from oodscen.baselines._ordinary import draw, ordinary_driving
from oodscen.errors import UsageError


@pytest.fixture(scope="module")
def drawn():
    return draw(2000)


@pytest.fixture(scope="module")
def many():
    return draw(3000, seed=3)


def test_the_baseline_is_drawn_and_written_by_hand_and_all_its_texts_differ(drawn):
    texts = ordinary_driving().texts
    assert texts == drawn + handwritten_driving().texts
    assert len({folded_words(text) for text in texts}) == len(texts)


def test_another_process_draws_the_same():
    program = "from oodscen.baselines._ordinary import ordinary_driving as o; print(o().digest())"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert run.stdout.decode().strip() == ordinary_driving().digest()


def test_a_shorter_draw_is_the_beginning_and_a_seed_another_draw(drawn):
    assert draw(50) == drawn[:50]
    assert len(set(draw(50, seed=1)) & set(drawn[:50])) < 25


def test_more_than_there_is_cannot_be_drawn(monkeypatch):
    rules = {
        "words": {"subject": ["ego"]},
        "american": {"x": "y"},
        "sky": [{"tags": []}],
        "road": [],
        "situation": [{"name": "s", "on": ["a road"], "bare": True, "captions": ["A car waits"]}],
    }
    monkeypatch.setattr("oodscen.baselines._ordinary._rules", lambda: rules)
    assert draw(1) == ("A car waits.",)
    with pytest.raises(UsageError):
        draw(2)


def test_every_text_is_written_as_an_editor_would(drawn):
    for text in drawn:
        _is_edited(text)


def _is_edited(text):
    assert re.fullmatch(r"[A-Z0-9].*(?:[a-zé]|SUV|MPV)\.", text)
    assert not re.search(r"[{}]|  |\.\.|,,| ,", text)
    assert not re.search(r"\ba (?!one-|uni|use)[aeiou]", text, re.IGNORECASE)
    assert not re.search(r"\ban (?!SUV|MPV)[^aeiou]", text, re.IGNORECASE)
    assert not re.search(r"\b(\w+) \1\b", text)
    assert all(part[0].isupper() or part[0].isdigit() for part in text.split(". "))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (r"night|dusk|evening|sunset|dark and", r"sunny|bright|sunshine|afternoon|morning"),
        (r"rain is|rainy|drizzl|in light rain", r"sunny|dry|clear (weather|morning|night)"),
        (r"one-way", r"oncoming|opposite|other way"),
        (r"motorway|freeway|highway", r"zebra|crosswalk|pedestrian|cyclist|school|tram|bus stop"),
        (r"at night|late in", r"rush hour|rush-hour|school|garbage|bin lorry"),
    ],
)
def test_no_text_contradicts_itself(many, one, other):
    both = [t for t in many if re.search(rf"\b(?:{one})", t) and re.search(rf"\b(?:{other})", t)]
    assert both == []


def test_no_text_tells_of_anything_out_of_the_ordinary(drawn):
    strange = r"accident|crash|suddenly|fog|snow|\bice\b|flood|overturned|debris|wrong way|police|ambulance|construction|road works|animal|deer"
    assert [text for text in drawn if re.search(strange, text, re.IGNORECASE)] == []

"""What can be a label, and which labels are the same."""

import csv
import html
import io
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._knowledge.loading import load_knowledge
from oodscen.judging._questions import NOTHING_UNUSUAL
from oodscen.tree._labels import label_fault, same_words
from oodscen.tree._scenario_tree import ScenarioTree
from tests.tree.woods import HOSTILE, REFUSED

PLAIN = (
    "Driver ignores a red light",
    "Drivers ignore the instructions of a traffic officer",
    "Drivers ignore previous warning signs",
    "Pedestrians ignore all rules",
    "Obstacle < 10 cm high, gap > 2 m",
    "Traffic light system: dark",
    "Brake-assist system: failure in the car ahead",
    "Q&A van of a broadcaster; R&D prototype",
    "Warning system prompts a sudden stop",
    "Signs say stop",
    "Drivers forget the rules",
    "Cyclist ignores the rules of the road",
    "Forget-me-nots on the verge",
    "Driver chooses the wrong lane",
    "Sign says 'STOP'",
    "Driver answers a call and stops",
    "Passers-by must jump aside",
    "Child repeats the prompt of a crossing guard",
    "Car follows the instructions of its satnav into a lake",
    "Gate says 'You are here'",
    "Ignored no-entry sign",
    "Mark on the road that looks like a lane",
    "Стоп-сигнал на дороге",
    "Знак STOP у дороги",
    "Φωτιά στο δρόμο",
    "T字路の転倒車",
    "`Bold` paint on the road #3",
    "Überschwemmte Straße — 50 % gesperrt",
    "شب\u200cگرد در جاده",
    "हिन्दी क\u094d\u200dष",
    "落石",
)
PIECES = (
    "<b",
    "<",
    ">",
    "&lt;",
    "&",
    "{{",
    "```",
    "\u200b",
    "\u200d",
    "\u202e",
    "fog",
    " ",
    "system:",
)
composed = st.lists(st.sampled_from(PIECES) | st.text(max_size=4), max_size=6).map("".join)


@pytest.mark.parametrize("label", [*PLAIN, *HOSTILE])
def test_plain_words_about_driving_are_labels(label):
    assert label_fault(label) == ""


@pytest.mark.parametrize("label", REFUSED)
def test_what_is_no_label_is_told(label):
    assert ScenarioTree.label_fault(label) == label_fault(label)
    assert 0 < len(label_fault(label)) < 120


MISSING = (
    *("", " ", "NA", "N/A", "n/a", "NaN", "nan", "-NaN", "-nan", "NULL", "null", "None", "<NA>"),
    *("#N/A", "#N/A N/A", "#NA", "1.#IND", "-1.#IND", "1.#QNAN", "-1.#QNAN"),
)
"""What pandas takes for a missing value."""


@given(st.sampled_from(MISSING) | st.text(max_size=4) | st.text("NAna#/-.1IDQU<>", max_size=6))
def test_no_label_is_a_missing_value_to_readers_of_tables(label):
    pandas = pytest.importorskip("pandas")
    cell = io.StringIO()
    csv.writer(cell, delimiter="\t").writerows([["option", "answer"], [label, "A"]])
    cell.seek(0)
    if not label_fault(label):
        assert not pandas.read_csv(cell, sep="\t").isna().any(axis=None)


@pytest.mark.parametrize("label", MISSING)
def test_missing_values_are_no_labels(label):
    assert label_fault(label)
    assert label_fault(f" {label.lower()} ")


def test_the_option_beside_the_kinds_is_no_label():
    for label in (NOTHING_UNUSUAL.label, NOTHING_UNUSUAL.label.upper() + "."):
        assert "names nothing" in label_fault(label)


ALIKE = {"a": "а", "c": "с", "e": "е", "o": "о", "p": "р", "x": "х", "i": "ι", "v": "ν", "A": "Α"}


@given(st.sampled_from(PLAIN[:10]), st.data())
def test_a_lookalike_within_a_word_is_refused(label, data):
    places = [i for i, char in enumerate(label) if char in ALIKE]
    chosen = data.draw(st.sets(st.sampled_from(places), min_size=1, max_size=3))
    other = "".join(ALIKE[char] if i in chosen else char for i, char in enumerate(label))
    assert label_fault(other)


def test_no_label_of_the_knowledge_base_is_refused():
    hazards = load_knowledge().hazards
    labels = {text for one in hazards for text in (one.label, one.wider, one.family) if text}
    assert len(labels) > 300
    assert [label for label in labels if label_fault(label)] == []


@given(composed)
def test_no_label_holds_markup_or_what_does_not_show(label):
    if label_fault(label):
        return
    assert html.unescape(label) == label
    assert "{{" not in label
    assert "```" not in label
    assert "<b" not in label
    hidden = {char for char in label if unicodedata.category(char) == "Cf"}
    assert hidden <= {"\u200c", "\u200d"}


@given(
    st.sampled_from(PLAIN),
    st.integers(0, 60),
    st.sampled_from("\u200b\u200e\u202e\u2060\ufeff\u00ad"),
)
def test_what_does_not_show_is_refused_and_makes_no_other_label(label, place, char):
    other = label[:place] + char + label[place:]
    assert label_fault(other)
    assert same_words(other) == same_words(label)


@given(composed)
def test_the_words_are_those_of_any_spacing_and_case(label):
    words = same_words(label)
    assert same_words(f"  {words}\u200b ") == words
    assert same_words(words.replace(" ", " \t ")) == words


def test_a_joiner_between_letters_makes_no_other_label():
    assert label_fault("Fo\u200dg bank") == ""
    assert same_words("Fo\u200dg BANK") == same_words("fog  bank")

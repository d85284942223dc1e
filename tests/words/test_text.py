"""Laws of text from outside: it can be written, and steers no terminal."""

import json
import os
import subprocess
import sys
import unicodedata
from concurrent.futures import ThreadPoolExecutor

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._words.text import (
    clean_surrogates,
    first_few,
    inflection_stem,
    is_visible,
    one_line,
    path_name,
    printable,
    stem,
    text_fault,
    whole,
)

halves = st.text(st.characters(categories=["Cs", "Cc", "Cf", "Lo", "So"]), max_size=8)


@given(halves | st.text())
def test_whole_text_is_utf_8_and_what_was_whole_stays(text):
    assert whole(text).encode().decode() == whole(text) == whole(whole(text))
    if not any(unicodedata.category(char) == "Cs" for char in text):
        assert whole(text) == text


def test_halves_that_belong_together_are_joined():
    assert whole("a\ud83d\ude00b\ud83d") == "a\U0001f600b\ufffd"


@given(halves)
def test_plain_text_holds_nothing_that_a_terminal_obeys(text):
    for char in printable(text):
        assert char in "\t\n" or unicodedata.category(char) not in ("Cc", "Cs")
        assert unicodedata.bidirectional(char) not in "LRE RLE LRO RLO PDF LRI RLI FSI PDI".split()


@pytest.mark.parametrize("text", ["", " ", "\t", "\u200b", "\ufeff", "\u3164\u2800", "\u202e"])
def test_what_shows_nothing_is_not_visible(text):
    assert not is_visible(text)
    assert is_visible(f"{text}x")


@given(st.text(alphabet=st.sampled_from("ab \t\n\u00a0\u2028")))
def test_a_line_has_the_words_and_nothing_else(text):
    assert one_line(text).split(" ") == (text.split() or [""])
    assert one_line(one_line(text)) == one_line(text)


def test_five_names_are_all_of_them_and_more_are_not_hidden():
    assert first_few([]) == ""
    assert first_few("abcde") == "a, b, c, d, e"
    assert first_few("abcdef") == "a, b, c, d, e, ..."


@pytest.mark.parametrize(
    "forms",
    [
        ("tree", "trees"),
        ("block", "blocks", "blocked", "blocking"),
        ("lorry", "lorries"),
        ("crash", "crashes", "crashed"),
        ("cone", "cones"),
        ("skid", "skidded", "skidding"),
    ],
)
def test_inflections_have_one_stem(forms):
    assert len({stem(form) for form in forms}) == 1


@given(st.from_regex("[a-z]{0,20}", fullmatch=True))
def test_any_word_has_a_stem_that_is_no_longer_than_the_word(word):
    assert len(stem(word)) <= len(word) + 1
    assert bool(stem(word)) == bool(word)


@given(halves | st.text())
def test_only_whole_words_are_texts(word):
    assert (text_fault(word) == "") == (whole(word) == word and "\0" not in word)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("a\0b", "'a\\\\u0000b' holds a null character"),
        ("a\udcff", "'a\ufffd' is not valid UTF-8"),
        ("ab\ud800", "'ab\ufffd' is not valid UTF-8"),
    ],
)
def test_the_fault_of_a_word_is_told(word, said):
    assert text_fault(word) == said


def test_a_name_that_the_locale_cannot_hold_is_not_called_wrong():
    code = "import sys; from oodscen._words.text import text_fault; print(ascii(text_fault(sys.argv[1])))"
    done = subprocess.run(
        [sys.executable, "-c", code, "st\nudy \N{LATIN SMALL LETTER E WITH ACUTE}".encode()],
        env={**os.environ, "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "'st udy \\xe9' has characters that the locale's encoding, ascii, cannot" in done.stdout
    assert "UTF-8" not in done.stdout.partition("set LC_ALL=C.UTF-8")[0]


def test_lone_surrogates_are_replaced_and_pairs_kept():
    assert clean_surrogates("a\ud800b\\ud800c\\ude00d") == "a\ufffdb\\ufffdc\\ufffdd"
    for kept in ("\\ud83d\\ude00", "\\\\ud800", "\\n\\u00e9", "\U0001f600"):
        assert clean_surrogates(kept) == kept


@given(st.dictionaries(st.text(), st.text() | st.just("gnp.\u202eexe")))
def test_json_means_the_same_after_its_escapes(value):
    value = json.loads(whole(json.dumps(value, ensure_ascii=False)))
    assert json.loads(printable(json.dumps(value, ensure_ascii=False))) == value


def test_threads_may_reduce_words_to_stems_at_once():
    words = [f"{first}{second}ings" for first in "bcdfghjk" for second in ("lock", "rak", "urn")]
    expected = [*map(inflection_stem, words)]
    inflection_stem.cache_clear()
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(lambda _: [*map(inflection_stem, words)], range(8))) == [expected] * 8


PATHS = st.lists(st.text(" /a", max_size=5), min_size=1, max_size=3)


@given(PATHS, PATHS)
def test_other_paths_have_other_names(one, other):
    assert (path_name(one) == path_name(other)) == (one == other)


def test_a_path_is_read_label_by_label():
    assert path_name(["Signs/lights", "Off"]) == "Signs/lights / Off"
    assert path_name(["Signs / lights", "Off"]) == "Signs // lights / Off"

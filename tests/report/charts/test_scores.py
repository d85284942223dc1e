from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from oodscen.report._charts.scores import (
    MOST_BESIDE,
    ScoreBar,
    ScoreRow,
    bars,
    confusion,
    intervals,
    shares,
    whisker,
)

NAMES = st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=70)


@settings(max_examples=25)
@given(st.lists(st.tuples(NAMES, st.integers(0, 9), st.integers(1, 9)), min_size=1, max_size=5))
def test_bars_are_well_formed_and_as_long_as_their_share(rows: list[tuple[str, int, int]]) -> None:
    drawn = bars(
        [
            ScoreRow(name, [ScoreBar(min(hits, n), n, 0.1, 0.9), None], 0.5)
            for name, hits, n in rows
        ],
        ["<m>", "n"],
        "Safe action",
    )
    root = etree.fromstring(drawn.__html__())
    widths = [
        float(one.get("width"))
        for one in root.iter("{*}rect", "rect")
        if one.get("class") == "series-0"
    ]
    assert widths == pytest.approx([384 * min(hits, n) / n for _, hits, n in rows], abs=0.06)
    assert len(root.findall(".//path[@class='chance']")) == len(rows)


def test_the_text_alternative_of_bars_leaves_out_what_nobody_answered() -> None:
    rows = [ScoreRow("fog", [None, None]), ScoreRow("dog", [None, ScoreBar(1, 2, 0.1, 0.9)])]
    root = etree.fromstring(bars(rows, ["m", "n"], "Safe action").__html__())
    assert root.get("aria-label") == "Safe action, by scenario type: dog: n 1 of 2"
    assert [one.text for one in root.iter("text")][1:3] == ["–", "–"]


def test_every_shortcut_has_a_dot_at_its_accuracy_in_a_row_of_its_own() -> None:
    rows = [("size", 0.5, 0.4, 0.6), ("<colour>", 0.75, 0.7, 0.8)]
    root = etree.fromstring(intervals(rows).__html__())
    dots = [(float(dot.get("cx")), float(dot.get("cy"))) for dot in root.iter("circle")]
    assert dots == [(192, 22), (288, 49)]
    assert root.get("aria-label") == "Balanced accuracy of shortcuts: size 50 %; <colour> 75 %"


def test_confusion_marks_the_diagonal() -> None:
    root = etree.fromstring(
        confusion(["fog & dust", "dog"], {(0, 0): 3, (0, 2): 1, (1, 0): 2}).__html__()
    )
    assert len(root.findall(".//rect[@class='hit']")) == 1
    assert [one.findtext("title") for one in root.findall(".//rect[@class='miss']")] == [
        "fog & dust: 1 taken for nothing unusual",
        "dog: 2 taken for fog & dust",
    ]


@given(st.integers(1, 90))
def test_the_numbers_of_the_columns_of_a_confusion_do_not_overlap(kinds: int) -> None:
    root = etree.fromstring(confusion([str(n) for n in range(kinds)], {}).__html__())
    heads = [one for one in root.iter("text") if one.get("class") == "small middle"]
    places = [float(head.get("x")) for head in heads]
    widest = 5.8 * len(str(kinds))  # 9 px digits
    assert all(after - before > widest for before, after in pairwise(places))
    assert len(heads) == kinds + 1
    assert (root.get("width") is not None) is (kinds > MOST_BESIDE)


def test_whisker_and_shares_are_well_formed() -> None:
    etree.fromstring(whisker(0.5, 0.4, 0.6).__html__())
    bars = etree.fromstring(shares([("safe", 3), ("unsafe", 1), ("unavailable", 0)]).__html__())
    assert [float(bar.get("width")) for bar in bars] == [164, 54]
    assert len(etree.fromstring(shares([("safe", 0)]).__html__())) == 0

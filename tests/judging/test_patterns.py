"""Patterns are written as phrases, in which a space stands for white space."""

import pytest

from oodscen.judging.patterns import compiled, either, few


@pytest.mark.parametrize(
    ("source", "found", "not_found"),
    [
        ("pull over", ("pull over", "pull\nover"), ("pullover",)),
        ("pull ?over", ("pull over", "pullover"), ("pull  over",)),
        ("slow *down", ("slowdown", "slow \n down"), ("slow, down",)),
        ("lane[ -]change", ("lane change", "lane-change"), ("lane\nchange",)),
        (r"lane[\] ]change", ("lane]change",), ("lane\nchange",)),
        (r"a\ b", ("a b",), ("a\nb",)),
        (f"stop {few(2)}here", ("stop here", "stop right over here"), ("stop a b c here",)),
        (either("stop", "go") + " now", ("stop now", "go now"), ("stop", "now")),
    ],
)
def test_a_space_stands_for_white_space_outside_of_classes(source, found, not_found):
    pattern = compiled(source)
    assert all(pattern.fullmatch(text) for text in found)
    assert not any(pattern.fullmatch(text) for text in not_found)


def test_one_of_several_sources_is_found():
    assert compiled("stop it", "go").findall("go, stop\nit") == ["go", "stop\nit"]

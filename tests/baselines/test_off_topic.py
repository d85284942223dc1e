import hashlib
from collections import Counter

import pytest

from oodscen.baselines._off_topic import off_topic_texts

TUNE, FROZEN = off_topic_texts("tune"), off_topic_texts("frozen")
HALVES = (*TUNE, *FROZEN)
BLIND = off_topic_texts("blind")
ALL = (*HALVES, *BLIND)


def test_there_are_enough_of_either_kind_in_either_half():
    for half in (TUNE, FROZEN):
        counts = Counter(text.kind for text in half)
        assert min(counts["near-miss"], counts["off-topic"]) >= 50
    assert abs(len(TUNE) - len(FROZEN)) <= 2


def test_all_differ():
    assert len({text.id for text in ALL}) == len({text.text for text in ALL}) == len(ALL)


@pytest.mark.parametrize("kind", ["near-miss", "off-topic"])
def test_the_split_is_decided_by_the_hash_of_the_id(kind):
    ids = sorted(
        (text.id for text in HALVES if text.kind == kind),
        key=lambda name: hashlib.sha256(f"oodscen off-topic {name}".encode()).hexdigest(),
    )
    tune = {text.id for text in TUNE if text.kind == kind}
    assert tune == set(ids[: len(ids) // 2])


@pytest.mark.parametrize("part", [TUNE, FROZEN, BLIND])
def test_near_misses_come_first(part):
    kinds = [text.kind for text in part]
    assert kinds == sorted(kinds, key=["near-miss", "off-topic"].index)
    assert len(set(kinds)) == 2

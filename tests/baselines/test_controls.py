import hashlib
from collections import Counter

import pytest

from oodscen._words.text import folded_words
from oodscen.baselines._controls import load_controls
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.errors import UsageError

TUNE, FROZEN = load_controls("tune"), load_controls("frozen")
ALL = (*TUNE, *FROZEN)


@pytest.mark.parametrize("half", [TUNE, FROZEN])
def test_each_half_is_made_of_whole_pairs(half):
    assert len(half) >= 170
    ordinary, ood = half[::2], half[1::2]
    assert {control.kind for control in ordinary} == {"ordinary"}
    assert {control.kind for control in ood} == {"ood"}
    for one, other in zip(ordinary, ood, strict=True):
        assert (one.pair, one.topic, one.split) == (other.pair, other.topic, other.split)


def test_the_halves_are_equal_and_share_nothing():
    assert len(TUNE) == len(FROZEN)
    assert not {control.pair for control in TUNE} & {control.pair for control in FROZEN}
    assert len({control.id for control in ALL}) == len(ALL)
    assert len({folded_words(control.text) for control in ALL}) == len(ALL)


def test_the_split_is_decided_by_the_hash_of_the_pair():
    by_hash = sorted(
        {control.pair for control in ALL},
        key=lambda pair: hashlib.sha256(f"oodscen controls {pair}".encode()).hexdigest(),
    )
    assert {control.pair for control in TUNE} == set(by_hash[: len(by_hash) // 2])


def test_the_sentences_of_a_pair_are_of_one_length():
    for one, other in zip(ALL[::2], ALL[1::2], strict=True):
        assert abs(len(one.text.split()) - len(other.text.split())) <= 3
    words = [sum(len(c.text.split()) for c in kind) for kind in (ALL[::2], ALL[1::2])]
    assert words[0] == pytest.approx(words[1], rel=0.05)


def test_no_control_is_in_the_baseline_or_nearly_so():
    baseline = [_grams(text) for text in ordinary_driving().texts]
    wanted = set().union(*(_grams(control.text) for control in ALL))
    holders: dict[str, list[int]] = {}
    for place, grams in enumerate(baseline):
        for gram in grams & wanted:
            holders.setdefault(gram, []).append(place)
    for control in ALL:
        own = _grams(control.text)
        shared = Counter(place for gram in own for place in holders.get(gram, ()))
        likeness = (n / (len(own) + len(baseline[place]) - n) for place, n in shared.items())
        assert max(likeness) < 0.6, control.text


def test_sentences_of_different_pairs_differ():
    grams = [_grams(control.text) for control in ALL]
    for i, own in enumerate(grams):
        for j in range(i):
            if ALL[i].pair != ALL[j].pair:
                assert len(own & grams[j]) / len(own | grams[j]) < 0.5


def _grams(text):
    letters = folded_words(text)
    return {letters[i : i + 3] for i in range(len(letters) - 2)}


def test_a_part_that_the_controls_lack_is_refused():
    with pytest.raises(UsageError, match="blind"):
        load_controls("blind")
    assert load_controls("blind", off_topic=True)

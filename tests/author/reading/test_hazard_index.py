"""The evidence for hazards depends on the words of a text alone."""

import os
import subprocess
import sys

from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._knowledge.base import Knowledge
from oodscen.author._reading.hazard_index import HazardIndex

EVIDENCE = """
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._reading.hazard_index import HazardIndex
index = HazardIndex(load_knowledge().hazards[:60])
print(*(index.evidence(hazard.events[0]) for hazard in load_knowledge().hazards[:60]))
"""


def test_the_order_of_sets_decides_nothing() -> None:
    runs = {
        subprocess.run(
            [sys.executable, "-c", EVIDENCE],
            capture_output=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("0", "1")
    }
    assert len(runs) == 1


@given(st.data())
def test_every_hazard_shares_most_with_its_own_phrases(knowledge: Knowledge, data) -> None:
    hazards = knowledge.hazards[::40]
    index = HazardIndex(hazards)
    number = data.draw(st.integers(0, len(hazards) - 1))
    phrase = data.draw(st.sampled_from(hazards[number].events)).replace("{where}", " ")
    weights, shares, distinctive = index.evidence(phrase)
    assert max(weights, key=weights.__getitem__) == number
    assert all(0.0 < share <= 1.0 + 1e-9 for share in shares.values())
    assert set(distinctive) <= set(weights)


def test_a_text_without_known_words_is_no_evidence(knowledge: Knowledge) -> None:
    index = HazardIndex(knowledge.hazards[:5])
    for text in ("", "the", "zyxwv qwertz"):
        assert index.evidence(text) == ({}, {}, {})

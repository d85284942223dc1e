"""Distances of whole sets do not depend on the draw."""

from oodscen import Metrics
from oodscen.testing._encoder import HashEncoder

TEXTS = [f"A {thing} on the road." for thing in ("deer", "box", "tyre", "ladder", "sofa")]


def test_sets_that_are_drawn_whole_give_the_same_distance_in_every_repeat() -> None:
    found = Metrics(HashEncoder()).distance(TEXTS, [text.upper() for text in TEXTS], repeats=5)
    assert (found.mmd_spread, found.frechet_spread) == (0.0, 0.0)
    assert found.mmd != 0.0

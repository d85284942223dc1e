"""Spreading texts over the paths: none has many more than another."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen import Scenario
from oodscen.stages._spread import spread, spread_subset

PATH = ("OOD", "Environmental", "Debris", "Box on the road")


@given(st.integers(1, 300), st.integers(1, 40))
def test_texts_are_shared_out_evenly(total, leaves):
    paths = {f"l{number}": PATH for number in range(leaves)}
    counts = spread(paths, total)
    assert sum(counts.values()) == total
    assert max(counts.values()) - min(counts.values()) <= 1


@given(st.lists(st.integers(1, 5), min_size=1, max_size=20), st.data())
def test_a_subset_covers_the_paths_as_evenly_as_it_can(sizes, data):
    scenarios = [
        Scenario(id=f"l{leaf}-{number:03d}", text="x", leaf=f"l{leaf}", path=PATH)
        for leaf, size in enumerate(sizes)
        for number in range(size)
    ]
    wanted = data.draw(st.integers(1, len(scenarios)))
    chosen = spread_subset(scenarios, wanted)
    assert len(chosen) == wanted
    assert [item for item in scenarios if item in chosen] == chosen
    counts = [sum(item.leaf == f"l{leaf}" for item in chosen) for leaf in range(len(sizes))]
    highest = max(counts)
    assert all(count >= min(size, highest - 1) for count, size in zip(counts, sizes, strict=True))

"""Describing: the right number of texts, ids known before, near duplicates drawn again."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen import Describer, Scenario
from oodscen.describe import spread, spread_subset
from oodscen.testing import FunctionLLM, HashEncoder

PATH = ("OOD", "Environmental", "Debris", "Box on the road")


def writer(texts):
    """Return a model that hands out prepared texts, skipping those to avoid."""

    def answer(request):
        fresh = [text for text in texts if text not in request.prompt.avoid]
        return {"texts": fresh[: request.prompt.count]}

    return FunctionLLM(answer)


def test_ids_are_numbered_within_the_leaf_and_batches_avoid_earlier_texts():
    texts = [f"The ego meets obstacle number {number} on its way." for number in range(25)]
    scenarios = Describer(writer(texts), batch=10).path("box", PATH, 23)
    assert [item.id for item in scenarios][:2] == ["box-001", "box-002"]
    assert [item.text for item in scenarios] == texts[:23]
    assert all(item.path == PATH and item.leaf == "box" for item in scenarios)


def test_near_duplicates_are_replaced():
    first = "A large cardboard box lies in the middle of the lane ahead of the ego vehicle."
    near = "In the middle of the lane ahead of the ego vehicle lies a large cardboard box."
    other = "Under a bridge the ego comes upon a carton blown there by the wind at dusk."
    describer = Describer(writer([first, near, other]), HashEncoder(), nearest=0.9)
    assert {item.text for item in describer.path("b", PATH, 2)} == {first, other}


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

"""What would restore a branch: promises that are kept, and nothing forgotten."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Pruner
from oodscen.data._additions import Addition, extend
from oodscen.stages._prune.decisions import PruneDecision, all_decisions
from oodscen.stages._prune.restoration import Restoration, restoration, restoration_rows

WANTED = st.lists(
    st.builds(
        Addition,
        kind=st.sampled_from(["asset", "weather", "behaviour", "other"]),
        name=st.sampled_from(["a", "b", "c"]),
        category=st.sampled_from(["animal", "object"]),
    ),
    min_size=1,
    max_size=3,
    unique=True,
).map(tuple)


def decided(lacks):
    return [
        PruneDecision(id=f"n{i}", path=("root", "class", f"n{i}"), keep=not one, lacks=one)
        for i, one in enumerate(lacks)
    ]


@given(st.lists(WANTED | st.just(()), max_size=8))
@settings(max_examples=50)
def test_the_ranking_accounts_for_every_leaf(lacks):
    found = restoration(decided(lacks))
    dropped = {f"n{i}" for i, one in enumerate(lacks) if one}
    steps = [leaf for step in found.sequence for leaf in step.paths]
    assert len(steps) == len(set(steps))
    assert set(steps) | set(found.beyond) == dropped
    assert not set(steps) & set(found.beyond)
    assert [step.total for step in found.sequence] == [
        sum(len(one.paths) for one in found.sequence[: i + 1]) for i in range(len(found.sequence))
    ]
    for one in found.single:
        (wanted,) = ({(a.kind, a.name)} for a in one.additions)
        alone = [{(a.kind, a.name) for a in lack} == wanted for lack in lacks]
        wanted = {f"n{i}" for i, is_alone in enumerate(alone) if is_alone}
        assert set(one.paths) == wanted
        assert len(one.paths) <= one.helps
    counts = [len(one.paths) for one in found.single]
    assert counts == sorted(counts, reverse=True)
    assert Restoration.parse(found.to_json()) == found
    assert restoration(reversed(decided(lacks))).dropped == found.dropped


@pytest.mark.parametrize("name", ["pybullet", "carla-0.9.16"])
def test_the_first_additions_restore_exactly_what_they_promise(
    name, author, diverse, catalogues, judged
):
    found = restoration(all_decisions(diverse, judged[name]))
    before = {one.id for one in judged[name] if one.keep}
    assert found.kept == len(before)
    promises = [(one.additions, set(one.paths)) for one in (*found.single[:2], found.categories[0])]
    assert promises[0][1]
    for additions, paths in promises:
        richer = Pruner(author, extend(catalogues[name], additions))
        assert {
            decision.id for decision in richer.decisions(diverse) if decision.keep
        } - before == paths


def test_the_sequence_restores_all_that_can_be(author, diverse, catalogues, judged):
    found = restoration(judged["carla-0.9.16"])
    additions = [addition for step in found.sequence for addition in step.additions]
    richer = Pruner(author, extend(catalogues["carla-0.9.16"], additions))
    dropped = {decision.id for decision in richer.decisions(diverse) if not decision.keep}
    assert dropped == set(found.beyond)


def test_rows_name_the_leaves(diverse, judged):
    labels = {node.id: node.label for node in diverse.nodes}
    found = restoration(judged["carla-0.9.16"])
    (first, *_) = rows = restoration_rows(found, labels, limit=3)
    assert len(rows) == 3
    assert first["paths"] == len(found.single[0].paths)
    assert labels[found.single[0].paths[0]] in first["labels"]


def test_a_leaf_about_which_nobody_could_be_asked_is_neither():
    failed = PruneDecision(
        id="a", path=("root", "class", "a"), keep=False, status="failed", error="down"
    )
    found = restoration([failed])
    assert (found.unknown, found.beyond, found.dropped) == (("a",), (), 1)


@pytest.mark.parametrize(
    "spellings",
    [
        ("map: tunnel + junction", "map: Junction+tunnel"),
        ("state: car: open", "state: Car:open"),
        ("an asset: fallen tree", "Fallen_Tree"),
    ],
)
def test_one_thing_is_ranked_once_however_a_model_spells_it(spellings):
    lacks = [(Addition.model_validate(spelling),) for spelling in spellings]
    found = restoration(decided([*lacks, (lacks[0][0], lacks[1][0])]))
    (only,) = found.single
    assert (only.paths, only.helps) == (("n0", "n1", "n2"), 3)

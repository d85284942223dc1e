"""What would restore a branch: promises that are kept, and nothing forgotten."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Pruner, RedTeamer, ScenarioTree, TreeGrower, make_catalogue
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


LABELS = (
    "Camper van broken down on a country road",
    "Overloaded cargo bike swaying in the lane",
    "Traffic lights failing in rush hour",
    "Deer or dog on the road",
    "Animals on the road",
    "School bus or tram",
    "Dog costume on the road",
    "Cow, horse or sheep on the road in night rain",
    "Person in a wheelchair or fallen tree on the road",
)
"""Labels that need states, several things at once, substitutes, or one of several things."""


@pytest.fixture(scope="module")
def mixed(author) -> ScenarioTree:
    tree = RedTeamer(author, iterations=12).run(TreeGrower(author).run())
    return tree.apply(
        *(
            ScenarioTree.Edit(op="add", node=f"x{i}", parent="environmental", label=label)
            for i, label in enumerate(LABELS)
        )
    )


@pytest.mark.parametrize("substitutes", [True, False])
@pytest.mark.parametrize("name", ["flat", "pybullet", "sumo", "highway", "carla-0.9.16"])
def test_additions_restore_exactly_what_they_promise_on_every_catalogue(
    name, substitutes, author, mixed
):
    catalogue = make_catalogue(name)

    def judged(*additions):
        pruner = Pruner(author, catalogue.extended(additions), substitutes=substitutes)
        return list(pruner.decisions(mixed))

    def shown(decisions):
        return {one.id for one in decisions if one.keep}

    decisions = judged()
    before, found = shown(decisions), restoration(decisions)
    for one in (*found.single[:5], *found.categories[:1]):
        assert shown(judged(*one.additions)) - before == set(one.paths), one.words
    additions = [addition for step in found.sequence for addition in step.additions]
    total = found.sequence[-1].total if found.sequence else 0
    assert len(shown(judged(*additions)) - before) == total
    assert total + len(found.beyond) == found.dropped


def test_any_alternative_of_a_label_restores_it(author, catalogues):
    tree = ScenarioTree.initial().apply(
        ScenarioTree.Edit(op="add", node="a", parent="environmental", label=LABELS[3])
    )
    found = restoration(Pruner(author, catalogues["carla-0.9.16"]).decisions(tree))
    assert [(one.words, one.paths) for one in found.single] == [
        ("an asset: deer", ("a",)),
        ("an asset: dog", ("a",)),
    ]
    (step,) = found.sequence
    assert (len(step.additions), step.total) == (1, 1)


def test_a_thing_is_added_before_its_states(catalogues):
    additions = [Addition.model_validate(text) for text in ("state: kite: torn", "asset: kite")]
    richer = extend(catalogues["pybullet"], additions)
    assert next(one for one in richer.assets if one.id == "kite").states == ("torn",)


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

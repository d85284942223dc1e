from oodscen.report.outline import Branch, outline
from oodscen.study import Study


def flat(branches: tuple[Branch, ...]) -> list[Branch]:
    return [item for branch in branches for item in (branch, *flat(branch.children))]


def test_an_outline_holds_every_node_once_in_tree_order(study: Study) -> None:
    for name in ("initial", "diverse", "simulatable"):
        tree = study.tree(name)
        branches = flat(outline(tree))
        assert [branch.id for branch in branches] == [node.id for node, _ in tree.walk()]
        assert branches[0].leaves == len(tree.leaves)


def test_fates_follow_the_decisions(study: Study) -> None:
    decisions = {decision.id: decision for decision in study.decisions}
    for branch in flat(outline(study.tree("diverse"), study.decisions)):
        assert branch.fate == ("kept" if decisions[branch.id].keep else "dropped")
        assert branch.missing == decisions[branch.id].missing


def test_attestation_belongs_to_leaves(study: Study) -> None:
    attested = [branch.id for branch in flat(outline(study.tree("initial"))) if branch.attested]
    assert attested == ["thick-fog-at-night", "cardboard-box", "wrong-way"]

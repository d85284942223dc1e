"""The narrower label of a pruning answer is a label like any other."""

import pytest

from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._tree.judge_branch import BranchJudgement, JudgeBranch
from oodscen.testing._flat import FlatSimulator
from oodscen.tree._labels import label_fault
from tests.prompts.samples import DIGEST
from tests.tree.woods import HOSTILE, REFUSED

PROMPT = JudgeBranch(path=("Scenarios", "Environmental", "Fog or hail"), catalogue=DIGEST)


def issues(label):
    answer = {"reasoning": "", "simulatable": True, "label": label, "missing": ["weather: hail"]}
    found = PROMPT.check(BranchJudgement.model_validate(answer))
    return [issue.message for issue in found if issue.path == "label"]


@pytest.mark.parametrize("label", [text for text in REFUSED if text.strip()])
def test_what_no_edit_takes_is_no_narrower_label(label):
    assert issues(label) == [label_fault(label)]


@pytest.mark.parametrize("label", ["Fog", "Obstacle < 10 cm high", *HOSTILE])
def test_what_an_edit_takes_is_one(label):
    assert issues(label) == []


@pytest.mark.parametrize("label", ["fog  OR hail", "Fo\u200dg or hail"])
def test_the_same_words_are_not_narrower(label):
    assert len(issues(label)) == 1


@pytest.mark.parametrize("missing", ["state: car:hazard", "weather: fog", "car"])
def test_what_the_catalogue_has_is_not_missing(missing):
    catalogue = CatalogueDigest.of(FlatSimulator().catalogue())
    answer = {"simulatable": False, "missing": [missing]}
    (issue,) = JudgeBranch(path=PROMPT.path, catalogue=catalogue).check(
        BranchJudgement.model_validate(answer)
    )
    assert (issue.path, issue.message[-14:]) == ("missing[0]", "is not missing")


@pytest.mark.parametrize("missing", ["state: car: on fire", "map: tunnel + roundabout", "boat"])
def test_what_the_catalogue_lacks_is_missing(missing):
    catalogue = CatalogueDigest.of(FlatSimulator().catalogue())
    answer = BranchJudgement.model_validate({"simulatable": False, "missing": [missing]})
    assert JudgeBranch(path=PROMPT.path, catalogue=catalogue).check(answer) == []

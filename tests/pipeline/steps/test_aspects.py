"""Opinions of judges on open answers: none is asked for twice, whoever judges in between."""

import json
import shutil

import pytest

from oodscen import Study
from oodscen._pipeline import run_study
from oodscen.study._stale_verdicts import OPINIONS, Tables
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import SMALL


def judge(name, *, is_right):
    """Return a judge that holds all answers for right, or all for wrong."""
    said = {"reasoning": "", "is_same_thing": is_right, "is_same_fault": is_right}
    return ScriptedLLM(lambda request: json.dumps(said), name=name)


def interrupted_judge(name):
    def interrupt(request):
        raise KeyboardInterrupt

    return ScriptedLLM(interrupt, name=name)


def judged(folder, llm, **options):
    """Judge a study anew and return it."""
    config = SMALL.model_copy(update={"judge": llm.name})
    run_study(folder, config, models={llm.name: llm}, **options)
    return Study.open(folder)


@pytest.fixture
def folder(small, tmp_path):
    return shutil.copytree(small, tmp_path / "out")


@pytest.mark.parametrize("retry", [False, True])
def test_a_judge_that_judges_again_is_not_asked_again(folder, retry):
    first, other = judge("a", is_right=True), judge("b", is_right=False)
    verdicts = judged(folder, first, retry=retry).verdicts
    requests = list(first.requests)
    assert requests
    assert judged(folder, other, retry=retry).verdicts != verdicts
    study = judged(folder, first, retry=retry)
    assert study.verdicts == verdicts
    assert first.requests == requests
    lines = list(study.store.lines(OPINIONS))
    assert len({line["id"] for line in lines}) == len(lines)
    assert {line["judge"].partition("@")[0] for line in lines} == {"a", "b"}


def test_an_interrupted_change_of_judge_leaves_no_stale_verdicts(folder):
    judged(folder, judge("a", is_right=True))
    with pytest.raises(KeyboardInterrupt):
        judged(folder, interrupted_judge("b"))
    study = Study.open(folder)
    assert any(stored_verdict.judge.startswith("a@") for stored_verdict in study.stored_verdicts)
    assert not Tables.of(study).stale(study.stored_verdicts)


def test_opinions_on_answers_that_no_longer_exist_are_dropped(folder):
    store = judged(folder, judge("a", is_right=True)).store
    lines = sorted(store.lines(OPINIONS), key=lambda line: line["id"])
    store.write_lines(OPINIONS, [{**lines[0], "id": "0" * 20}, *lines])
    judged(folder, judge("b", is_right=True))
    assert lines == [line for line in store.lines(OPINIONS) if line["judge"].startswith("a@")]

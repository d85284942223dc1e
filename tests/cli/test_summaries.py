from types import SimpleNamespace

import pytest

from oodscen._cli.summaries import exit_code, kept_verdicts, left_out, summary
from oodscen.data._verdict import Verdict
from oodscen.llm._accounting import Ledger


@pytest.mark.parametrize(
    ("authors", "told"),
    [({"llm": "m", "red_llm": "r"}, "m"), ({"llm": "m", "fallback": "f"}, "m, else by f")],
)
def test_who_wrote_the_texts_is_told_with_the_fallback(authors, told) -> None:
    numbers = ("paths", "attested", "scenarios", "scenes", "episodes", "verdicts")
    counts = {**dict.fromkeys(numbers, 1), "nodes": {"initial": 1, "diverse": 1, "simulatable": 1}}
    info = {
        "status": "success",
        "seconds": {"total": 1.0},
        "config": {"seed": 0},
        "authors": authors,
        "counts": counts,
        "failures": {},
        "usage": [
            {"group": ["grow", "m"], "calls": 2, "failed": 1},
            {"group": ["redteam", "m"], "calls": 1, "failed": 1},
            {"group": ["redteam", "f"], "calls": 3, "failed": 0},
            {"group": ["evaluate", "vlm"], "calls": 9, "failed": 0},
        ],
    }
    first, *others = summary(info).splitlines()
    assert first.endswith(f"texts by {told}")
    assert ("answered calls: m 1 of 3, f 3 of 3" in others) == ("fallback" in authors)


def test_items_without_a_whole_answer_are_told_per_model() -> None:
    verdict = Verdict(
        id="x@m",
        scene_id="x",
        model="m",
        status="failed",
        outcome="unasked",
        error="not asked: down",
    )
    others = ("answered", "unavailable", "error", "unparsed")
    rest = [verdict.model_copy(update={"outcome": outcome}) for outcome in others]
    down = verdict.model_copy(update={"model": "n", "outcome": "error", "retryable": True})
    assert left_out([verdict, verdict, *rest[:-1], down, rest[-1]]) == [
        "m: 2 items not asked: down; the same command asks them, --drop m takes the model out of "
        "the study",
        "m: 1 items failed, e.g. not asked: down; --retry-failed asks them again",
        "n: 1 items failed, e.g. not asked: down; the same command asks them again",
        "m: 1 items got an answer that cannot be read, e.g. not asked: down; --retry-failed asks them again",
    ]


def test_why_a_judge_decided_nothing_is_told_once() -> None:
    verdict = Verdict(id="x@m", scene_id="x", model="m", judge_error="the key is refused")
    assert left_out([verdict, verdict, verdict.model_copy(update={"judge_error": ""})]) == [
        "the judge: no usable answer about 2 open aspects, which the matcher scored, e.g. the key is refused; "
        "--retry-failed asks again"
    ]


def test_a_model_named_twice_is_told_once() -> None:
    ledger = Ledger()
    ledger.kept_verdicts["mm"] = "mm", 8
    ledger.kept_verdicts["other"] = "other", 2
    once = kept_verdicts(("mm", "other"), ledger, {})
    assert len(once) == 2
    assert kept_verdicts(("mm", "other", "mm"), ledger, {}) == once


@pytest.mark.parametrize(
    ("grades", "code"),
    [
        (["meets"], 0),
        (["meets", "meets"], 0),
        (["meets", "fails"], 4),
        (["fails", "unknown"], 4),
        (["meets", "unknown"], 5),
        ([], 5),
    ],
)
def test_a_failure_outweighs_doubt_and_doubt_outweighs_success(grades, code) -> None:
    assert exit_code([SimpleNamespace(grade=grade) for grade in grades]) == code

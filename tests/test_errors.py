"""All errors are one family, survive pickling, and carry their facts."""

import inspect
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import errors
from oodscen.errors import Issue, OodscenError, UnknownComponent, close_matches
from oodscen.protocols import Usage

ISSUES = (Issue("a.b", "wrong"), Issue("", "worse"))

EXAMPLES = (
    errors.OodscenError("message"),
    errors.UsageError("message"),
    errors.UnknownComponent("simulator", "pybulet", ["pybullet", "flat"]),
    errors.MissingExtra("the simulator", "pybullet", "pybullet"),
    errors.DataError("tree", ISSUES, source="tree.json"),
    errors.StudyMismatch("out", {"seed": (0, 1)}),
    errors.LLMError("message", model="gpt", retryable=True),
    errors.AnswerError("gpt", "stage-scene", ISSUES, "raw", 3),
    errors.SceneError("deer-001", ISSUES),
    errors.SimulatorError("message"),
    errors.SpawnError("deer", "deer", (1.0, 2.0, 0.0, 0.5), "no room"),
    errors.SimulatorCrash("pybullet", "its process died"),
    errors.EncoderError("message"),
    errors.StudyError("message"),
    errors.StudyMissing("out"),
    errors.FolderTaken("out", ["report.html"]),
    errors.InUse("out", "study", "process 7 on here (oodscen run out)", "2024-01-01 00:00:00 UTC"),
    errors.BudgetExceeded("requests", 10, 9),
    errors.EndpointDown("http://127.0.0.1:1/v1", "no response for 40 s"),
    errors.ResponseError("message", model="m", status=200, raw="<html>", requests=6),
    errors.LLMTimeout("message", model="m", retryable=True, requests=2),
    errors.ContentFiltered("message", model="m", usage=Usage(input_tokens=9), requests=1),
    errors.ModelSkipped("m is given up: no response for 40 s", model="m"),
    errors.ReplayMiss("replay:a.jsonl", "describe-path", [errors.Issue("sample", "3 is asked")]),
    errors.RunStopped("message"),
)

FACTS = {
    "StudyMissing": {"folder": "out"},
    "FolderTaken": {"folder": "out", "names": ("report.html",)},
    "InUse": {
        "path": "out",
        "what": "study",
        "holder": "process 7 on here (oodscen run out)",
        "since": "2024-01-01 00:00:00 UTC",
    },
    "UnknownComponent": {
        "kind": "simulator",
        "name": "pybulet",
        "known": ("flat", "pybullet"),
        "matches": ("pybullet",),
    },
    "MissingExtra": {
        "what": "the simulator",
        "extra": "pybullet",
        "module": "pybullet",
        "pip": "pip install 'oodscen[pybullet]'",
    },
    "DataError": {"noun": "tree", "issues": ISSUES, "source": "tree.json"},
    "StudyMismatch": {"folder": "out", "differences": {"seed": (0, 1)}},
    "LLMError": {"model": "gpt", "retryable": True, "requests": 0},
    "ResponseError": {
        "model": "m",
        "retryable": True,
        "requests": 6,
        "status": 200,
        "raw": "<html>",
    },
    "LLMTimeout": {"model": "m", "retryable": True, "requests": 2},
    "ContentFiltered": {
        "model": "m",
        "retryable": False,
        "requests": 1,
        "usage": Usage(input_tokens=9),
    },
    "ModelSkipped": {
        "model": "m",
        "retryable": True,
        "requests": 0,
        "reason": "m is given up: no response for 40 s",
    },
    "ReplayMiss": {
        "model": "replay:a.jsonl",
        "retryable": False,
        "requests": 0,
        "purpose": "describe-path",
        "differences": (errors.Issue("sample", "3 is asked"),),
    },
    "BudgetExceeded": {"cap": "requests", "limit": 10, "spent": 9},
    "EndpointDown": {"endpoint": "http://127.0.0.1:1/v1", "reason": "no response for 40 s"},
    "AnswerError": {
        "model": "gpt",
        "retryable": False,
        "requests": 0,
        "purpose": "stage-scene",
        "issues": ISSUES,
        "raw": "raw",
        "attempts": 3,
    },
    "SceneError": {"scene_id": "deer-001", "issues": ISSUES},
    "SimulatorCrash": {
        "simulator": "pybullet",
        "reason": "its process died",
        "retryable": False,
    },
    "SpawnError": {
        "actor": "deer",
        "asset": "deer",
        "pose": (1.0, 2.0, 0.0, 0.5),
        "reason": "no room",
    },
}


def test_a_folder_taken_by_many_files_says_that_there_are_more():
    error = errors.FolderTaken("out", "abcdefg")
    assert "a, b, c, d, e, ... already" in str(error)
    assert error.names == tuple("abcdefg")


def test_there_is_an_example_of_every_error():
    kinds = {
        kind
        for _, kind in inspect.getmembers(errors, inspect.isclass)
        if issubclass(kind, OodscenError) and kind.__module__ == errors.__name__
    }
    assert set(map(type, EXAMPLES)) == kinds


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_an_error_survives_pickling_with_its_facts(error):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again) == vars(error) == FACTS.get(type(error).__name__, {})


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda error: type(error).__name__)
def test_an_error_is_made_again_of_itself_and_of_one_message(error):
    """As Gymnasium's vector environments do with the errors of their workers."""
    kind = type(error)
    again = kind(error)
    assert (type(again), str(again), vars(again)) == (kind, str(error), vars(error))
    other = kind(ValueError("a message"))
    assert type(other) is kind
    assert "a message" in str(other)
    bare = kind("a message")
    assert "a message" in str(bare)
    given = {"message", "a message"}  # A class of one argument takes the message as its fact.
    for name in FACTS.get(kind.__name__, {}):
        fact = getattr(bare, name)
        assert not fact or fact in given or set(fact) == {0.0}
    assert str(pickle.loads(pickle.dumps(bare))) == str(bare)


def test_an_issue_reads_as_a_line():
    assert [str(issue) for issue in ISSUES] == ["a.b: wrong", "worse"]


def test_the_message_helps():
    assert "did you mean pybullet?" in str(UnknownComponent("simulator", "pybulet", ["pybullet"]))
    assert "known: a, b" in str(UnknownComponent("encoder", "zzz", ["b", "a"]))
    assert "pip install 'oodscen[llm]'" in str(errors.MissingExtra("x", "llm", "litellm"))


@given(st.text(max_size=8), st.lists(st.text(max_size=8), max_size=8))
def test_matches_come_from_what_is_known(name, known):
    matches = close_matches(name, known)
    assert len(matches) <= 3
    assert set(matches) <= set(known)


@given(st.lists(st.text(min_size=1, max_size=8), min_size=1))
def test_a_name_in_another_case_is_matched(known):
    assert (
        close_matches(known[0].upper(), known) or known[0].upper().casefold() != known[0].casefold()
    )


@pytest.mark.parametrize(
    ("attempts", "words"),
    [
        (0, "gpt was not asked 'stage-scene': "),
        (1, "gpt gave no valid answer to 'stage-scene': "),
        (3, "gpt gave no valid answer to 'stage-scene' in 3 attempts: "),
    ],
)
def test_an_answer_error_counts_what_was_asked(attempts, words):
    assert str(errors.AnswerError("gpt", "stage-scene", ISSUES, "", attempts)).startswith(words)

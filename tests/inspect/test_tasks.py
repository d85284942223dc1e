"""The tasks of inspect_ai: the same questions, answers and figures as `oodscen evaluate`."""

import base64
import gc
import hashlib
import json
import sys
import warnings
from pathlib import Path
from typing import Any

import pytest

inspect_ai = pytest.importorskip("inspect_ai")
pytest.importorskip("pyarrow")

from inspect_ai import Epochs, task_with  # noqa: E402
from inspect_ai._util.error import PrerequisiteError, exception_hook  # noqa: E402
from inspect_ai.log import EvalLog  # noqa: E402
from inspect_ai.model import ModelOutput, ModelUsage, get_model  # noqa: E402
from rich.text import Text  # noqa: E402

from oodscen import Study, evaluate  # noqa: E402
from oodscen.errors import UsageError  # noqa: E402
from oodscen.inspect import _tasks as tasks  # noqa: E402
from oodscen.judging import leaderboard  # noqa: E402
from oodscen.judging._leaderboard.rows import LeaderboardRow  # noqa: E402
from oodscen.protocols import Completion, Request  # noqa: E402
from oodscen.study._asked import asked_drives  # noqa: E402
from tests.pipeline.quick import as_made  # noqa: E402
from tests.report.conftest import build_study  # noqa: E402

SAID = {
    "Choose the one action": [
        '{"reasoning": "Room ahead.", "action": "stop"}',
        '{"action": "keep_speed"}',
        '{"action": "slow_down"}',
        "I would stop if there were room, but there is not, so brake hard.",
        "I'm sorry, I can't help with that.",
        '{"action": "change_lane_left"}',
        '{"action": "change_lane_right"}',
    ],
    "Which of these describes": [
        '{"choice": 1}',
        '{"choice": 2}',
        "Two or three.",
        '{"choice": 4}',
    ],
    "Is anything out of": [
        '{"is_ood": true, "confidence": 0.8, "aspect": "cardboard box in the lane"}',
        '{"is_ood": true, "aspect": "car driving the wrong way"}',
        '{"is_ood": false, "confidence": 0.6, "aspect": ""}',
        "It is out of the ordinary: no, it is not.",
        '{"is_ood": false}',
        "Hard to tell.",
        "It depends.",
    ],
}
"""Answers by words of their question: readable, unreadable, declined."""

DRAW = 7
"""The draw of the answers: one that leaves no outcome out."""


def says(turns: list[tuple[str, str]], images: list[str], epoch: int = 0) -> str:
    """Return an answer that depends on the conversation and the pictures alone."""
    question = turns[1][1]
    (found,) = (said for words, said in SAID.items() if words in " ".join(question.split()))
    told = json.dumps([DRAW, turns, images, epoch])
    return found[int(hashlib.sha256(told.encode()).hexdigest(), 16) % len(found)]


class Scripted:
    """The model as `oodscen evaluate` asks it."""

    name = "mockllm/model"

    def complete(self, request: Request) -> Completion:
        turns = [(message.role, message.text) for message in request.messages]
        images = [image.sha256 for message in request.messages for image in message.images]
        return Completion(text=says(turns, images))


def said_by_the_model(text: str, **options: Any) -> ModelOutput:
    """Return an answer with its usage, which inspect_ai would have to load a tokenizer for."""
    output = ModelOutput.from_content("mockllm/model", text, **options)
    output.usage = ModelUsage(input_tokens=1, output_tokens=1, total_tokens=2)
    return output


def mock(epochs: bool = False) -> Any:
    """Return the model as inspect_ai asks it."""
    asked: dict[str, int] = {}

    def answered(messages: list[Any], *_: object) -> ModelOutput:
        turns = [(message.role, message.text) for message in messages]
        pictures = [
            part.image
            for message in messages
            if not isinstance(message.content, str)
            for part in message.content
            if part.type == "image"
        ]
        images = [hashlib.sha256(_bytes(picture)).hexdigest() for picture in pictures]
        told = json.dumps([turns, images])
        asked[told] = asked.get(told, -1) + 1
        text = says(turns, images, asked[told] if epochs else 0)
        return said_by_the_model(text)

    return get_model("mockllm/model", custom_outputs=answered)


def _bytes(picture: str) -> bytes:
    if picture.startswith("data:"):
        return base64.b64decode(picture.partition(",")[2])
    return Path(picture).read_bytes()


def told_apart(folder: Path) -> Study:
    """Return a study whose ordinary drives differ from their scenes in what a model is told."""
    study = build_study(folder, per_path=4, with_twins=True)
    episodes = [
        episode.model_copy(update={"ego_speed_mps": 9.0 if episode.is_ordinary else 11.0})
        for episode in study.episodes
    ]
    study.store.write_lines("episodes.jsonl", episodes)
    study.store.write_lines("verdicts.jsonl", as_made(study, study.stored_verdicts))
    return study


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return told_apart(tmp_path_factory.mktemp("inspect") / "study")


@pytest.fixture(scope="module")
def row(study: Study) -> LeaderboardRow:
    """The row of the scripted model as the leaderboard has it."""
    verdicts = [
        evaluate(
            asked_drive.episode,
            asked_drive.frames,
            Scripted(),
            path=asked_drive.key.path,
            leaf=asked_drive.key.leaf,
            options=asked_drive.options,
            visible=asked_drive.key.visible,
        )
        for asked_drive in asked_drives(study)
    ]
    (found,) = leaderboard(verdicts, study.episodes, study.scenarios).standings
    return found


@pytest.fixture(scope="module")
def logs(study: Study, tmp_path_factory: pytest.TempPathFactory) -> dict[str, EvalLog]:
    """The logs of all tasks; of `act` also on the published data set, and with three epochs."""
    place = tmp_path_factory.mktemp("inspect-logs")
    study.publish(place / "data", forms=(), validation=0.0)
    folder = str(study.folder)
    wanted = {name: getattr(tasks, name)(study=folder) for name in FIGURES}
    wanted["published"] = tasks.act(study=str(place / "data"))
    wanted["epochs"] = task_with(tasks.act(study=folder), model=mock(epochs=True), epochs=Epochs(2))
    named = [task_with(task, name=name) for name, task in wanted.items()]
    found = logs_of(named, mock(), place / "logs", max_tasks=len(wanted))
    return {log.eval.task: log for log in found}


def logs_of(tasks: list[Any], model: Any, place: Path, **options: Any) -> list[EvalLog]:
    """Run tasks; what inspect_ai leaves open is found while its warnings are ignored."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = inspect_ai.eval(
            tasks,
            model=model,
            log_dir=str(place),
            display="none",
            score_display=False,
            **options,
        )
        gc.collect()
    assert [log.status for log in found] == ["success"] * len(tasks)
    return found


def shares(log: EvalLog) -> dict[str, float]:
    (score,) = log.results.scores
    return {name: one.value for name, one in score.metrics.items()}


FIGURES = {
    "notice": {
        "notice-both": lambda row: row.paired.notice,
        "notice": lambda row: row.detection.sensitivity,
        "alarms": lambda row: row.detection.alarms,
    },
    "name": {"name": lambda row: row.identification.open},
    "choose": {"pick": lambda row: row.identification.closed},
    "act": {
        "act-both": lambda row: row.paired.act,
        "safe": lambda row: row.control.safe,
        "needless": lambda row: row.control.needless,
    },
}


@pytest.mark.parametrize("name", FIGURES)
def test_the_figures_are_those_of_the_leaderboard_to_the_last_digit(name, logs, row):
    found = shares(logs[name])
    for figure, rate_of in FIGURES[name].items():
        rate = rate_of(row)
        assert found.get(figure) == rate.value
        assert found[f"{figure}_n"] == rate.n
        assert found[f"{figure}_missing"] == rate.missing
        assert found.get(f"{figure}_missing_wrong") == rate.with_missing_wrong
        assert found[f"{figure}_stderr"] >= 0.0


def test_the_answers_leave_no_outcome_out(row):
    assert row.identification.open.missing
    assert row.control.safe.missing
    assert 0 < row.paired.act.value < 1
    assert 0 < row.paired.notice.value < 1
    assert row.outcomes.keys() >= {"answered", "unparsed", "refused"}


def test_a_published_data_set_gives_the_figures_of_its_study(logs):
    assert shares(logs["published"]) == shares(logs["act"])


def test_epochs_are_averaged_by_answer(logs):
    assert logs["epochs"].results.total_samples == 2 * logs["act"].results.total_samples
    values = shares(logs["epochs"])
    assert 0.0 <= values["act-both"] <= values["safe"] <= 1.0
    assert shares(logs["act"]) != values


@pytest.mark.parametrize(
    ("ending", "text", "outcome", "asked"),
    [
        ("stop", "I would stop.", "answered", 1),
        ("max_tokens", '{"action": "stop"}', "answered", 1),
        ("max_tokens", "I would stop.", "unparsed", 2),
        ("model_length", "I would stop.", "unparsed", 2),
        ("content_filter", '{"action": "stop"}', "refused", 1),
    ],
)
def test_an_answer_that_was_cut_off_or_withheld_is_none(
    study, tmp_path, ending, text, outcome, asked
):
    calls = []

    def answered(*_: object) -> ModelOutput:
        calls.append(text)
        return said_by_the_model(text, stop_reason=ending)

    model = get_model("mockllm/model", custom_outputs=answered)
    (log,) = logs_of([tasks.act(study=str(study.folder))], model, tmp_path, limit=1)
    assert "safe_stderr" not in shares(log)  # One path has no spread.
    (sample,) = log.samples
    (score,) = sample.scores.values()
    assert score.metadata["outcome"] == outcome
    assert len(calls) == asked
    assert shares(log)["safe_missing"] == (outcome != "answered")


@pytest.mark.parametrize("task", [tasks.notice, tasks.name, tasks.choose, tasks.act])
def test_what_cannot_be_asked_is_refused_in_one_line(task, tmp_path, monkeypatch, study):
    tracebacks = []
    monkeypatch.setattr(sys, "excepthook", lambda *unused: tracebacks.append(unused))
    (tmp_path / "[red] neither").mkdir()
    neither = {"study": str(tmp_path / "[red] neither")}
    named = {"study": str(study.folder), "split": "test"}
    digits = {"study": 2026}
    for options, said in (
        (neither, "[red] neither holds neither"),
        (named, "has no splits"),
        (digits, "write -T study=./2026"),
    ):
        with pytest.raises(UsageError) as caught:
            task(**options)
        exception_hook()(caught.type, caught.value, caught.tb)
        assert said in str(caught.value)
        assert Text.from_markup(caught.value.message).plain == str(caught.value)
    assert not tracebacks


def test_a_judge_that_does_not_exist_is_refused_in_one_line(study):
    with pytest.raises(UsageError) as caught:
        tasks.name(study=str(study.folder), judge="nobody:nothing")
    assert isinstance(caught.value, PrerequisiteError)

"""The red-team stage of a study: resumed anywhere, it writes the same bytes."""

import pytest

from oodscen import StudyConfig, make_llm
from oodscen._pipeline.context import Context
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.steps.trees import grow, redteam
from oodscen.testing import ScriptedLLM

CONFIG = StudyConfig.quick(simulator="flat", encoder="hash", llm="model", in_flight=3, iterations=9)
FILES = ("redteam.jsonl", "tree.diverse.json")


class Stopped(KeyboardInterrupt):
    """Somebody pulled the plug."""


def model(after=None):
    author, asked = make_llm("builtin", seed=CONFIG.seed), []

    def answer(request):
        asked.append(request)
        if after is not None and len(asked) > after:
            raise Stopped
        return author.complete(request)

    return ScriptedLLM(answer, name="model")


def play(out, given=None, **changes):
    context = Context(
        out, CONFIG.model_copy(update=changes), RunOptions(models={"model": given or model()})
    )
    context.prepare()
    redteam(context, grow(context))
    return {name: (out / name).read_bytes() for name in FILES}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return play(tmp_path_factory.mktemp("whole"))


@pytest.mark.parametrize("after", [4, 8, 13])
def test_a_stopped_stage_continues_with_the_same_bytes(tmp_path, whole, after):
    with pytest.raises(Stopped):
        play(tmp_path, model(after))
    assert not (tmp_path / "tree.diverse.json").exists()
    assert play(tmp_path) == whole
    assert play(tmp_path, model(0)) == whole


def test_a_recording_gives_the_same_bytes(tmp_path, whole):
    for name in ("recorded", "replayed"):
        (tmp_path / name).mkdir()
    play(tmp_path / "recorded")
    recording = tmp_path / "recorded" / "answers.jsonl"
    assert play(tmp_path / "replayed", llm=f"replay:{recording}") == whole


def test_the_rules_of_the_configuration_hold(tmp_path, whole):
    found = play(tmp_path, red_budget=7)["redteam.jsonl"].splitlines()
    assert found == whole["redteam.jsonl"].splitlines()[: len(found)]
    assert len(found) == 3

import itertools
import json
import re
import shlex
import shutil
import sys

import pytest
from click.testing import CliRunner

from oodscen import Study
from oodscen._cli import main
from oodscen._pipeline import run_study
from oodscen.data._verdict import Verdict
from oodscen.errors import LLMError
from oodscen.llm._recording import Exchange
from oodscen.protocols import Completion
from oodscen.report._quiz import write_quiz
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import SMALL, as_made
from tests.report.test_quiz import payload


def invoke(*order):
    return CliRunner().invoke(main, [str(word) for word in order])


@pytest.fixture
def study(small, tmp_path):
    return shutil.copytree(small, tmp_path / "study")


def test_a_model_that_nobody_knows_leaves_the_study_as_it_was(study) -> None:
    before = (study / "study.json").read_bytes()
    for order in (("--vlm", "no-such-model"), ("--vlm", "random", "--judge", "no-such-model")):
        assert invoke("evaluate", study, *order).exit_code == 2
        assert (study / "study.json").read_bytes() == before


def test_a_model_without_usable_answers_exits_with_1_and_later_ones_do_not(study, tmp_path) -> None:
    other = Exchange(purpose="another-question", messages=(), answer="nothing")
    (tmp_path / "mute.jsonl").write_text(other.to_json() + "\n")
    order = ("evaluate", study, "--vlm")
    assert invoke(*order, f"replay:{tmp_path / 'mute.jsonl'}").exit_code == 1
    later = invoke(*order, "random", "--json")
    assert later.exit_code == 0
    assert {row["model"] for row in json.loads(later.stdout)["standings"]} >= {"random", "oracle"}


def test_a_judge_without_usable_answers_exits_with_1(study, tmp_path) -> None:
    other = Exchange(purpose="another-question", messages=(), answer="nothing")
    (tmp_path / "mute.jsonl").write_text(other.to_json() + "\n")
    found = invoke("evaluate", study, "--judge", f"replay:{tmp_path / 'mute.jsonl'}")
    assert found.exit_code == 1
    assert "the judge: no usable answer about" in found.output
    assert Study.open(study).info["status"] == "incomplete"
    assert invoke("evaluate", study, "--vlm", "random").exit_code == 1


def answered(study, tmp_path, name, action="stop"):
    """Return a file with a person's answers to all drives of a study."""
    items = payload(write_quiz(Study.open(study), tmp_path / "quiz.html").read_text())["items"]
    said = {"is_ood": True, "confidence": 0.7, "aspect": "a box", "action": action}
    answers = [{**said, "item": item["item"], "choice": item["options"][0][0]} for item in items]
    file = tmp_path / f"{len(list(tmp_path.iterdir()))}.json"
    file.write_text(json.dumps({"id": name, "answers": answers}))
    return file


def people(study):
    rows = {verdict.model for verdict in Study.open(study).verdicts}
    return {row for row in rows if row.startswith("human:")}


def test_all_files_of_answers_count_and_two_of_one_name_are_refused(study, tmp_path) -> None:
    ada, bob = (answered(study, tmp_path, name) for name in ("Ada", "Bob"))
    other = answered(study, tmp_path, "Ada", "keep_speed")
    before = (study / "study.json").read_bytes()
    twice = invoke("evaluate", study, "--answers", ada, "--answers", bob, "--answers", other)
    assert twice.exit_code == 2
    assert "'Ada', as does another file" in twice.output
    assert ((study / "study.json").read_bytes(), (study / "people.jsonl").exists()) == (
        before,
        False,
    )
    assert invoke("evaluate", study, "--answers", ada, "--answers", bob).exit_code == 0
    assert people(study) == {"human:Ada", "human:Bob"}


def test_what_a_dropped_or_missing_person_needs_is_said_and_works(study, tmp_path) -> None:
    file = answered(study, tmp_path, "Zo\u00e9")
    assert invoke("evaluate", study, "--answers", file).exit_code == 0
    (study / "people.jsonl").unlink()
    missing = invoke("evaluate", study, "--vlm", "constant:stop")
    assert missing.exit_code == 2
    assert f"oodscen evaluate {study} --answers FILE" in missing.output
    order = re.search(r"oodscen (evaluate \S+ --drop [^)]+)\)", missing.output)
    assert invoke("evaluate", study, "--answers", file).exit_code == 0
    assert people(study) == {"human:Zo\u00e9"}
    (study / "people.jsonl").unlink()
    assert invoke(*shlex.split(order[1])).exit_code == 0
    assert people(study) == set()
    assert invoke("evaluate", study, "--answers", file).exit_code == 0
    gone = invoke("evaluate", study, "--drop", "human:Zoe\u0301")
    assert gone.exit_code == 0
    assert "stay in people.jsonl" in gone.stderr
    assert "--answers FILE" in gone.stderr
    assert people(study) == set()


@pytest.mark.parametrize("limit", ["--max-requests", "--max-cost", "--timeout", "--concurrency"])
def test_limits_are_refused_where_no_model_is_asked(study, limit) -> None:
    before = (study / "study.json").read_bytes()
    for alone in ("--require", "safe>=0.5"), ("--drop", "random"):
        refused = invoke("evaluate", study, *alone, limit, 5)
        assert refused.exit_code == 2
        assert f"{limit} has no effect" in refused.output
    assert (study / "study.json").read_bytes() == before


def test_a_price_of_a_model_that_is_not_asked_is_refused(study, tmp_path, monkeypatch) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "priced_class.py").write_text(OWN.format("stop"))
    monkeypatch.syspath_prepend(tmp_path / "here")
    before = (study / "study.json").read_bytes()
    order = ("evaluate", study, "--vlm", "priced_class:Own", "--price")
    for spare in ("zzz=1,1", "priced_class:Other=1,1", "builtin=1,1"):
        refused = invoke(*order, spare, "--drop", "random")
        assert refused.exit_code == 2
        assert f"--price has no effect for {spare.partition('=')[0]}" in refused.output
        assert "priced_class:Own" in refused.output
        assert (study / "study.json").read_bytes() == before
    for name in ("own", "priced_class:Own"):
        assert invoke(*order, f"{name}=1,1", "--max-cost", "9").exit_code == 0


def judged(study, name):
    def answer(request):
        raise LLMError("boom")

    model = ScriptedLLM(answer)
    model.name = name
    config = SMALL.model_copy(update={"vlms": (name,), "servers": {name: "http://127.0.0.1:1/v1"}})
    run_study(study, config, models={name: model})


def test_a_model_is_dropped_without_asking_anybody_and_others_can_be_judged_at_once(study) -> None:
    judged(study, "bad")
    found = invoke("evaluate", study, "--drop", "bad")
    assert found.exit_code == 0
    assert "bad is taken out with 2 verdicts" in found.output
    assert Study.open(study).config.vlms == ()
    judged(study, "bad")
    found = invoke("evaluate", study, "--drop", "bad", "--vlm", "random")
    assert found.exit_code == 0
    assert Study.open(study).config.vlms == ("random",)
    assert invoke("evaluate", study, "--drop", "bad").exit_code == 2
    assert invoke("evaluate", study).exit_code == 2


def test_a_reference_that_is_named_as_a_model_stays_a_reference(study) -> None:
    def judged():
        return {
            (one.scene_id, one.protocol)
            for one in Study.open(study).verdicts
            if one.model == "random"
        }

    before = judged()
    assert invoke("evaluate", study, "--vlm", "random", "--protocol", "paper").exit_code == 0
    assert judged() > before
    dropped = invoke("evaluate", study, "--drop", "random")
    assert judged() > before
    assert "random is taken out with 0 verdicts; its row stays" in dropped.stderr


def test_a_command_that_is_refused_takes_no_model_out(study, tmp_path) -> None:
    judged(study, "bad")
    before = (study / "verdicts.jsonl").read_bytes()
    (tmp_path / "answers.json").write_text("not JSON")
    refused = invoke("evaluate", study, "--drop", "bad", "--answers", tmp_path / "answers.json")
    assert (refused.exit_code, "malformed answers" in refused.output) == (2, True)
    assert (study / "verdicts.jsonl").read_bytes() == before


def test_a_setting_that_all_models_share_is_kept_unless_no_model_has_answered(
    study, tmp_path, monkeypatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "shared_class.py").write_text(OWN.format("stop"))
    judge = ("evaluate", study, "--vlm", "shared_class:Own")
    names = (
        "simulator",
        "encoder",
        "baseline",
        "iterations",
        "max_paths",
        "seed",
        "width",
        "height",
    )
    values = {f"--{name.replace('_', '-')}": getattr(SMALL, name) for name in names}
    run = ("run", study, "--quick", "--no-demands", *itertools.chain.from_iterable(values.items()))
    assert invoke("evaluate", study, "--vlm", "random", "--chain").exit_code == 0
    assert invoke(*run, "--no-chain").exit_code == 0
    assert not Study.open(study).config.chain
    assert invoke(*judge, "--chain").exit_code == 0
    before = {name: (study / name).read_bytes() for name in ("study.json", "verdicts.jsonl")}
    for order in (judge, run, ("evaluate", study, "--drop", "random")):
        for options in (("--no-chain",), ("--rear-view",), ("--dry-run", "--no-chain")):
            if "--drop" in order and "--dry-run" in options:
                continue
            refused = invoke(*order, *options)
            assert refused.exit_code == 2
            assert f"leave out {options[-1]}" in refused.output
            assert before == {name: (study / name).read_bytes() for name in before}
    assert invoke(*run).exit_code == 0
    assert Study.open(study).config.chain
    again = invoke(*judge, "--drop", "own", "--no-chain", "--ordinary", "2")
    assert again.exit_code == 0
    config = Study.open(study).config
    assert (config.chain, config.ordinary) == (False, 2)
    refused = invoke(*judge, "--ordinary", "1")
    assert (refused.exit_code, "judged with --ordinary 2" in refused.output) == (2, True)


def test_a_recording_of_several_models_is_refused_before_it_enters_the_study(
    study, tmp_path, monkeypatch
) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "recorded_class.py").write_text(OWN.format("stop"))
    monkeypatch.syspath_prepend(tmp_path / "here")
    source = shutil.copytree(study, tmp_path / "source")
    assert invoke("evaluate", source, "--vlm", "recorded_class:Own").exit_code == 0
    recording = tmp_path / "two.jsonl"
    lines = [json.loads(line) for line in (source / "answers.jsonl").read_text().splitlines()]
    both = [{**line, "model": name} for name in ("one", "two") for line in lines]
    recording.write_text("".join(json.dumps(line) + "\n" for line in both))
    before = {path.name: path.read_bytes() for path in study.iterdir() if path.is_file()}
    for order in (("--vlm",), ("--dry-run", "--vlm"), ("--judge",)):
        refused = invoke("evaluate", study, *order, f"replay:{recording}")
        assert (refused.exit_code, f"replay:{recording}#one" in refused.output) == (2, True)
        assert before == {
            path.name: path.read_bytes() for path in study.iterdir() if path.is_file()
        }
    assert invoke("evaluate", study, "--vlm", f"replay:{recording}#one").exit_code == 0
    assert invoke("evaluate", study, "--vlm", "random").exit_code == 0


OWN = """
import json
from oodscen.protocols import Completion


class Own:
    name = "own"

    def complete(self, request):
        answer = {{"is_ood": True, "confidence": 0.6, "aspect": "a box", "choice": 1, "action": "{}"}}
        answer["description"] = "A road."
        fields = request.schema["properties"]
        return Completion(text=json.dumps({{key: answer[key] for key in answer if key in fields}}))
"""


def test_a_known_model_without_usable_answers_to_new_questions_exits_with_1(
    study, tmp_path, monkeypatch
) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "failing_class.py").write_text(OWN.format("stop"))
    monkeypatch.syspath_prepend(tmp_path / "here")
    assert invoke("evaluate", study, "--vlm", "failing_class:Own").exit_code == 0
    monkeypatch.setattr(
        sys.modules["failing_class"].Own, "complete", lambda *_: Completion(text="?")
    )
    found = invoke("evaluate", study, "--protocol", "paper")
    assert (found.exit_code, "own: 1 items got an answer" in found.stderr) == (1, True)
    assert invoke("evaluate", study, "--vlm", "random").exit_code == 0


def test_a_class_is_judged_anew_when_asked_to_and_missed_where_it_is_not(
    study, tmp_path, monkeypatch
) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "own_class.py").write_text(OWN.format("stop"))
    monkeypatch.syspath_prepend(tmp_path / "here")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    order = ("evaluate", study, "--vlm", "own_class:Own")

    def actions(*more):
        sys.modules.pop("own_class", None)
        found = invoke(*order, *more)
        rows = [verdict for verdict in Study.open(study).verdicts if verdict.model == "own"]
        return found, {row.action for row in rows}, len(rows)

    first, chosen, count = actions()
    assert (chosen, "are kept" in first.output) == ({"stop"}, False)
    (tmp_path / "here" / "own_class.py").write_text(OWN.format("slow_down"))
    again, chosen, _ = actions()
    assert chosen == {"stop"}
    said = re.search(
        r"own_class:Own: (\d+) verdicts are kept .* asked 20.* UTC, .*add (.*)", again.stderr
    )
    assert int(said[1]) == count
    _, chosen, _ = actions(*said[2].split())
    assert chosen == {"slow_down"}

    monkeypatch.syspath_prepend("")
    sys.path.remove(str(tmp_path / "here"))
    sys.modules.pop("own_class")
    elsewhere = invoke("evaluate", study, "--vlm", "random")
    assert elsewhere.exit_code == 2
    assert "there is no module 'own_class';" in elsewhere.output
    assert "--drop own_class:Own" in elsewhere.output
    assert invoke("evaluate", study, "--drop", "own_class:Own", "--vlm", "random").exit_code == 0


def test_a_requirement_is_graded_by_the_exit_code(study) -> None:
    assert invoke("evaluate", study, "--require", "sane>=1").exit_code == 2
    for command in ("evaluate", "report"):
        assert invoke(command, study, "--require", "").exit_code == 2
    none = invoke("evaluate", study, "--require", "safe>=0")
    assert none.exit_code == 5
    file = study / "verdicts.jsonl"
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    mine = [
        Verdict.parse({**row, "model": "mine", "kind": "model", "id": f"{row['scene_id']}@mine"})
        for row in rows
        if row["model"] == "oracle"
    ]
    mine = [one.model_dump(mode="json") for one in as_made(Study.open(study), mine)]
    file.write_text("".join(json.dumps(row) + "\n" for row in [*rows, *mine]))
    for text, code, word in (("safe>=0", 0, "meets"), ("safe>=0.9", 5, "more scenes")):
        for command in ("evaluate", "report"):
            found = invoke(command, study, "--require", text)
            assert (found.exit_code, word in found.output) == (code, True), found.output
    found = invoke("evaluate", study, "--require", "safe>=0.9", "--json")
    assert json.loads(found.stdout)["requirements"][0]["grade"] == "cannot tell yet"
    assert "Against the requirement safe&gt;=0.9" in (study / "report.html").read_text()

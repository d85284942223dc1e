import json
import re
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
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import SMALL, as_made


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


OWN = """
import json
from oodscen.protocols import Completion


class Own:
    name = "own"

    def complete(self, request):
        answer = {{"is_ood": True, "confidence": 0.6, "aspect": "a box", "choice": 1, "action": "{}"}}
        fields = request.schema["properties"]
        return Completion(text=json.dumps({{key: answer[key] for key in answer if key in fields}}))
"""


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
        rows = [one for one in Study.open(study).verdicts if one.model == "own"]
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

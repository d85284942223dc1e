"""Verdicts that do not belong to the drives of their study."""

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Study
from oodscen._cli import main
from oodscen._pipeline import run_study
from oodscen._pipeline.dropping import drop_models
from oodscen.errors import UsageError
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.judging._people import token
from oodscen.report._load import read
from oodscen.study._stale_verdicts import Tables, stale_in_words
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import SMALL, asked_about

REMEDY = "; the same `oodscen run OUT` makes {} again"
CONFIG = SMALL.model_copy(
    update={
        "vlms": ("mine", "other"),
        "protocols": ("ours", "paper"),
        "withheld": ("mine",),
        "people": ("Ada",),
        "judge": "judge",
    }
)
"""Everything that makes verdicts: models, people, references, both protocols, withheld pictures, a judge."""


def models():
    found = {}
    for name, action in (("mine", "stop"), ("other", "slow_down")):
        model = ConstantAnswerer(action)
        model.name, model.kind = name, "model"
        found[name] = model
    found["judge"] = ScriptedLLM(
        lambda request: '{"reasoning": "", "is_same_thing": true, "is_same_fault": false}'
    )
    found["judge"].name = "judge"
    return found


@pytest.fixture(scope="module")
def judged(small, tmp_path_factory) -> Path:
    """Return a study that was judged by everything, which no test may change."""
    folder = tmp_path_factory.mktemp("judged") / "study"
    shutil.copytree(small, folder)
    study = Study.open(folder)
    answers = [
        {"item": token(one), "is_ood": True, "aspect": "a car", "choice": "?", "action": "stop"}
        for one in asked_about(study)
    ]
    study.store.write_lines("people.jsonl", [{"id": "Ada", "answers": answers}])
    run_study(folder, CONFIG, models=models())
    return folder


@pytest.fixture
def out(judged, tmp_path) -> Path:
    return shutil.copytree(judged, tmp_path / "out")


def stale(folder: Path) -> set[str]:
    study = Study.open(folder)
    return {one.id for one in Tables.of(study).stale(study.stored_verdicts)}


def change(folder: Path, model: str, **values: object) -> set[str]:
    """Change the verdicts on a model by hand; return their ids."""
    store = Study.open(folder).store
    lines = list(store.lines("verdicts.jsonl"))
    own = [line for line in lines if line["model"] == model]
    for line in own:
        line.update(values)
    store.write_lines("verdicts.jsonl", lines)
    return {line["id"] for line in own}


def test_all_that_a_run_makes_belongs_to_its_study(judged):
    study = Study.open(judged)
    found = study.verdicts
    kinds = {(one.kind, one.protocol, one.model.partition(":")[0]) for one in found}
    assert ("model", "ours", "human") in kinds
    assert ("model", "ours", "mine without pictures") in kinds
    assert {("model", "paper", "mine"), ("reference", "paper", "oracle")} <= kinds
    assert any(one.judge for one in found)
    assert found == study.stored_verdicts
    assert study.leaderboard().standings
    assert "verdicts.jsonl" not in read(study).gaps


EDITS = [
    *({"made_from": value} for value in ("0" * 64, "")),
    *({"action": value} for value in ("drive_into_wall", None, "")),
    *({"is_ood": value} for value in (None,)),
    {"choice": "no-such-kind"},
    *({name: "other"} for name in ("success", "action_is_safe", "choice_is_right")),
    *({name: "other"} for name in ("thing_is_right", "aspect_is_right", "is_ordinary")),
    {"action_is_marginal": "other"},
    {"status": "failed"},
    {"outcome": "refused"},
    {"outcome": "unavailable"},
    {"kind": "other"},
    {"protocol": "other"},
    {"model": "someone"},
    {"judge": "nobody@000"},
]
"""Edits of a line; `other` is the other value that its field can have."""
OTHER = {"model": "reference", "reference": "model", "ours": "paper", "paper": "ours"}


@settings(max_examples=60)
@given(data=st.data())
def test_every_edit_of_a_verdict_is_seen_and_no_other_verdict_is(judged, data):
    study = Study.open(judged)
    tables, verdicts = Tables.of(study), study.stored_verdicts
    place = data.draw(st.integers(0, len(verdicts) - 1))
    one, edit = verdicts[place], data.draw(st.sampled_from(EDITS))
    (name, value), *_ = edit.items()
    now = getattr(one, name)
    if value == "other":
        value = OTHER[now] if isinstance(now, str) else not now
    if (name == "judge" and not one.judge) or (value is None and now is None) or value == now:
        return
    edited = one.model_copy(update={name: value})
    changed = [*verdicts[:place], edited, *verdicts[place + 1 :]]
    assert tables.stale(changed) == [edited]


@pytest.mark.parametrize(
    "values",
    [
        {"made_from": "0" * 64},
        {"action": "drive_into_wall"},
        {"choice": "no-such-kind"},
        {"is_ood": None},
        {"success": True, "action_is_safe": True, "action_is_marginal": True},
        {"status": "failed"},
    ],
    ids=("foreign", "action", "choice", "no answer", "scores", "status"),
)
def test_readers_refuse_in_one_line_and_the_run_mends_it(out, tmp_path, values):
    assert change(out, "mine", **values) == stale(out)
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    for words in (
        ("publish", out, "-o", tmp_path / "data", "--to", "none"),
        ("evaluate", out, "--require", "safe>=0.1"),
        ("evaluate", out, "--drop", "other", "--require", "safe>=0.1"),
    ):
        found = CliRunner().invoke(main, [str(word) for word in words])
        assert (found.exit_code, found.output.count("\n")) == (2, 1), found.output
        assert REMEDY.format("it" if "1 verdict " in found.output else "them") in found.output
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before
    assert not (tmp_path / "data").exists()
    study = Study.open(out)
    for read_it in (
        lambda: study.verdicts,
        study.leaderboard,
        lambda: study.requirements("safe>=0.1"),
        lambda: drop_models(study, ["other"]),
    ):
        with pytest.raises(UsageError, match="belong to the drives of this study"):
            read_it()
    run_study(out, CONFIG, models=models())
    assert not stale(out)
    assert {verdict.action for verdict in study.verdicts if verdict.model == "mine"} == {"stop"}


def test_the_report_says_what_it_leaves_out_and_grades_nobody(out):
    ids = change(out, "mine", made_from="0" * 64)
    told = CliRunner().invoke(main, ["report", str(out), "--require", "safe>=0.1"])
    assert told.exit_code == 2
    assert f"{len(ids)} verdicts (mine) do not belong" in told.stderr
    page = (out / "report.html").read_text()
    assert f"{len(ids)} verdicts (mine) do not belong" in page
    assert "Against the requirement" not in page
    left = {verdict.id for verdict in read(Study.open(out)).verdicts}
    assert left == {stored_verdict.id for stored_verdict in Study.open(out).stored_verdicts} - ids


def test_the_verdicts_on_a_model_can_be_taken_out_instead(out):
    change(out, "mine", made_from="0" * 64)
    drop_models(Study.open(out), ["mine"])
    assert not stale(out)
    assert {verdict.model for verdict in Study.open(out).verdicts} >= {"other", "human:Ada"}


def test_a_changed_episode_makes_its_verdicts_stale_and_those_of_the_references(out):
    store = Study.open(out).store
    lines = list(store.lines("episodes.jsonl"))
    name = asked_about(Study.open(out))[0].id
    for line in lines:
        if line["id"] == name:
            line["actions"]["stop"]["safe"] = not line["actions"]["stop"]["safe"]
    store.write_lines("episodes.jsonl", lines)
    assert stale(out) == {
        stored_verdict.id
        for stored_verdict in Study.open(out).stored_verdicts
        if stored_verdict.kind == "reference"
        or (stored_verdict.scene_id == name and stored_verdict.protocol == "ours")
    }


def test_a_line_of_a_scene_that_was_taken_out_is_stale(out):
    store = Study.open(out).store
    line = next(store.lines("verdicts.jsonl"))
    foreign = json.loads(json.dumps(line).replace(line["scene_id"], "elsewhere-001"))
    with store.writing():
        store.append("verdicts.jsonl", foreign)
    assert stale(out) == {foreign["id"]}


@pytest.mark.parametrize("count", [1, 2, 9])
def test_some_names_and_the_remedy_are_told_on_one_line(judged, count):
    found = Study.open(judged).stored_verdicts
    names = list(dict.fromkeys(one.model for one in found))[:count]
    words = stale_in_words([next(one for one in found if one.model == name) for name in names])
    assert words.startswith(f"{count} verdict")
    assert words.endswith(REMEDY.format("it" if count == 1 else "them"))
    assert "\n" not in words
    assert sum(name in words for name in names) <= 6


@pytest.mark.parametrize("table", ["episodes.jsonl", "episodes.paper.jsonl"])
def test_an_action_that_a_simulator_did_not_try_can_still_be_chosen(out, table):
    store = Study.open(out).store
    lines = list(store.lines(table))
    for line in lines:
        for part in (line["actions"], line["sketch"]["paths"], line["sketch"]["ends"]):
            del part["slow_down"]
    store.write_lines(table, lines)
    study = run_study(out, CONFIG, models=models())
    assert all("slow_down" not in line["actions"] for line in store.lines(table))
    chosen = {verdict.action for verdict in study.verdicts if verdict.model == "constant:slow_down"}
    assert chosen == {"slow_down"}

"""The commands about trees: files and studies, text and JSON, exit codes."""

import json

import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen.data._scenario import Scenario
from oodscen.study._store import Store
from oodscen.tree._export import to_mermaid
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.interchange.staging import SCENES

BEFORE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather", stage="grow"),
    TreeEdit(op="add", node="fog", parent="weather", label="Thick fog", stage="grow"),
)
AFTER = BEFORE.apply(
    TreeEdit(op="broaden", node="fog", label="Fog or smoke", stage="redteam", round=1),
    TreeEdit(op="add", node="hail", parent="weather", label="Hail", stage="redteam", round=2),
)


def call(*arguments):
    return CliRunner().invoke(main, ["tree", *map(str, arguments)])


@pytest.fixture
def place(tmp_path):
    store = Store(tmp_path)
    store.write("tree.initial.json", BEFORE.to_json())
    store.write("tree.diverse.json", AFTER.to_json())
    store.write("tree.simulatable.json", AFTER.to_json())
    store.write("study.json", json.dumps({"config": {}}))
    store.write_lines("scenarios.jsonl", [Scenario(id="fog-001", text="Fog.", leaf="fog")])
    return tmp_path


def test_show_prints_a_tree_or_the_provenance_of_a_node(place):
    assert call("show", place).stdout.strip() == AFTER.outline()
    assert call("show", place, "--which", "initial", "--ids").stdout.strip() == BEFORE.outline(
        ids=True
    )
    assert ScenarioTree.parse(call("show", place, "--json").stdout) == AFTER
    assert "broadened from “Thick fog”" in call("show", place, "--node", "fog").stdout
    history = json.loads(call("show", place, "--node", "fog", "--json").stdout)
    assert history["later"][0]["edit"]["round"] == 1


def test_diff_tells_the_changes_in_three_forms(place):
    files = (place / "tree.initial.json", place / "tree.diverse.json")
    assert "1 added, 0 removed, 1 broadened" in call("diff", *files).stdout
    assert json.loads(call("diff", *files, "--json").stdout)["added"][0]["id"] == "hail"
    assert call("diff", *files, "--mermaid").stdout.startswith("flowchart")
    assert call("diff", *files, "--exit-code").exit_code == 1
    assert call("diff", files[0], files[0], "--exit-code", "--encoder", "hash").exit_code == 0


def test_merge_writes_a_tree(place):
    out = place / "merged.json"
    files = (place / "tree.initial.json", place / "tree.diverse.json")
    assert call("merge", *files, "--encoder", "hash", "-o", out).exit_code == 0
    assert [leaf.label for leaf in ScenarioTree.load(out).leaves] == ["Thick fog", "Hail"]


def test_coverage_lists_holes_and_can_fail_a_build(place):
    assert "1 without a text: Hail" in call("coverage", place).stdout
    assert json.loads(call("coverage", place, "--json").stdout)["rows"][0]["texts"] == 1
    assert call("coverage", place, "--exit-code").exit_code == 1


def test_a_tree_without_leaves_covers_nothing(place):
    (place / "tree.initial.json").write_text(ScenarioTree().to_json(), "utf-8")
    assert call("coverage", place, "--which", "initial", "--exit-code").exit_code == 1


def test_coverage_counts_the_tags_of_a_trees_scenes(place):
    here = SCENES[0].model_copy(update={"scenario_id": "fog-001"})
    elsewhere = SCENES[1].model_copy(update={"scenario_id": "other"})
    Store(place).write_lines("scenes.jsonl", [here, elsewhere])
    found = json.loads(call("coverage", place, "--odd", "--json").stdout)
    assert found["scenes"] == 1
    assert max(row["scenes"] for row in found["rows"]) == 1
    assert "none: " in call("coverage", place, "--odd").stdout
    assert call("coverage", place, "--odd", "--exit-code").exit_code == 1


@pytest.mark.parametrize("form", ["mermaid", "dot", "json", "nested", "html"])
def test_export_writes_every_format(place, form):
    shown = call("export", place, "--format", form).stdout
    assert "Hail" in shown
    assert shown.strip() == to_mermaid(AFTER) or form != "mermaid"


@pytest.mark.parametrize("number", range(5))
def test_replay_says_when_no_edit_is_of_the_round(place, number):
    found = call("replay", place, "--round", number)
    assert found.exit_code == 0
    assert ("the last is of round 2" in found.stderr) is (number > 2)


def test_replay_prints_the_log_or_writes_an_earlier_tree(place):
    assert len(call("replay", place).stdout.splitlines()) == len(AFTER.edits)
    rows = [
        json.loads(line)
        for line in call("replay", place, "--round", 1, "--json").stdout.split("\n")
        if line
    ]
    assert [row["nodes"] for row in rows] == [1, 2, 3, 4, 5, 5]
    out = place / "earlier.json"
    assert call("replay", place, "--stage", "grow", "-o", out).exit_code == 0
    assert ScenarioTree.load(out) == BEFORE
    assert call("replay", place, "--undo", 6, "--undo", 5, "-o", out).exit_code == 0
    assert ScenarioTree.load(out).nodes == BEFORE.nodes


@pytest.mark.parametrize(
    "arguments",
    [
        ("show", "--node", "fgo"),
        ("replay", "--edit", "99"),
        ("replay", "--edit", "1", "--round", "1"),
        ("replay", "--undo", "99"),
        ("replay", "--stage", "nobody"),
    ],
)
def test_what_cannot_be_is_one_line(place, arguments):
    result = call(arguments[0], place, *arguments[1:])
    assert result.exit_code == 2
    assert "Traceback" not in result.stderr
    (place / "tree.diverse.json").unlink()
    assert call("show", place).exit_code == 2


def test_words_of_a_model_steer_no_terminal(tmp_path):
    hostile = "\x1b]0;owned\x07\n  9: added by nobody\u202e"
    edit = TreeEdit(
        op="broaden",
        node="fog",
        label="Fog gap",
        stage=hostile,
        reason=hostile,
        model=hostile,
    )
    Store(tmp_path).write("tree.json", AFTER.apply(edit).to_json())
    Store(tmp_path).write("other.json", BEFORE.to_json())
    file, other = tmp_path / "tree.json", tmp_path / "other.json"
    for arguments in (
        ("show", file),
        ("show", file, "--json"),
        ("show", file, "--node", "fog"),
        ("show", file, "--node", "fog", "--json"),
        ("diff", file, other),
        ("replay", file),
        ("replay", file, "--json"),
    ):
        result = call(*arguments)
        assert result.exit_code == 0
        assert not {"\x1b", "\x07", "\u202e"} & set(result.output)
    assert call("show", file, "--node", "fog").output.count("\n") == 4
    assert json.loads(call("show", file, "--json").output)["edits"][-1]["reason"] == hostile


@pytest.mark.parametrize(
    ("nodes", "fault"),
    [
        ([("a", "root", "A"), ("a", "root", "B")], "the id 'a' is taken"),
        ([("top", None, "Second")], "would be a second root"),
        ([("a", "b", "A"), ("b", "a", "B")], "does not exist (before its child)"),
        ([("a", "root", "\u200b")], "the label is empty"),
        ([("a", "root", "x" * 10_000)], "the label has 10000 characters"),
        ([("a", "nowhere", "A")], "the parent 'nowhere' does not exist"),
    ],
)
def test_a_file_that_holds_no_tree_is_refused_by_every_command_that_reads_one(
    tmp_path, nodes, fault
):
    listed = [("root", None, "OOD"), *nodes]
    value = {"nodes": [{"id": i, "parent": p, "label": text} for i, p, text in listed]}
    bad, good = tmp_path / "bad.json", tmp_path / "good.json"
    bad.write_text(json.dumps(value))
    good.write_text(BEFORE.to_json())
    commands = [["tree", name, bad] for name in ("show", "export", "replay")]
    commands += [
        ["tree", name, *two] for name in ("diff", "merge") for two in ((good, bad), (bad, good))
    ]
    commands += [["redteam", bad], ["describe", bad], ["prune", bad, "--simulator", "flat"]]
    for command in commands:
        result = CliRunner().invoke(main, list(map(str, command)))
        assert (result.exit_code, fault in result.output) == (2, True), command
        assert len(result.output) < 500


def test_the_root_is_not_undone(place):
    out = place / "undone.json"
    for extra in ((), ("-o", out)):
        done = call("replay", place, "--undo", 0, *extra)
        assert (done.exit_code, done.stdout) == (2, "")
        assert "edit 0 added the root" in done.stderr
    assert not out.exists()
    assert call("replay", place, "--undo", 1, "-o", out).exit_code == 0
    assert call("replay", place, "--edit", 0).stdout == ""

import json

import pytest
from click.testing import CliRunner

from oodscen import ScenarioTree
from oodscen._cli import main
from oodscen.errors import LLMError
from oodscen.protocols import Completion
from oodscen.testing._scenes import example_scene
from oodscen.tree._scenario_tree import TreeEdit

BOX = "On a two-lane residential street, a large cardboard box lies in ego's lane ahead."


def invoke(*order):
    return CliRunner().invoke(main, [str(word) for word in order])


def test_a_text_that_cannot_be_staged_costs_its_own_scene_only(tmp_path) -> None:
    texts, out = tmp_path / "texts.jsonl", tmp_path / "scenes.jsonl"
    rows = [{"id": "sum", "text": "The sum is seven."}, {"id": "box", "text": BOX}]
    texts.write_text("\n".join(map(json.dumps, rows)))
    found = invoke("augment", texts, "--simulator", "flat", "--no-claims", "-o", out)
    assert found.exit_code == 1
    assert "sum: the built-in author does not recognise" in found.output
    assert "1 of 2 texts staged" in found.output
    assert [json.loads(line)["id"] for line in out.read_text().splitlines()] == ["box"]


class Tiring:
    """Writes the same text for every path, and then fails."""

    name = "tiring"

    def __init__(self):
        self.calls = 0

    def complete(self, request):
        self.calls += 1
        if self.calls > 2:
            raise LLMError("the server is gone")
        return Completion(text=json.dumps({"texts": [BOX]}))


def test_texts_are_written_although_those_that_repeat_cannot_be_reworded(tmp_path) -> None:
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="debris", parent="environmental", label="Debris"),
        TreeEdit(op="add", node="box", parent="debris", label="Box on the road"),
        TreeEdit(op="add", node="carton", parent="debris", label="Carton on the road"),
    )
    (tmp_path / "tree.json").write_text(tree.to_json())
    words = ("describe", tmp_path / "tree.json", "--llm", f"{__name__}:Tiring", "--per-path", 1)
    found = invoke(*words, "-o", tmp_path / "texts.jsonl")
    assert found.exit_code == 0
    assert "texts that repeat others stay: the server is gone" in found.output
    assert len((tmp_path / "texts.jsonl").read_text().splitlines()) == 2


@pytest.mark.parametrize("content", ["", "\n \n"])
def test_a_file_that_holds_nothing_is_refused(tmp_path, content) -> None:
    nothing = tmp_path / "nothing.jsonl"
    nothing.write_text(content)
    for order in (
        ("augment", nothing),
        ("simulate", nothing, tmp_path / "out"),
        ("check-claims", nothing, "--scenarios", nothing),
    ):
        found = invoke(*order)
        assert found.exit_code == 2
        assert "holds no scen" in found.output


def test_simulating_says_how_many_scenes_ran(tmp_path) -> None:
    scene = example_scene()
    other = scene.model_copy(update={"id": "elsewhere", "map": "nowhere"})
    (tmp_path / "scenes.jsonl").write_text(f"{scene.to_json()}\n{other.to_json()}\n")
    order = ("simulate", tmp_path / "scenes.jsonl", tmp_path / "out", "--simulator", "flat")
    found = invoke(*order, "--rear-view")
    assert found.exit_code == 1
    assert "1 of 2 scenes ran" in found.output
    taken = tmp_path / "out" / "frames" / scene.id
    assert {one.stem for one in taken.iterdir()} == {"first", "middle", "last", "rear"}
    lines = (tmp_path / "out" / "episodes.rear.jsonl").read_text().splitlines()
    assert [json.loads(line)["status"] for line in lines] == ["ok", "failed"]


def test_a_path_without_texts_inside_the_band_costs_its_own_texts_only(tmp_path) -> None:
    tree, plain = tmp_path / "tree.json", tmp_path / "plain.txt"
    plain.write_text("A car waits at a red light.\nTwo cars drive along a street.\n")
    assert invoke("grow", "--nodes", "14", "-o", tree).exit_code == 0
    order = (
        "describe",
        tree,
        "--encoder",
        "hash",
        "--per-path",
        "1",
        "--baseline",
        plain,
        "--band",
    )
    whole = invoke(*order, "-1", "0")
    assert whole.exit_code == 0
    count = len(whole.stdout.splitlines())
    found = next(
        run
        for low in range(95, 0, -5)
        if 0 < len((run := invoke(*order, str(-low / 100), "0")).stdout.splitlines()) < count
    )
    assert found.exit_code == 1
    assert f"of {count} paths failed" in found.stderr
    none = invoke(*order, "0.9", "0.99")
    assert none.exit_code == 2
    assert none.stdout == ""


class Refusing:
    """Writes texts, and refuses every other question."""

    name = "refusing"

    def complete(self, request):
        is_text = request.prompt.purpose == "describe-path"
        return Completion(
            text=json.dumps({"texts": [BOX]}) if is_text else "I cannot help with that."
        )


def test_what_a_model_did_not_do_is_told_and_is_no_success(tmp_path) -> None:
    tree = tmp_path / "tree.json"
    box = TreeEdit(op="add", node="box", parent="environmental", label="Box on the road")
    tree.write_text(ScenarioTree.initial().apply(box).to_json())
    model = ("--llm", f"{__name__}:Refusing")
    texts = invoke("describe", tree, *model, "--per-path", 1, "--twins")
    assert (texts.exit_code, json.loads(texts.stdout)["ordinary"]) == (1, None)
    assert "1 of them without a twin" in texts.stderr
    rounds = invoke("redteam", tree, *model, "--iterations", 2, "--encoder", "none")
    assert rounds.exit_code == 1
    assert "round 2: refusing gave no valid answer" in rounds.stderr
    for catalogues in (("flat",), ("flat", "pybullet")):
        options = [word for name in catalogues for word in ("--catalogue", name)]
        pruned = invoke("prune", tree, *model, *options)
        assert pruned.exit_code == 1
        assert pruned.stderr.count("box: refusing gave no valid answer") == len(catalogues)

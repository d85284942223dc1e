"""`oodscen check-claims`: scenes of any origin against their texts, exit codes."""

import json

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import make_encoder
from oodscen._cli import main
from oodscen.claims import _faithfulness
from oodscen.claims._faithfulness import Faithfulness
from oodscen.data._scenario import Scenario
from oodscen.testing._scenes import example_scene

TEXT = "A cardboard box stands in the ego's lane ahead on a two-lane residential street."


def call(folder, scene, text, *options, more=()):
    scenario = Scenario(id=scene.scenario_id, text=text, leaf="box", path=("OOD", "Box"))
    lines = [one.to_json() + "\n" for one in (scene, *more)]
    (folder / "scenes.jsonl").write_text("".join(lines))
    (folder / "texts.jsonl").write_text(scenario.to_json() + "\n")
    files = (str(folder / "scenes.jsonl"), "--scenarios", str(folder / "texts.jsonl"))
    simulator = ("--simulator", "oodscen.testing._flat:FlatSimulator")
    return CliRunner().invoke(main, ["check-claims", *files, *simulator, *options])


def test_a_faithful_scene_passes(tmp_path):
    done = call(tmp_path, example_scene(), TEXT)
    assert done.exit_code == 0, done.output
    assert "0 unfaithful scenes" in done.output


@pytest.mark.parametrize("option", [(), ("--json",)])
def test_a_contradiction_is_named(tmp_path, option):
    done = call(tmp_path, example_scene(), f"At night, {TEXT}", *option)
    assert done.exit_code == 1
    assert "night" in done.output
    if option:
        found = json.loads(done.stdout)
        assert found["unfaithful"] == 1
        statuses = {f["claim"]["value"]: f["status"] for f in found["scenes"][0]["findings"]}
        assert statuses["night"] == "fails"
        assert statuses["in_lane"] == "holds"


def test_scenes_compared_before_an_interruption_are_reported(tmp_path, monkeypatch):
    def interrupted(*arguments, compare=_faithfulness.compare_text, **options):
        if arguments[2].id == "later":
            raise KeyboardInterrupt
        return compare(*arguments, **options)

    monkeypatch.setattr(_faithfulness, "compare_text", interrupted)
    later = example_scene().model_copy(update={"id": "later"})
    done = call(tmp_path, example_scene(), f"At night, {TEXT}", more=[later])
    assert done.exit_code != 0
    assert "night" in done.output
    assert "1 scenes, " in done.output


def test_a_scene_that_cannot_be_staged_is_said_to_be(tmp_path):
    scene = example_scene().model_copy(update={"map": "moon"})
    done = call(tmp_path, scene, TEXT)
    assert done.exit_code == 1
    assert "unknown map" in done.output


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("{", "scenes.jsonl:2"),
        ('{"id": "x", "error": "no answer"}', "scenes.jsonl:2"),
        (example_scene().model_copy(update={"id": "b", "scenario_id": "?"}).to_json(), "no text"),
    ],
)
@pytest.mark.parametrize("option", [(), ("--json",)])
def test_what_is_wrong_with_one_line_leaves_the_others_judged(tmp_path, line, expected, option):
    scene = example_scene()
    call(tmp_path, scene, TEXT)
    last = scene.model_copy(update={"id": "last"})
    lines = [scene.to_json(), line, last.to_json(), ""]
    (tmp_path / "scenes.jsonl").write_text("\n".join(lines))
    files = (str(tmp_path / "scenes.jsonl"), "--scenarios", str(tmp_path / "texts.jsonl"))
    simulator = ("--simulator", "oodscen.testing._flat:FlatSimulator")
    done = CliRunner().invoke(main, ["check-claims", *files, *simulator, *option])
    assert done.exit_code == 1
    assert expected in done.output
    if option:
        found = json.loads(done.stdout)
        assert [row["id"] for row in found["scenes"] if "findings" in row] == [scene.id, "last"]
        assert found["unfaithful"] == 1


def test_a_malformed_text_is_told_and_costs_only_its_own_scenes(tmp_path):
    scene = example_scene()
    call(tmp_path, scene, TEXT)
    path = tmp_path / "texts.jsonl"
    path.write_text('{"id": 1}\n' + path.read_text())
    files = (str(tmp_path / "scenes.jsonl"), "--scenarios", str(path))
    simulator = ("--simulator", "oodscen.testing._flat:FlatSimulator")
    done = CliRunner().invoke(main, ["check-claims", *files, *simulator])
    assert done.exit_code == 1
    assert "texts.jsonl:1" in done.output
    assert "; 1 more could not be checked" in done.output


def test_two_texts_of_one_id_are_refused(tmp_path):
    scene = example_scene()
    call(tmp_path, scene, TEXT)
    path = tmp_path / "texts.jsonl"
    first = json.loads(path.read_text().splitlines()[0])
    path.write_text(path.read_text() + json.dumps({**first, "text": "A whale lies on the road."}))
    files = (str(tmp_path / "scenes.jsonl"), "--scenarios", str(path))
    done = CliRunner().invoke(main, ["check-claims", *files])
    assert done.exit_code == 2
    assert f"there is another text {first['id']!r}" in done.output


@pytest.mark.parametrize(
    ("option", "name"),
    [((), "minilm"), (("--encoder", "hash"), "hash"), (("--encoder", "none"), None)],
)
def test_the_encoder_of_a_run_compares_things_with_actors(tmp_path, monkeypatch, option, name):
    used = []

    def check(model, text, scene, catalogue, *, encoder):
        used.append(encoder)
        return Faithfulness(id=scene.id, findings=())

    monkeypatch.setattr("oodscen.claims._faithfulness.compare_text", check)
    assert call(tmp_path, example_scene(), TEXT, *option).exit_code == 0
    assert [one and one.name for one in used] == [name and make_encoder(name).name]


@given(st.lists(st.sampled_from("abc"), min_size=1, max_size=6))
@settings(max_examples=6)
def test_a_scene_that_is_given_again_counts_once(tmp_path_factory, ids):
    folder = tmp_path_factory.mktemp("twice")
    scene = example_scene()
    call(folder, scene, TEXT)
    lines = [scene.model_copy(update={"id": one}).to_json() for one in ids]
    (folder / "scenes.jsonl").write_text("\n".join(lines))
    files = (str(folder / "scenes.jsonl"), "--scenarios", str(folder / "texts.jsonl"))
    simulator = ("--simulator", "oodscen.testing._flat:FlatSimulator")
    done = CliRunner().invoke(main, ["check-claims", *files, *simulator, "--json"])
    found = json.loads(done.stdout)
    assert [row["id"] for row in found["scenes"]] == list(dict.fromkeys(ids))
    assert found["claims"] == sum(len(row["findings"]) for row in found["scenes"])


def test_two_different_scenes_of_one_id_are_refused(tmp_path):
    scene = example_scene()
    call(tmp_path, scene, TEXT)
    lines = [scene.to_json(), scene.model_copy(update={"horizon_s": 5.0}).to_json()]
    (tmp_path / "scenes.jsonl").write_text("\n".join(lines))
    files = (str(tmp_path / "scenes.jsonl"), "--scenarios", str(tmp_path / "texts.jsonl"))
    done = CliRunner().invoke(main, ["check-claims", *files])
    assert done.exit_code == 2
    assert f"scenes.jsonl, line 2: there is another scene {scene.id!r}" in done.stderr

import json
import shutil

import pytest
from click.testing import CliRunner

from oodscen import Study, make_simulator, simulate
from oodscen._cli import main
from oodscen._display import png
from oodscen.data import Prop, Scenario, Scene
from oodscen.data._designs.motion import Motion
from oodscen.data._details import Details
from oodscen.data._map_state import MapState
from oodscen.data._pairing import kind_of, scene_of
from oodscen.testing import example_scene
from tests.made import WALL
from tests.motions import TOPPLE


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Make a study of one scene with the frame at its decision, and of another that nobody simulated."""
    folder = tmp_path_factory.mktemp("show") / "study"
    folder.mkdir()
    scene = example_scene()
    with make_simulator("flat") as simulator:
        run = simulate(scene, simulator)
    (folder / "frames").mkdir()
    (folder / "frames" / "last.png").write_bytes(png(run.frames["last"].rgb))
    episode = run.episode.model_copy(update={"frames": {"last": "frames/last.png"}})
    other = scene.model_copy(update={"id": "exact-002", "scenario_id": "exact-002"})
    text = Scenario(id=scene.id, text="A box\x1b[2J lies ahead.", path=("Root", "Box"))
    rows = {"scenes": [scene, other], "episodes": [episode], "scenarios": [text]}
    for name, values in rows.items():
        lines = "".join(value.to_json() + "\n" for value in values)
        (folder / f"{name}.jsonl").write_text(lines, encoding="utf-8")
    (folder / "study.json").write_text('{"config": {"simulator": "flat"}}')
    return folder


def invoke(*order):
    return CliRunner().invoke(main, ["show", *map(str, order)])


def test_a_scene_is_plain_text_in_a_pipe(made):
    shown = invoke(made, "example-001")
    assert shown.exit_code == 0, shown.output
    assert "\x1b" not in shown.output
    for words in (
        "Root > Box",
        "A box\\u001b[2J lies",
        "* box: cardboard_box",
        "keep_speed        unsafe",
    ):
        assert words in shown.output
    assert invoke(made, "exam").output == shown.output
    assert json.loads(invoke(made, "exam", "--json").output)["scene"]["id"] == "example-001"
    assert "not simulated" in invoke(made, "exact").output


def test_what_was_made_to_order_is_marked(made, tmp_path):
    folder = shutil.copytree(made, tmp_path / "study")
    scene = Scene.parse(json.loads((folder / "scenes.jsonl").read_text().splitlines()[0]))
    whole = scene.model_copy(
        update={
            "made": (Prop.parse(WALL),),
            "motions": (Motion.parse(TOPPLE),),
            "map_state": MapState(signals="off"),
            "actors": tuple(
                actor.model_copy(update={"details": Details(parts=("doors_open", "dirty"))})
                for actor in scene.actors
            ),
        }
    )
    (folder / "scenes.jsonl").write_text(whole.to_json() + "\n")
    shown = invoke(folder, "example-001").output
    assert "made      low_wall: a low wall of red bricks" in shown
    assert "made      topple: toppling over ahead" in shown
    assert "parts: dirty, doors_open" in shown
    assert "map       signals: off" in shown


def test_all_scenes_are_listed(made):
    assert [line.split()[0] for line in invoke(made).output.splitlines()] == [
        "example-001",
        "exact-002",
    ]
    assert [row["id"] for row in json.loads(invoke(made, "--json").output)] == [
        "example-001",
        "exact-002",
    ]


@pytest.mark.parametrize(
    ("graphics", "start"),
    [
        ("kitty", "\x1b_Ga=T"),
        ("iterm", "\x1b]1337;File="),
        ("sixel", "\x1bPq"),
        ("blocks", "\x1b[38;2"),
        ("auto", "example-001\n"),
    ],
)
def test_a_picture_comes_first_where_it_is_asked_for(graphics, start, made):
    shown = invoke(made, "example-001", "--graphics", graphics)
    assert shown.exit_code == 0
    assert shown.output.startswith(start)
    assert shown.output.endswith("last.png\n")


@pytest.mark.parametrize(
    ("order", "words"),
    [
        (("exammple",), "did you mean example-001"),
        (("ex",), "2 scenes start with 'ex': example-001, exact-002\n"),
        (("",), "unknown scene ''"),
        (("example-001~demand",), "unknown ordinary drive 'example-001~demand'\n"),
        (("example-001", "--moment", "lst"), "did you mean last"),
    ],
)
def test_what_is_not_there_is_named(order, words, made):
    shown = invoke(made, *order)
    assert shown.exit_code == 2
    assert words in shown.stderr


def test_a_frame_outside_the_study_is_refused(made, tmp_path):
    folder = shutil.copytree(made, tmp_path / "study")
    (tmp_path / "secret.png").write_bytes(b"x")
    file = folder / "episodes.jsonl"
    file.write_text(file.read_text().replace("frames/last.png", "../secret.png"))
    assert "secret" not in invoke(folder, "example-001", "--graphics", "iterm").stdout


@pytest.mark.parametrize("content", [b"", b"no picture"])
def test_a_frame_that_cannot_be_read_leaves_the_words(content, made, tmp_path):
    folder = shutil.copytree(made, tmp_path / "study")
    (folder / "frames" / "last.png").write_bytes(content)
    shown = invoke(folder, "example-001", "--graphics", "blocks")
    assert shown.exit_code == 0, shown.output
    assert shown.stdout == invoke(made, "example-001").stdout.replace(str(made), str(folder))
    assert "last.png cannot be read" in shown.stderr


def test_an_ambiguous_name_lists_five_scenes(made, tmp_path):
    folder = shutil.copytree(made, tmp_path / "study")
    scenes = [example_scene().model_copy(update={"id": f"s{number}"}) for number in range(6)]
    lines = "".join(scene.to_json() + "\n" for scene in scenes)
    (folder / "scenes.jsonl").write_text(lines)
    assert "start with 's': s0, s1, s2, s3, s4 ...\n" in invoke(folder, "s").stderr


def test_an_ordinary_drive_is_shown_as_it_was_driven(quick):
    study = Study.open(quick)
    demands = {demand.id: demand for demand in study.demands}
    scenes = {scene.id: scene for scene in study.scenes}
    scenarios = {scenario.id: scenario for scenario in study.scenarios}
    ordinary = [one for one in study.episodes if one.is_ordinary]
    assert {kind_of(one.scene_id) for one in ordinary} == {"twin", "demand"}
    for episode in ordinary:
        parts = json.loads(invoke(quick, episode.scene_id, "--json").output)
        scene = scenes[scene_of(episode.scene_id)]
        scenario = scenarios[scene.scenario_id]
        driven = demands.get(episode.scene_id) or scene.twin(episode.decision_s)
        assert Scene.parse(parts["scene"]) == driven
        assert Scenario.parse(parts["scenario"]) == scenario
        assert parts["text"] == (driven.demand.text if driven.demand else scenario.ordinary)
        told = invoke(quick, episode.scene_id).output
        assert f"  text      {parts['text']}\n" in told
        assert all(f"{actor.id}: {actor.asset}, " in told for actor in driven.actors)

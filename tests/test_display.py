"""How values look: five short lines in a terminal, tables and pictures in a notebook, and never a credential."""

import dataclasses
import importlib
import inspect
import re
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from pydantic import BaseModel

import oodscen
from oodscen._display import LINES, WIDTH, Brief, brief, cut, html_table
from oodscen.author._builtin import BuiltinAuthor
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.data import Episode, Scenario
from oodscen.data._messages import Image, Message
from oodscen.data._verdict import Verdict
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.driving._motion.actions import Cruise, action_driver
from oodscen.driving._roads.building import load_corridor
from oodscen.encoders._cached import CachedEncoder
from oodscen.encoders._minilm import MiniLM
from oodscen.errors import DataError, Issue
from oodscen.judging import leaderboard
from oodscen.judging._constant_answerers import ConstantAnswerer, RandomAnswerer
from oodscen.llm import Limits
from oodscen.llm._call_log import LoggedLLM
from oodscen.llm._replay import RecordingLLM
from oodscen.metrics._metrics import Metrics
from oodscen.prompts._tree.give_examples import GiveExamples
from oodscen.protocols import Camera, Frame, Request
from oodscen.stages._options import RedTeamOptions
from oodscen.study._config import StudyConfig
from oodscen.study._store import Store
from oodscen.study._study import Study
from oodscen.testing import AnsweringServer, ScriptedLLM, example_scene
from oodscen.testing._encoder import HashEncoder
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

KEY = "sk-test-planted-0123456789abcdef"
SCRIPT = "<script>alert(1)</script>"
TEXTS = [f"{SCRIPT} A piano lies on lane {number}." for number in range(30)]

MAKERS = {
    "Augmenter": lambda: oodscen.Augmenter(ScriptedLLM([]), FLAT_CATALOGUE),
    "AnsweringServer": lambda: AnsweringServer(ScriptedLLM([])),
    "Baseline": ordinary_driving,
    "BuiltinAuthor": BuiltinAuthor,
    "CachedEncoder": lambda: CachedEncoder(HashEncoder()),
    "Camera": Camera,
    "Catalogue": lambda: FLAT_CATALOGUE,
    "ConstantAnswerer": ConstantAnswerer,
    "Corridor": lambda: load_corridor(FLAT_CATALOGUE.maps[0]),
    "Cruise": Cruise,
    "DataError": lambda: DataError("scene", [Issue("a" * 80, "is wrong " * 30)] * 20),
    "Describer": lambda: oodscen.Describer(ScriptedLLM([]), HashEncoder()),
    "ScriptedLLM": lambda: ScriptedLLM(str),
    "KinematicWorld": lambda: _stepped()._world,
    "LaneStrip": lambda: load_corridor(FLAT_CATALOGUE.maps[0]).strips[0],
    "LoggedLLM": lambda: LoggedLLM(ScriptedLLM([]), print),
    "Message": lambda: Message(
        role="user", text="x" * 9_000, images=(Image(name="a.png", sha256="0" * 64),)
    ),
    "Metrics": lambda: Metrics(HashEncoder(), TEXTS),
    "MiniLM": MiniLM,
    "Observation": lambda: _stepped().observe(),
    "Pruner": lambda: oodscen.Pruner(ScriptedLLM([]), FLAT_CATALOGUE),
    "RandomAnswerer": RandomAnswerer,
    "RecordingLLM": lambda: RecordingLLM(ScriptedLLM([]), "recording.jsonl"),
    "RedTeamer": lambda: oodscen.RedTeamer(ScriptedLLM([]), encoder=HashEncoder()),
    "RedTeamOptions": RedTeamOptions,
    "Request": lambda: _request(),
    "RuleBasedDriver": RuleBasedDriver,
    "Scenario": lambda: Scenario(id="a-001", text="x" * 2_000, leaf="a", path=("r", "b", "a")),
    "Scene": example_scene,
    "State": lambda: _stepped().state(),
    "Store": lambda: Store("out"),
    "Study": lambda: Study("out"),
    "StudyConfig": StudyConfig,
    "Limits": Limits,
    "TreeGrower": lambda: oodscen.TreeGrower(ScriptedLLM([])),
    "Verdict": lambda: Verdict(id="a@b", scene_id="a", model="b", status="ok", outcome="answered"),
    "WorldSnapshot": lambda: _stepped().snapshot(),
    "action": lambda: action_driver("change_lane_left"),
}


def _stepped():
    simulator = FlatSimulator()
    simulator.reset(example_scene(), 0)
    return simulator


def _request():
    question = GiveExamples(shown=("x" * 5_000,), count=3)
    return Request(question, question.messages(), question.answer_schema())


@pytest.fixture(scope="module")
def simulated():
    with FlatSimulator() as flat:
        return oodscen.simulate(example_scene(), flat, camera=Camera(width=80, height=60))


def is_short(text):
    lines = text.splitlines()
    return (
        0 < len(lines) <= LINES
        and all(len(line) <= WIDTH for line in lines)
        and not re.search(r"\bat 0x", text)
    )


@pytest.mark.parametrize("name", MAKERS)
def test_a_public_value_takes_five_lines_at_most(name):
    value = MAKERS[name]()
    assert is_short(repr(value)), repr(value)


def test_results_take_five_lines_at_most(simulated):
    for value in (simulated, simulated.episode, simulated.trace, *simulated.states[:2]):
        assert is_short(repr(value)), repr(value)
    assert is_short(repr(simulated.frames["last"]))
    assert is_short(repr(Metrics(HashEncoder(), TEXTS).report(TEXTS[:9], checks=False)))


def test_every_public_class_describes_itself():
    listed = oodscen.data, oodscen.prompts, oodscen.stages, oodscen.llm, oodscen.metrics
    modules = [
        name for name in sys.modules if re.fullmatch(r"oodscen\.[a-z]+", name) and name[8] != "_"
    ]
    assert {module.__name__ for module in listed} <= set(modules)
    for name in modules:
        module = importlib.import_module(name)
        for public in getattr(module, "__all__", ()):
            kind = getattr(module, public)
            if not inspect.isclass(kind) or getattr(kind, "_is_protocol", False):
                continue
            assert kind.__repr__ is not object.__repr__, kind
            if issubclass(kind, BaseModel):
                assert issubclass(kind, Brief), kind


nested = st.recursive(
    st.none() | st.integers() | st.floats() | st.text() | st.binary() | st.just(f"x {KEY} y"),
    lambda inner: (
        st.lists(inner) | st.dictionaries(st.text(max_size=5), inner) | st.tuples(inner, inner)
    ),
    max_leaves=30,
)


@given(st.dictionaries(st.sampled_from(["a", "b", "headers", "_options"]), nested))
def test_any_fields_take_five_lines_without_a_key(fields):
    text = brief(Brief(), fields.items())
    assert is_short(text)
    assert "planted" not in text


@given(st.text())
def test_any_text_is_cut_to_five_lines(text):
    lines = cut(text).splitlines()
    assert len(lines) <= LINES
    assert all(len(line) <= WIDTH for line in lines)


def test_credentials_by_name_are_hidden():
    fields = {"headers": {"Authorization": "Basic swordfish"}, "options": [{"api_key": "abc"}]}
    fields["settings"] = {"tokens": ["clownfish"]}
    text = brief(Brief(), fields.items())
    assert "swordfish" not in text
    assert "clownfish" not in text
    assert "abc" not in text


# ------------------------------------------------------------------ notebooks


def html(text):
    """Parse HTML that must hold no script and nothing from elsewhere."""
    root = etree.fromstring(f"<div>{text}</div>", etree.HTMLParser())
    assert not root.xpath("//script")
    assert all(source.startswith("data:") for source in root.xpath("//@src"))
    return root


@given(st.lists(st.lists(st.text(alphabet=st.characters(codec="utf-8")), min_size=1)))
def test_tables_escape_all_text(rows):
    text = html_table([*rows, [SCRIPT]], head=[SCRIPT], caption=SCRIPT)
    assert len(html(text).xpath("//tbody/tr")) == len(rows) + 1


def test_a_run_shows_pictures_and_the_outcome_of_every_action(simulated):
    root = html(simulated._repr_html_())
    assert len(root.xpath("//img")) == 2
    assert root.xpath("//tr/td[1]/text()") == list(simulated.episode.actions)
    assert {"safe", "unsafe", "unavailable"} == set(root.xpath("//tr/td[2]/text()"))


def test_an_episode_escapes_names_and_errors(simulated):
    actions = {SCRIPT: simulated.episode.actions["keep_speed"]}
    odd = simulated.episode.model_copy(update={"scene_id": SCRIPT, "actions": actions})
    assert SCRIPT in html(odd._repr_html_()).xpath("//caption//text()")[0]
    failed = Episode(id="a", scene_id="a", status="failed", error=SCRIPT)
    assert SCRIPT in "".join(html(failed._repr_html_()).itertext())


def test_pictures_are_png(simulated):
    with FlatSimulator() as flat:
        above = example_scene().birds_eye(flat.reset(example_scene(), 0), flat.catalogue())
    for picture in (above, simulated.frames["last"]):
        assert picture._repr_png_().startswith(b"\x89PNG")
    assert is_short(repr(above))
    assert above[..., 0]._repr_png_().startswith(b"\x89PNG")
    assert above[0, 0]._repr_png_() is None
    frame = Frame(np.zeros((0, 0, 3), np.uint8), np.zeros((0, 0)), np.zeros((0, 0)))
    assert frame._repr_png_() is None


def test_a_metrics_report_shows_its_intervals():
    found = Metrics(HashEncoder(), TEXTS).report(TEXTS[:9], [SCRIPT] * 9, checks=False)
    named = found.model_copy(update={"baseline": SCRIPT})
    cells = html(named._repr_html_()).xpath("//tr[starts-with(td[1], 'OOD-ness')]/td/text()")
    assert cells[1] == f"{found.oodness.mean:.3f}"


def test_a_leaderboard_has_a_row_per_answerer(simulated):
    verdict = Verdict(
        id="a@b", scene_id=simulated.episode.id, model=SCRIPT, status="ok", outcome="answered"
    )
    board = leaderboard([verdict], [simulated.episode], [])
    assert html(board._repr_html_()).xpath("//tbody/tr/td[1]/text()") == [SCRIPT]
    assert is_short(repr(board))


def test_a_study_shows_its_counts_and_links_to_its_report(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "java script:x&<y>"
    assert "no study yet" in Study(folder)._repr_html_()
    folder.mkdir()
    (folder / "study.json").write_text(f'{{"config": {{}}, "counts": {{"paths": "{SCRIPT}"}}}}')
    (folder / "report.html").write_text("")
    root = html(Study(folder)._repr_html_())
    assert root.xpath("//td[2]/text()")[-1] == SCRIPT
    assert root.xpath("//a/@href") == ["./java%20script%3Ax%26%3Cy%3E/report.html"]
    monkeypatch.chdir("/")
    (folder / "study.json").write_text("[")
    assert SCRIPT not in "".join(html(Study(folder)._repr_html_()).itertext())


SECRETS = (
    "password passwd token access_token secret client_secret key api_key bearer credentials".split()
)


@given(st.sampled_from(SECRETS), st.text(max_size=40))
def test_no_field_of_a_foreign_object_that_is_named_as_a_secret_is_shown(name, value):
    model = dataclasses.make_dataclass("Model", [(name, str), ("seed", int)])
    held = model(f"hidden{value}hidden", 3)
    for one in (held, [held], {"model": held}, {name: held}):
        assert "hidden" not in brief(ScriptedLLM([]), [("llm", one)])
    assert "seed=3" in brief(ScriptedLLM([]), [("llm", held)])


@pytest.mark.parametrize("fault", [ValueError("no"), None])
def test_an_object_that_cannot_represent_itself_is_shown_by_its_type(fault):
    class Mute:
        def __repr__(self):
            if fault is not None:
                raise fault
            return

    assert brief(ScriptedLLM([]), [("llm", Mute())]) == "ScriptedLLM(llm=<Mute>)"

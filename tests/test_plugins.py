"""Plugins that break every promise: by name and as objects, through the library and the commands."""

import asyncio
import shutil
import sys
import types
from importlib.metadata import EntryPoint

import numpy as np
import pytest
from click.testing import CliRunner

from oodscen import Metrics, StudyConfig, _entry_points
from oodscen._cli import main
from oodscen._members import working
from oodscen._pipeline import Outputs, run_study
from oodscen._pipeline.jobs import Job
from oodscen._pipeline.worker import run_chunk
from oodscen._registry import make_catalogue, make_driver, make_encoder, make_llm, make_simulator
from oodscen.encoders._check import encode
from oodscen.errors import (
    DataError,
    EncoderError,
    Issue,
    LLMError,
    MissingExtra,
    OodscenError,
    SceneError,
    SimulatorCrash,
    SimulatorError,
    SpawnError,
    UsageError,
)
from oodscen.llm._ask import ask
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Control
from oodscen.stages._drive import drive
from oodscen.stages._simulate import simulate
from oodscen.testing import check_simulator
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

MAKERS = {
    "llm": make_llm,
    "encoder": make_encoder,
    "simulator": make_simulator,
    "catalogue": make_catalogue,
    "driver": make_driver,
}
MEMBERS = {
    "llm": ("name", "complete"),
    "encoder": ("name", "dimension", "encode"),
    "simulator": ("name", "dt", "catalogue", "reset", "step", "render", "observe", "close"),
    "driver": ("act",),
}


class Bare:
    """Has all members of every kind; no method does anything."""

    name = "bare"
    dt = 0.05
    dimension = 4

    def complete(self, *given):
        return None

    encode = catalogue = reset = step = render = observe = close = act = complete
    __enter__ = __exit__ = complete


def lacking(member):
    """Return a class that has all but one member."""
    names = {name for members in MEMBERS.values() for name in members} - {member}
    return type("Lacking", (), {name: getattr(Bare, name) for name in names} | _MANAGED)


_MANAGED = {"__enter__": Bare.complete, "__exit__": Bare.complete}


def having(**members):
    return type("Having", (Bare,), members)


def raising(error):
    def factory(*given):
        raise error

    return factory


@property
def unreadable(self):
    raise KeyError("no such model")


class OutsideException(BaseException):
    """What a component may raise although only a few of Python's own are meant to be like this."""


FACTORIES = {
    "raises": raising(RuntimeError("no gpu")),
    "raises_key_error": raising(KeyError("weights")),
    "raises_type_error": raising(TypeError("of its own")),
    "exits": raising(SystemExit(0)),
    "raises_base": raising(OutsideException("no gpu")),
    "many_lines": raising(ValueError("first\nsecond\n" + "x" * 100_000)),
    "none": lambda: None,
    "number": lambda: 3,
    "text": lambda: "a text",
    "a_class": lambda: Bare,
    "no_factory": 3,
    "gives_nothing": None,
    "wants_more": lambda needed: None,
}
BY_KIND = {
    kind: {f"without_{name}": lacking(name) for name in members}
    for kind, members in MEMBERS.items()
} | {"catalogue": {}}
for _kind in ("llm", "encoder", "simulator"):
    BY_KIND[_kind] |= {
        "name_none": having(name=None),
        "name_number": having(name=3),
        "name_blank": having(name=" "),
        "name_broken": having(name="\ud800"),
        "name_raises": having(name=unreadable),
    }
BY_KIND["simulator"] |= {
    "dt_none": having(dt=None),
    "dt_nan": having(dt=float("nan")),
    "dt_zero": having(dt=0.0),
    "dt_negative": having(dt=-0.05),
    "dt_long": having(dt=0.2),
    "dt_short": having(dt=1e-9),
    "dt_raises": having(dt=unreadable),
    "catalogue_none": Bare,
}
for _kind, _members in MEMBERS.items():
    BY_KIND[_kind] |= {
        f"{name}_no_method": having(**{name: 3})
        for name in _members
        if name not in ("name", "dt", "dimension")
    }
CASES = [(kind, case) for kind in MAKERS for case in (*FACTORIES, *BY_KIND[kind])]


@pytest.fixture(autouse=True)
def module(monkeypatch):
    """Register every fault, for every kind, under its name and in a module."""
    module = types.ModuleType("faulty_plugins")
    for kind, cases in BY_KIND.items():
        for name, factory in (FACTORIES | cases).items():
            setattr(module, f"{kind}_{name}", factory)
    monkeypatch.setitem(sys.modules, "faulty_plugins", module)
    real = _entry_points.entry_points

    def with_plugins(*, group):
        (kind,) = (kind for kind, name in _entry_points.KINDS.items() if name == group)
        cases = FACTORIES | BY_KIND[kind]
        points = [EntryPoint(f"faulty-{n}", f"faulty_plugins:{kind}_{n}", group) for n in cases]
        return [*real(group=group), *points]

    monkeypatch.setattr(_entry_points, "entry_points", with_plugins)
    return module


def check(error, *names):
    """Look at a message: one line, not too long, with what is wrong."""
    text = str(error)
    assert "\n" not in text
    assert len(text) < 1_000
    assert any(name in text for name in names), text


@pytest.mark.parametrize(("kind", "case"), CASES)
def test_a_faulty_plugin_is_a_usage_error_that_names_it(kind, case):
    for name in (f"faulty_plugins:{kind}_{case}", f"faulty-{case}"):
        with pytest.raises(UsageError) as caught:
            MAKERS[kind](name)
        check(caught.value, name)


@pytest.mark.parametrize(("kind", "case"), [(k, c) for k, c in CASES if c in BY_KIND[k]])
def test_a_faulty_object_is_a_usage_error(kind, case):
    if case == "catalogue_none":
        return
    with pytest.raises(UsageError) as caught:
        MAKERS[kind](BY_KIND[kind][case]())
    check(caught.value, kind)


@pytest.mark.parametrize("thing", [None, 3, b"bytes", object(), Bare, [], {}])
def test_what_is_no_component_at_all_is_refused(thing):
    for make in (make_llm, make_encoder, make_simulator, make_driver):
        with pytest.raises(UsageError):
            make(thing)
    with pytest.raises(UsageError):
        simulate(example_scene(), thing)
    with pytest.raises(UsageError):
        encode(thing, ["A deer."])
    with pytest.raises(UsageError):
        ask(thing, ImagineScenario(shown=()))
    if thing is not None:
        with pytest.raises(UsageError):
            Metrics(thing)


@pytest.mark.parametrize("error", [RuntimeError("no gpu"), SystemExit(3), KeyError("x")])
def test_a_module_that_raises_when_it_is_imported(tmp_path, monkeypatch, error):
    for name in ("raising_alone", "raising_pack"):
        where = tmp_path / name
        where.mkdir()
        (where / "__init__.py").write_text(f"raise {error!r}\n")
        (where / "inner.py").write_text("Thing = 3\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    for make in MAKERS.values():
        for name in ("raising_alone:Thing", "raising_pack.inner:Thing"):
            with pytest.raises(UsageError) as caught:
                make(name)
            check(caught.value, name)
            check(caught.value, type(error).__name__)


# ------------------------------------------------------------------ while they work


def rows(texts, value=0.5, dtype=np.float32, width=4):
    return np.full((len(texts), width), value, dtype)


@pytest.mark.parametrize(
    "encoded",
    [
        lambda texts: None,
        lambda texts: [[0.0] * 4 for _ in texts],
        lambda texts: rows(texts)[:-1],
        lambda texts: rows(texts, width=3),
        lambda texts: rows(texts)[0],
        lambda texts: rows(texts, dtype=np.float64),
        lambda texts: rows(texts, dtype=object),
        lambda texts: rows(texts, value=np.nan),
        lambda texts: rows(texts, value=np.inf),
        lambda texts: {}["weights"],
        lambda texts: sys.exit(0),
        lambda texts: 1 / 0,
    ],
)
def test_an_encoder_that_fails_while_it_works(encoded, tmp_path, module):
    module.Encoder = having(encode=lambda self, texts: encoded(texts))
    with pytest.raises(EncoderError, match="bare"):
        encode(module.Encoder(), ["A deer.", "A sofa."])
    with pytest.raises(EncoderError, match="bare"):
        Metrics(module.Encoder()).oodness(["A deer.", "A sofa."])
    (tmp_path / "t.txt").write_text("A deer.\nA sofa.\n")
    called(1, "score", tmp_path / "t.txt", "--encoder", "faulty_plugins:Encoder")


@pytest.mark.parametrize(
    ("dimension", "width"),
    [(None, 4), ("4", 4), (-1, 4), (0, 0), (3.5, 4), (4.0, 4), (True, 1), (unreadable, 4)],
)
def test_an_encoder_of_no_dimension(dimension, width):
    encoder = having(dimension=dimension, encode=lambda self, texts: rows(texts, width=width))()
    with pytest.raises(EncoderError, match="bare"):
        encode(encoder, ["A deer."])
    with pytest.raises(EncoderError, match="bare"):
        Metrics(encoder).diversity(["A deer.", "A sofa."])


@pytest.mark.parametrize(
    "answer",
    [
        *(None, 3, "text", {}, KeyError("x"), SystemExit(0), GeneratorExit(), RecursionError()),
        OutsideException("a"),
        DataError("completion", [Issue("text", "Input should be a valid string")]),
    ],
)
def test_a_model_that_fails_while_it_works(answer, tmp_path, module):
    def complete(self, request):
        if isinstance(answer, BaseException):
            raise answer
        return answer

    module.Model = having(complete=complete)
    with pytest.raises(LLMError, match="bare"):
        ask(module.Model(), ImagineScenario(shown=()))
    called(1, "grow", "--llm", "faulty_plugins:Model")
    called(1, "doctor", "llm", "faulty_plugins:Model")


SIMULATOR_METHODS = ("reset", "step", "render", "observe", "catalogue")


@pytest.mark.parametrize("method", SIMULATOR_METHODS)
@pytest.mark.parametrize("fault", ["none", "error", "usage", "exit", "base"])
def test_a_simulator_that_fails_while_it_works(method, fault, tmp_path, module):
    def broken(self, *given):
        if fault == "none":
            return
        raise {
            "error": KeyError("a"),
            "usage": UsageError("a"),
            "exit": SystemExit(0),
            "base": OutsideException(),
        }[fault]

    module.Simulator = type("Simulator", (FlatSimulator,), {method: broken, "name": "sim"})
    kind: type[OodscenError] = SimulatorCrash
    if fault == "none":
        kind = UsageError if method == "catalogue" else SimulatorError
    with pytest.raises(kind, match="sim") as caught:
        simulate(example_scene(), module.Simulator())
    assert caught.type is kind
    (failed, *_) = drive([example_scene()], Bare, module.Simulator(), twins=False)
    assert failed.status == "failed"
    if method == "catalogue":
        with pytest.raises(OodscenError):
            make_simulator("faulty_plugins:Simulator")
        return
    (result,) = run_chunk(Job("faulty_plugins:Simulator", 0, Outputs()), [example_scene()])
    assert (result.episode.status, result.episode.error_type) == ("failed", kind.__name__)


@pytest.mark.parametrize("error", [ValueError("close"), SystemExit(0), OutsideException()])
def test_a_simulator_that_fails_when_it_closes_costs_no_work(error, module):
    module.Simulator = type("Simulator", (FlatSimulator,), {"close": raising(error)})
    (result,) = run_chunk(Job("faulty_plugins:Simulator"), [example_scene()])
    assert result.episode.status == "ok"
    assert make_catalogue("faulty_plugins:Simulator").simulator == "flat"


@pytest.mark.parametrize(
    "error",
    [
        SceneError("s-001", [Issue("map", "has no lane")]),
        SimulatorError("no frame"),
        SpawnError("a", "cone", (0.0, 0.0, 0.0, 0.0), "no room"),
        MissingExtra("the simulator", "flat", "numpy"),
    ],
)
def test_what_a_simulator_says_itself_passes(error):
    with pytest.raises(OodscenError) as caught, working("simulator", "sim"):
        raise error
    assert caught.value is error


def test_an_interruption_is_no_fault_of_the_component():
    for error in (KeyboardInterrupt(), asyncio.CancelledError()):
        with pytest.raises(type(error)), working("simulator", "sim"):
            raise error


def test_a_driver_may_raise_anything():
    (failed,) = drive(
        [example_scene()], having(act=raising(OutsideException("a"))), FlatSimulator(), twins=False
    )
    assert (failed.status, failed.error_type) == ("failed", "OutsideException")


@pytest.mark.parametrize(
    "control",
    [None, 3, (0.0, 0.0), Control(float("nan")), Control(0.0, float("inf")), Control(None)],
)
def test_a_driver_that_returns_no_control_fails_its_drive(control):
    driver = having(act=lambda self, observation: control)
    (failed,) = drive([example_scene()], driver, FlatSimulator(), twins=False)
    assert failed.status == "failed"
    assert "act() returned" in failed.error


@pytest.mark.parametrize("case", ["none", "raises", "exits", "without_close", "catalogue_none"])
def test_the_conformance_check_lists_what_it_finds(case):
    with pytest.raises(AssertionError, match="breaks its protocol"):
        check_simulator((FACTORIES | BY_KIND["simulator"])[case])


@pytest.mark.parametrize("price", [None, 3, "much", (1.0,)])
def test_the_price_of_a_model_may_be_anything(price, module):
    module.Model = having(price=price)
    assert "not known" in called(1, "doctor", "llm", "faulty_plugins:Model").output


# ------------------------------------------------------------------ the commands


def called(code, *arguments):
    """Call a command; look at its exit code and that it says so in one line."""
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert result.exit_code == code, (result.output, result.exception)
    assert isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    return result


@pytest.fixture(scope="module")
def study(small, tmp_path_factory):
    """Return the folder of a small study, with files for every command."""
    folder = shutil.copytree(small, tmp_path_factory.mktemp("plugins") / "study")
    (folder / "texts.txt").write_text("A deer.\nA sofa.\n")
    return folder


COMMANDS = {
    "llm": [
        ("grow", "--llm"),
        ("redteam", "tree.diverse.json", "--llm"),
        ("prune", "tree.diverse.json", "--simulator", "flat", "--llm"),
        ("describe", "tree.diverse.json", "--llm"),
        ("augment", "scenarios.jsonl", "--simulator", "flat", "--llm"),
        ("doctor", "llm"),
        ("evaluate", ".", "--vlm"),
        ("evaluate", ".", "--judge"),
    ],
    "encoder": [
        ("score", "texts.txt", "--encoder"),
        ("redteam", "tree.diverse.json", "--encoder"),
        ("describe", "tree.diverse.json", "--encoder"),
        ("tree", "diff", "tree.initial.json", "tree.diverse.json", "--encoder"),
    ],
    "simulator": [
        ("prune", "tree.diverse.json", "--simulator"),
        ("augment", "scenarios.jsonl", "--simulator"),
        ("doctor", "--quick"),
    ],
    "catalogue": [("prune", "tree.diverse.json", "--catalogue")],
    "driver": [("drive", ".", "--driver")],
}


@pytest.mark.parametrize("case", ["raises", "exits", "many_lines"])
@pytest.mark.parametrize("kind", COMMANDS)
def test_a_command_refuses_a_faulty_plugin_in_one_line(kind, case, study, monkeypatch):
    monkeypatch.chdir(study)
    before = {path: path.read_bytes() for path in study.rglob("*") if path.is_file()}
    for command in COMMANDS[kind]:
        result = called(2, *command, f"faulty_plugins:{kind}_{case}")
        assert result.stdout == ""
        assert len(result.stderr.splitlines()) == 1
    assert before == {path: path.read_bytes() for path in study.rglob("*") if path.is_file()}


@pytest.mark.parametrize("kind", ["llm", "encoder", "simulator"])
def test_a_run_refuses_a_faulty_plugin_before_any_work(kind, tmp_path):
    for case in ("none", "raises"):
        config = StudyConfig.quick(
            **{"simulator": "flat", "encoder": "hash", kind: f"faulty_plugins:{kind}_{case}"}
        )
        with pytest.raises(UsageError):
            run_study(tmp_path / "out", config)
    assert not (tmp_path / "out").exists()

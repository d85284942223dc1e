"""A public name takes an argument, or refuses it with an error of this library."""

import importlib
import inspect
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from functools import reduce
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import (
    Augmenter,
    Describer,
    Metrics,
    Pruner,
    RedTeamer,
    ScenarioTree,
    Study,
    TreeGrower,
    drive,
    make_catalogue,
    make_encoder,
    make_llm,
    run_study,
    simulate,
)
from oodscen._arguments import checked, instance_of
from oodscen.baselines import load_controls
from oodscen.data import Behaviour, Ego, Hazard, Placement, Trigger, WeatherRange
from oodscen.driving import Corridor, StagedScene
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.errors import OodscenError, UnknownComponent, UsageError
from oodscen.judging import names_aspect, read_action
from oodscen.llm import Limits
from oodscen.llm._call_log import LoggedLLM
from oodscen.llm._replay import RecordingLLM
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Camera, Control, Image
from oodscen.testing import ScriptedLLM, example_scene
from oodscen.testing._flat import FlatSimulator
from oodscen.tree._edits import TreeEdit
from tests.judging.cases import episode

PAGE = Path(__file__).parents[1].joinpath("docs", "api.md").read_text(encoding="utf-8")
NUMBERS = (math.nan, math.inf, -1, -math.inf, 1e300, 10**400, 0, True)
TEXTS = ("", "\x00", "\x1b[2J\n", "\ud800", "x" * 5_000)

KINDS = (
    *(
        None,
        5,
        1.5,
        "x",
        b"x",
        object(),
        [None],
        ["x"],
        {"x": None},
        np.zeros(2),
        (1, 2),
        Path("x"),
    ),
)
"""A value of every kind: whatever a parameter takes, most of them are wrong."""

OPTIONS = {"Describer": Describer.Options, "RedTeamer": RedTeamer.Options}
"""The classes whose further keywords are fields of their options."""

FLAT = make_catalogue("flat")
SCENE = example_scene()
GIVEN: dict[str, Any] = {
    "action_id": "stop",
    "actors": {},
    "asset": "car",
    "assets": FLAT.assets,
    "ahead_m": 1.0,
    "behaviours": FLAT.behaviours,
    "catalogue": FLAT,
    "category": "vehicle",
    "claims": (),
    "control": Control(),
    "corridor": Corridor.load(FLAT.maps[0]),
    "decision": Trigger(),
    "description": "a thing",
    "driver": lambda: None,
    "ego": FLAT.ego,
    "encoder": make_encoder("hash"),
    "episodes": (),
    "first": 0.5,
    "function": lambda asked: "",
    "hazard": Hazard(),
    "id": "x-1",
    "llm": ScriptedLLM([]),
    "log": lambda call: None,
    "maps": FLAT.maps,
    "model": "m",
    "offered": ("stop",),
    "path": ("environmental",),
    "placement": Placement(ahead_m=1.0),
    "camera": Camera(width=16, height=12),
    "poses": np.zeros((2, 4)),
    "prompt": ImagineScenario(shown=("A deer crosses.",)),
    "episode": episode("x-1", ("stop",)),
    "frames": {name: Image(name=name, sha256="0" * 64) for name in ("first", "middle", "last")},
    "vlm": ScriptedLLM([]),
    "state": FlatSimulator().reset(SCENE, 0),
    "results": (),
    "row": {"purpose": "choose-action", "key": '{"item":"x-1"}'},
    "road_map": FLAT.maps[0],
    "scenarios": (),
    "scene": SCENE,
    "scenes": (),
    "second": 0.6,
    "seed": 0,
    "sets": {},
    "simulator": FlatSimulator(),
    "split": "tune",
    "status": "ok",
    "edits": (),
    "node_id": "root",
    "other": ScenarioTree(),
    "text_sets": {},
    "tree": ScenarioTree(),
    "trigger": Trigger(),
    "verdicts": (),
    "weather": WeatherRange(),
    "answers": [],
    "behaviour": Behaviour(),
}
"""Good arguments by name; a number is 1 and a text `x` where none is listed."""

OWN: dict[str, dict[str, Any]] = {
    "Scene": {"ego": Ego(speed=10.0), "weather": SCENE.weather},
    "make_llm": {"llm": "constant:stop"},
    "make_encoder": {"encoder": "hash"},
    "make_simulator": {"simulator": "flat"},
    "make_catalogue": {"catalogue": "flat"},
    "Catalogue": {"simulator": "flat"},
    "Metrics": {"encoder": GIVEN["encoder"], "baseline": ["a car drives", "a van drives"]},
    "simulate": {"actions": (), "render": False},
    "record": {"path": "x.gif"},
    "read_openscenario": {"path": "x.xosc"},
}
SKIPPED = {"run_study", "check_simulator", "load_controls"}
"""What runs for long, or reads large files, whatever it is given."""
INNER = {"Control", "Corridor", "Frame", "Observation", "Request", "State"}
INNER |= {"Drive"}
"""Values of the inner loop, made once a step and not checked, and those that only the library makes."""

OBJECTS = (
    ScenarioTree([TreeEdit(op="add", node="root", label="Scenario")]),
    Augmenter(ScriptedLLM([]), FLAT),
    Describer(ScriptedLLM([])),
    Pruner(ScriptedLLM([]), FLAT),
    RedTeamer(ScriptedLLM([])),
    TreeGrower(ScriptedLLM([])),
    Metrics(make_encoder("hash"), ["a car drives", "a van drives"]),
)
"""Objects whose methods are called."""


def public() -> Iterator[tuple[str, Any]]:
    """Yield what can be called of the names on the page, once each."""
    seen = set()
    for package in re.findall(r"^## `([\w.]+)`$", PAGE, re.MULTILINE):
        if package == "oodscen.gymnasium" and find_spec("gymnasium") is None:
            continue
        module = importlib.import_module(package)
        for name in module.__all__ if package != "oodscen.errors" else ():
            found = getattr(module, name)
            is_abstract = inspect.isabstract(found) or getattr(found, "_is_protocol", False)
            is_abstract |= inspect.isclass(found) and issubclass(found, Exception)
            if callable(found) and not is_abstract and id(found) not in seen:
                seen.add(id(found))
                yield name, found


def atoms(kind: Any) -> set[Any]:
    """Return the types that an annotation allows."""
    if get_origin(kind) in (Union, UnionType):
        return set().union(*map(atoms, get_args(kind)))
    if get_origin(kind) is Annotated:
        return atoms(get_args(kind)[0])
    return {str} if get_origin(kind) is Literal else {kind}


def parameters(name: str, found: Any) -> dict[str, tuple[set[Any], bool]]:
    """Return the types of every parameter, and whether it is needed."""
    if hasattr(found, "model_fields"):
        fields = found.model_fields
        return {
            one: (atoms(field.annotation), field.is_required()) for one, field in fields.items()
        }
    target = found.__init__ if inspect.isclass(found) else found
    try:
        hints = get_type_hints(target)
    except NameError:
        hints = {}
    known = inspect.signature(found).parameters.values()
    taken = {
        one.name: (atoms(hints.get(one.name, one.annotation)), one.default is one.empty)
        for one in known
        if one.kind not in (one.VAR_KEYWORD, one.VAR_POSITIONAL)
    }
    if name in OPTIONS:
        taken |= parameters("", OPTIONS[name])
    return taken


def cases() -> Iterator[Any]:
    for name, found in [*public(), *methods()]:
        if name not in SKIPPED | INNER:
            for one, (kinds, _) in parameters(name, found).items():
                values = [*(NUMBERS if kinds & {int, float} else ())]
                values += TEXTS if str in kinds else ()
                values += () if kinds & {Any, inspect.Parameter.empty} else KINDS
                if values:
                    yield pytest.param(name, found, one, values, id=f"{name}-{one}")


def methods() -> Iterator[tuple[str, Any]]:
    """Yield the public methods of trees, stages and metrics, and further ones of scenes and roads."""
    for made in OBJECTS:
        for name in dir(made):
            if not name.startswith("_") and inspect.isroutine(found := getattr(made, name)):
                yield f"{type(made).__name__}.{name}", found
    for method in (
        *(
            SCENE.check,
            SCENE.check_claims,
            SCENE.vary,
            SCENE.to_openscenario,
            SCENE.to_openlabel,
            SCENE.to_osi,
        ),
        *(Corridor.load, StagedScene(SCENE, FLAT).observation, StagedScene(SCENE, FLAT).draw),
    ):
        yield method.__qualname__, method


@pytest.mark.parametrize(("name", "found", "one", "values"), list(cases()))
def test_an_argument_is_taken_or_refused(monkeypatch, tmp_path, name, found, one, values):
    monkeypatch.chdir(tmp_path)
    given = {}
    for other, (kinds, is_needed) in parameters(name, found).items():
        own = OWN.get(name, {})
        if is_needed or other in own:
            plain = 1 if kinds & {int, float} else "x"
            given[other] = own.get(other, GIVEN.get(other, plain))
    is_whole = parameters(name, found)[one][0] <= {int, type(None)}
    for value in values:
        is_refused = isinstance(value, float) and (is_whole or math.isnan(value))
        with pytest.raises(OodscenError) if is_refused else suppress(OodscenError):
            found(**{**given, one: value})


NAMELESS = SimpleNamespace(complete=lambda request: None)
REFUSED = {
    "a negative number of retries": lambda: make_llm(
        "litellm:m", api_base="http://127.0.0.1:9", retries=-1
    ),
    "no request at once": lambda: Limits(concurrency=0),
    "half a price": lambda: Limits(prices={"m": (1.0,)}),
    "a price that is a word": lambda: Limits(prices={"m": "ab"}),
    "fewer than no texts": lambda: Describer(ScriptedLLM([]), per_path=-1),
    "a negative seed": lambda: make_llm("constant:stop", seed=-1),
    "an answer that is no text": lambda: read_action(None),
    "an action without a name": lambda: read_action("stop", [""]),
    "a logged model without a name": lambda: LoggedLLM(NAMELESS, lambda call: None),
    "a recorded model without a name": lambda: RecordingLLM(NAMELESS, "recording.jsonl"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_is_refused(what):
    with pytest.raises(UsageError):
        REFUSED[what]()


@pytest.mark.parametrize(
    "call",
    [
        lambda: Study.open(5),
        lambda: Corridor.load(5),
        lambda: Pruner(ScriptedLLM([]), None),
        lambda: RedTeamer(ScriptedLLM([])).run(None),
        lambda: Augmenter(ScriptedLLM([]), None),
        lambda: Augmenter(ScriptedLLM([]), FLAT).run("a text"),
        lambda: TreeGrower(ScriptedLLM([])).run(progress="yes"),
    ],
)
def test_a_thing_of_another_kind_is_refused(call) -> None:
    with pytest.raises(UsageError, match="must be"):
        call()


EMPTY = Study.__new__(Study)
NAMES = {
    "a protocol": lambda: simulate(SCENE, FLAT_SIMULATOR, protocol="papr"),
    "a split": lambda: load_controls("tunes"),
    "a form": lambda: EMPTY.publish("out", forms=["vlmeval"]),
    "a node": lambda: ScenarioTree().path("nope"),
}


@pytest.mark.parametrize("what", NAMES)
def test_an_unknown_name_is_told_with_those_that_are_known(what) -> None:
    with pytest.raises(UnknownComponent):
        NAMES[what]()


OTHERS = {
    "one form": lambda: EMPTY.publish("out", forms="vlmevalkit"),
    "a study's folder": lambda: Study(3),
    "a requirement that is no text": lambda: EMPTY.write_report(3),
    "a path's text": lambda: names_aspect("deer", "Deer"),
    "an array of nothing": lambda: names_aspect("deer", np.array([])),
    "an array without an axis": lambda: names_aspect("deer", np.array("Deer")),
    "a number of workers that is none": lambda: run_study("out", workers=None),
    "limits that are none": lambda: run_study("out", limits=5),
    "no action to read": lambda: read_action("stop", []),
    "a model's name": lambda: RedTeamer("builtin"),
    "a file descriptor": lambda: ScenarioTree.load(0),
    "no simulator": lambda: drive([SCENE], RuleBasedDriver, None),
    "the state of another scene": lambda: SCENE.birds_eye(ALONE, FLAT),
    "an annotated state of another scene": lambda: SCENE.annotate(FRAME, ALONE, FLAT),
    "an observed state of another scene": lambda: StagedScene(SCENE, FLAT).observation(ALONE),
    "lists in lists in lists": lambda: read_action(
        reduce(lambda inner, _: [inner], range(9_999), [])
    ),
    "a thing that cannot be shown": lambda: read_action(Unshown()),
    "a list of things that cannot be shown": lambda: drive([SCENE], RuleBasedDriver, [Unshown()]),
}


class Unshown:
    def __repr__(self) -> str:
        raise RuntimeError("no words")


FLAT_SIMULATOR = FlatSimulator()
ALONE = FLAT_SIMULATOR.reset(SCENE.model_copy(update={"actors": (), "hazard": Hazard()}), 0)
FRAME = FLAT_SIMULATOR.render(Camera(width=16, height=12))


@pytest.mark.parametrize("what", OTHERS)
def test_another_kind_of_thing_is_a_usage_error(what) -> None:
    with pytest.raises(UsageError):
        OTHERS[what]()


@pytest.mark.parametrize(
    ("kinds", "words"),
    [
        ((int,), "an int"),
        ((str, Path), "text or a path"),
        ((bool,), "True or False"),
        ((Ego, Behaviour), "an Ego or a Behaviour"),
    ],
)
def test_a_refusal_names_the_kinds_in_words(kinds, words) -> None:
    with pytest.raises(UsageError, match=f"^x must be {words}, not None$"):
        instance_of("x", None, *kinds)


@given(
    st.one_of(st.none(), st.booleans(), st.integers(), st.text(), st.lists(st.text()), st.binary())
)
def test_a_checked_function_takes_what_its_annotations_say(value) -> None:
    def kept(kind):
        def function(value: kind) -> object:
            return value

        return checked(function)

    for kind, fits in {
        str: isinstance(value, str),
        bool: isinstance(value, bool),
        str | None: isinstance(value, str | None),
        Sequence[str]: isinstance(value, list),
        list[bool]: value == [],
        Mapping[str, str]: False,
        Path: False,
        Literal["x", "y"]: value in ("x", "y"),
        Callable[[], None]: False,
        Any: True,
        float: True,  # Numbers have checks of their own.
    }.items():
        with nullcontext() if fits else pytest.raises(UsageError):
            assert kept(kind)(value) is value


def test_a_call_that_python_refuses_is_a_type_error_and_more_arguments_are_passed_on() -> None:
    @checked
    def function(first: int, *more: int, last: str = "") -> tuple[object, ...]:
        return first, more, last

    assert function(1, 2, last="x") == (1, (2,), "x")
    for call in (lambda: function(), lambda: function(1, other=2), lambda: function(1, first=2)):
        with pytest.raises(TypeError, match=r"function\(\)"):
            call()

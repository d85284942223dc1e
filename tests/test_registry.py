"""Components by name: entry points, `module:attr`, objects as they are."""

import os
import shutil
import sys
import types
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import _entry_points
from oodscen import _registry as registry
from oodscen._entry_points import load_factory, names, survey
from oodscen._registry import (
    make_catalogue,
    make_driver,
    make_encoder,
    make_llm,
    make_simulator,
)
from oodscen.data._episode import ACTIONS
from oodscen.encoders._sentence_transformers import SentenceTransformerEncoder
from oodscen.errors import MissingExtra, UnknownComponent, UsageError
from oodscen.judging._constant_answerers import ConstantAnswerer, RandomAnswerer
from oodscen.llm._ask import ask
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder
from oodscen.testing._flat import FlatSimulator

IMAGINE = ImagineScenario(shown=("A deer crosses.",))


class Plain:
    """A model that takes no settings."""

    name = "plain"

    def complete(self, request):
        raise NotImplementedError


class Seeded:
    """A model that takes everything."""

    def __init__(self, **settings):
        self.name = "seeded"
        self.settings = settings

    def complete(self, request):
        raise NotImplementedError


@pytest.fixture
def plugins(monkeypatch):
    """Register `plain`, `broken` and `number` as further models."""
    module = types.ModuleType("toy_models")
    module.Plain, module.Seeded, module.number = Plain, Seeded, 3
    monkeypatch.setitem(sys.modules, "toy_models", module)
    real = _entry_points.entry_points

    def with_plugins(*, group):
        extra = [
            EntryPoint("plain", "toy_models:Plain", group),
            EntryPoint("broken", "toy_models:Missing", group),
            EntryPoint("gone", "toy_models_gone:Missing", group),
            EntryPoint("number", "toy_models:number", group),
        ]
        return [*real(group=group), *(extra if group == "oodscen.llms" else [])]

    monkeypatch.setattr(_entry_points, "entry_points", with_plugins)


def test_the_shipped_components_are_registered():
    assert {"builtin", "litellm", "constant", "random"} <= set(names("llm"))
    assert {"minilm", "sentence-transformers", "hash"} <= set(names("encoder"))
    assert {"pybullet", "flat"} <= set(names("simulator"))


def test_a_package_is_found_as_soon_as_it_is_installed(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "notes.txt").touch()
    assert "later" not in names("encoder")
    info = tmp_path / "later-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Name: later\nVersion: 1\n")
    (info / "entry_points.txt").write_text("[oodscen.encoders]\nlater = later:Encoder\n")
    assert "later" in names("encoder")
    shutil.rmtree(info)
    assert "later" not in names("encoder")


def test_an_object_is_taken_as_it_is():
    llm, encoder, simulator = ScriptedLLM([]), HashEncoder(), FlatSimulator()
    assert make_llm(llm) is llm
    assert make_encoder(encoder) is encoder
    assert make_simulator(simulator) is simulator


@pytest.mark.parametrize(
    ("make", "name", "match"),
    [
        (make_simulator, "pybulet", "pybullet"),
        (make_encoder, "mini-lm", "minilm"),
        (make_llm, "bultin", "builtin"),
        (make_llm, "gpt-4oo", "gpt-4o"),
        (make_llm, "opnai/gpt-4o", "openai/gpt-4o"),
        (make_llm, "Constant", "constant"),
        (make_llm, "constant:stopp", "stop"),
    ],
)
def test_an_unknown_name_comes_with_close_matches(make, name, match):
    with pytest.raises(UnknownComponent) as caught:
        make(name)
    assert match in caught.value.matches


def test_a_misspelt_own_name_is_matched_without_litellm(monkeypatch):
    monkeypatch.setitem(sys.modules, "litellm", None)
    with pytest.raises(UnknownComponent) as caught:
        make_llm("bultin")
    assert caught.value.matches[0] == "builtin"
    with pytest.raises(MissingExtra) as missing:
        make_llm("gpt-4o")
    assert (missing.value.extra, missing.value.module) == ("llm", "litellm")


def test_a_name_may_carry_an_argument():
    assert make_llm("constant:slow_down").name == "constant:slow_down"
    assert isinstance(make_llm("constant"), ConstantAnswerer)
    encoder = make_encoder("sentence-transformers:some/model")
    assert isinstance(encoder, SentenceTransformerEncoder)
    for make, name in (
        (make_llm, "random:7"),
        (make_encoder, "hash:many"),
        (make_encoder, "sentence-transformers"),
        (make_simulator, "flat:1"),
    ):
        with pytest.raises(UsageError):
            make(name)


def test_the_seed_reaches_a_model_that_takes_one(plugins):
    assert make_llm("random", seed=5).seed == 5
    assert make_llm("oodscen.judging._constant_answerers:RandomAnswerer", seed=5).seed == 5
    assert make_llm("toy_models:Seeded", seed=5).settings == {"seed": 5}
    assert make_llm("plain", seed=5).name == "plain"


def test_a_reference_to_a_module_works_for_every_kind():
    assert (
        load_factory("llm", "oodscen.judging._constant_answerers:RandomAnswerer") is RandomAnswerer
    )
    assert isinstance(make_encoder("oodscen.testing._encoder:HashEncoder"), HashEncoder)
    with pytest.raises(UsageError, match="Missing"):
        make_encoder("oodscen.testing:Missing")
    with pytest.raises(UsageError, match="no module 'no_such_module_anywhere'"):
        make_encoder("no_such_module_anywhere:Thing")


def test_a_folder_is_an_encoder(tmp_path):
    (tmp_path / "model.safetensors").write_bytes(b"weights")
    assert isinstance(make_encoder(str(tmp_path)), SentenceTransformerEncoder)


@pytest.mark.parametrize("name", ["broken", "gone", "number"])
def test_a_broken_plugin_is_a_usage_error_that_names_it(plugins, name):
    with pytest.raises(UsageError, match=name):
        make_llm(name)


def test_the_survey_lists_what_is_broken_and_what_works(plugins):
    states = {row["name"]: row["state"] for row in survey() if row["kind"] == "llm"}
    assert states["random"] == states["plain"] == "ok"
    for name in ("broken", "gone", "number"):
        assert name in states[name]


def _register(monkeypatch, *points):
    real = _entry_points.entry_points
    monkeypatch.setattr(
        _entry_points,
        "entry_points",
        lambda *, group: [*real(group=group), *(one for one in points if one.group == group)],
    )


@pytest.mark.parametrize("module", ["aa_fork", "zz_fork"])
def test_a_name_of_this_library_stays_its_own(monkeypatch, module):
    _register(monkeypatch, EntryPoint("flat", f"{module}:Simulator", "oodscen.simulators"))
    assert isinstance(make_simulator("flat"), FlatSimulator)
    states = [row["state"] for row in survey() if row["name"] == "flat" and module in row["source"]]
    assert states == ["not used: the name is that of oodscen.testing._flat:FlatSimulator"]


def test_a_name_that_two_packages_share_is_refused_with_both(monkeypatch):
    group = "oodscen.simulators"
    values = [f"fork_{letter}:Simulator" for letter in "ab"]
    _register(monkeypatch, *(EntryPoint("mine", value, group) for value in values))
    with pytest.raises(
        UsageError, match=r"2 packages call a simulator 'mine': fork_a:Sim.*fork_b:Sim"
    ):
        make_simulator("mine")
    assert [row["source"] for row in survey() if row["name"] == "mine"] == values


def test_an_entry_point_that_is_found_twice_is_one(monkeypatch):
    value = "oodscen.testing._flat_catalogue:FLAT_CATALOGUE"
    _register(monkeypatch, *(EntryPoint("twice", value, "oodscen.catalogues") for _ in "ab"))
    assert [row["source"] for row in survey() if row["name"] == "twice"] == [value]


def test_the_survey_names_the_methods_that_a_class_lacks(monkeypatch):
    value = "oodscen.testing._flat:FlatSimulator"
    _register(monkeypatch, EntryPoint("gpt-4o", value, "oodscen.llms"))
    states = {row["name"]: row["state"] for row in survey() if row["kind"] == "llm"}
    assert states["gpt-4o"] == "has no complete()"


@pytest.mark.parametrize("name", ["", ":", "a:", ":b", "a b:c", "..:x", "../x", "os", "\n"])
def test_nonsense_is_an_unknown_name(name):
    for make in (make_encoder, make_simulator, make_llm):
        with pytest.raises(UsageError):
            make(name)


@pytest.mark.parametrize("make", [make_encoder, make_simulator, make_llm])
def test_a_module_that_is_missing_is_named(make):
    with pytest.raises(UsageError, match="no module 'gone_astray'"):
        make("gone_astray:Thing")


@given(st.characters(categories=["Cc"]))
def test_the_name_of_a_model_is_one_line_of_text(character):
    with pytest.raises(UsageError, match="control character"):
        make_llm(f"openai/gpt{character}4o", api_base="http://localhost:1")


def test_a_component_does_not_take_the_command_elsewhere(monkeypatch, tmp_path):
    class Wanderer(FlatSimulator):
        def __init__(self):
            super().__init__()
            os.chdir("/")

    module = types.ModuleType("wandering")
    module.Wanderer = Wanderer
    monkeypatch.setitem(sys.modules, "wandering", module)
    monkeypatch.chdir(tmp_path)
    make_simulator("wandering:Wanderer").close()
    assert Path.cwd() == tmp_path


def test_a_catalogue_is_found_by_name_by_file_and_by_its_simulator(tmp_path):
    carla = make_catalogue("carla-0.9.16")
    assert make_catalogue(carla) is carla
    (tmp_path / "own.json").write_text(carla.to_json())
    assert make_catalogue(tmp_path / "own.json") == carla
    assert make_catalogue("flat").simulator == "flat"
    with pytest.raises(UnknownComponent) as caught:
        make_catalogue("carla")
    assert caught.value.matches == ("carla-0.9.16",)


def test_what_follows_the_colon_goes_where_the_component_says(tmp_path):
    (tmp_path / "own.toml").write_text("")
    author = make_llm(f"builtin:{tmp_path / 'own.toml'}", seed=4)
    assert (author.seed, author.name) == (4, "builtin:own.toml")
    with pytest.raises(UsageError):
        make_llm(f"builtin:{tmp_path / 'nowhere.toml'}")


def test_calls_are_logged_and_answers_recorded(tmp_path):
    asked = ScriptedLLM({IMAGINE.purpose: {"text": "A sofa lies on the road."}})
    calls = []
    llm = make_llm(asked, log=calls.append, record=tmp_path / "answers.jsonl")
    assert ask(llm, IMAGINE) == ask(llm, IMAGINE) == ask(asked, IMAGINE)
    assert [call.purpose for call in calls] == [IMAGINE.purpose]


@pytest.mark.parametrize("llm", ["constant", "gpt-4o", ScriptedLLM([])])
def test_a_setting_that_a_model_does_not_have_is_refused(llm):
    with pytest.raises(UsageError):
        make_llm(llm, temprature=0.5)


def test_an_encoder_with_a_cache_encodes_a_text_once(tmp_path):
    plain, cached = HashEncoder(), make_encoder(HashEncoder(), cache=True)
    assert make_encoder(plain) is plain
    assert (cached.encode(["a", "b", "a"]) == plain.encode(["a", "b", "a"])).all()
    assert make_encoder(plain, cache=tmp_path).path.parent == tmp_path


def test_reference_drivers_have_names():
    assert {"rule-based", "r157", "rss"} <= set(names("driver"))
    for name in _entry_points.DRIVERS:
        made = registry.driver_maker(name)
        assert made() is not made()
    with pytest.raises(UnknownComponent, match="rule-based"):
        registry.driver_maker("rule_based")


def test_a_driver_is_made_by_name_with_its_settings():
    for action in ACTIONS:
        assert make_driver(action) is not make_driver(action)
    assert make_driver("stop", reaction_s=0.5).reaction_s == 0.5
    assert make_driver("rss", response_s=1.0).parameters.response_s == 1.0
    assert make_driver("rule-based", headway_s=2.0).headway_s == 2.0
    own = make_driver("oodscen.driving._drivers.r157:R157Driver")
    assert make_driver(own) is own


@pytest.mark.parametrize(
    ("name", "settings", "match"),
    [
        ("emergency_break", {}, "emergency_brake"),
        ("stop", {"reaction": 0.5}, "reaction_s"),
        ("stop", {"reaction_s": -1.0}, "reaction_s"),
        ("rss", {"response": 1.0}, "response_s"),
        ("rss", {"response_s": -1.0}, "response_s"),
        ("r157", {"response_s": 1.0}, "setting of r157"),
        ("rule-based", {"headway_s": float("nan")}, "headway_s"),
        (make_driver("stop"), {"reaction_s": 0.5}, "takes no settings"),
    ],
)
def test_a_driver_that_cannot_be_is_refused(name, settings, match):
    with pytest.raises(UsageError, match=match):
        make_driver(name, **settings)


@pytest.mark.parametrize(
    ("make", "name"),
    [(registry.make_llm, "builtin:"), (registry.make_encoder, "sentence-transformers:")],
)
def test_nothing_after_a_colon_is_refused(make, name):
    with pytest.raises(UsageError, match="nothing after its colon"):
        make(name)


@pytest.mark.parametrize("name", ["{}", "openai/{}", "replay:{}.jsonl", "constant:{}", "{}:Model"])
@pytest.mark.parametrize("make", [make_llm, make_encoder])
def test_a_name_that_holds_a_key_is_refused_without_the_key(monkeypatch, make, name):
    key = "kEy_13chars"
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with pytest.raises(UsageError, match="holds a key") as refused:
        make(name.format(key))
    assert key not in str(refused.value)


def test_a_model_that_an_encoder_loads_has_no_name_that_holds_a_key(monkeypatch):
    monkeypatch.setenv("HF_TOKEN", "kEy_13chars")
    with pytest.raises(UsageError, match="holds a key"):
        make_encoder("sentence-transformers:kEy_13chars")

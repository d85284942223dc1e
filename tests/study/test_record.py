"""The record of a study says plainly who wrote the texts."""

from types import SimpleNamespace

import pytest

from oodscen import StudyConfig, __version__, make_simulator
from oodscen._abilities import packages_of
from oodscen.errors import SimulatorError
from oodscen.study._record import authors, joined_versions, record


def test_the_built_in_author_is_never_called_a_model():
    assert all("not a language model" in text for text in authors(StudyConfig()).values())
    named = authors(StudyConfig(llm="gpt-4o"))
    assert named == {"llm": "gpt-4o", "red_llm": "gpt-4o"}
    mixed = authors(StudyConfig(llm="gpt-4o", red_llm="builtin:own.toml"))
    assert "not a language model" in mixed["red_llm"]


def test_a_fallback_may_have_written_too():
    told = authors(StudyConfig(llm="gpt-4o", fallback="builtin"))
    assert told["llm"] == "gpt-4o"
    assert "not a language model" in told["fallback"]
    assert "fallback" not in authors(StudyConfig())


def test_an_own_knowledge_base_is_told_by_its_content(tmp_path):
    file = tmp_path / "mine.toml"
    told = []
    for content in ("a = 1", "a = 2", "a = 1"):
        file.write_text(content)
        told += [authors(StudyConfig(llm=f"builtin:{path}"))["llm"] for path in (file, tmp_path)]
    assert len(set(told)) == 4
    assert told[:2] == told[4:]
    assert "mine.toml" in told[0]
    file.unlink()
    assert "mine.toml" in authors(StudyConfig(llm=f"builtin:{file}"))["llm"]


@pytest.mark.parametrize("name", ["builtin:", "builtin:."])
def test_own_knowledge_of_the_working_folder_is_told_by_its_name(tmp_path, monkeypatch, name):
    (tmp_path / "mine").mkdir()
    monkeypatch.chdir(tmp_path / "mine")
    assert "extended by mine (digest " in authors(StudyConfig(llm=name))["llm"]


@pytest.mark.parametrize("name", ["flat", "pybullet", "highway", "sumo"])
def test_the_versions_are_those_of_the_simulator_that_ran(name):
    simulator = make_simulator(name)
    found = record(StudyConfig(), "success", packages=packages_of(simulator))["versions"]
    own = {"pybullet": "pybullet", "highway": "highway-env", "sumo": "libsumo"}
    assert [key for key, package in own.items() if package in found] == [name] * (name in own)


def test_a_study_lists_the_versions_of_all_its_runs():
    first = {"numpy": "2.0", "torch": "2.13"}
    second = {"numpy": "2.1", "torch": "2.13", "pybullet": "3.2"}
    joined = joined_versions(joined_versions({}, first), second)
    assert joined == {"numpy": "2.0, 2.1", "torch": "2.13", "pybullet": "3.2"}
    assert joined_versions(joined, first) == joined


@pytest.mark.parametrize("packages", ["numpy", [3], [""], {"numpy": 1}])
def test_packages_are_names(packages):
    with pytest.raises(SimulatorError, match="packages is"):
        packages_of(SimpleNamespace(name="mine", packages=packages))


def test_it_holds_configuration_versions_and_prompt_versions():
    content = record(StudyConfig(seed=4), "success", counts={"paths": 13})
    assert content["config"]["seed"] == 4
    assert content["versions"]["oodscen"] == __version__
    assert content["counts"] == {"paths": 13}
    assert all(len(version) == 12 for version in content["prompts"].values())

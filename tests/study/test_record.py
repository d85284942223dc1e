"""The record of a study says plainly who wrote the texts."""

from oodscen import StudyConfig, __version__
from oodscen.study._record import authors, record


def test_the_built_in_author_is_never_called_a_model():
    assert all("not a language model" in text for text in authors(StudyConfig()).values())
    named = authors(StudyConfig(llm="gpt-4o"))
    assert named == {"llm": "gpt-4o", "red_llm": "gpt-4o"}
    mixed = authors(StudyConfig(llm="gpt-4o", red_llm="builtin:own.toml"))
    assert "not a language model" in mixed["red_llm"]


def test_it_holds_configuration_versions_and_prompt_versions():
    content = record(StudyConfig(seed=4), "success", counts={"paths": 13})
    assert content["config"]["seed"] == 4
    assert content["versions"]["oodscen"] == __version__
    assert content["counts"] == {"paths": 13}
    assert all(len(version) == 12 for version in content["prompts"].values())

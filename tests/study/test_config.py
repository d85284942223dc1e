"""Configurations: closed, checked, comparable."""

import pytest

from oodscen import StudyConfig
from oodscen import _paper as paper
from oodscen.errors import DataError
from oodscen.protocols import Camera


def test_the_default_follows_the_paper():
    config = StudyConfig()
    assert (config.nodes, config.iterations, config.per_path) == (40, 100, 10)
    assert config.sets == paper.SETS
    assert config.llm == "builtin"


def test_text_sets_are_written_where_they_cost_nothing_or_are_asked_for():
    assert StudyConfig(llm="gpt-4o").sets == ()
    assert StudyConfig(llm="gpt-4o", sets=(7,)).sets == (7,)
    assert StudyConfig.parse({"llm": "gpt-4o", "sets": None}).sets == ()
    assert StudyConfig.parse(StudyConfig().model_dump()).sets == paper.SETS


def test_the_picture_has_the_size_that_is_asked_for():
    camera = StudyConfig(width=1280, height=960).camera
    assert (camera.width, camera.height) == (1280, 960)
    assert StudyConfig().camera == Camera()


def test_a_band_of_rarity_must_be_ordered():
    with pytest.raises(DataError, match="rarity"):
        StudyConfig.parse({"rarity": [1e6, 1e4]})


def test_all_faults_are_reported_at_once():
    with pytest.raises(DataError) as caught:
        StudyConfig.parse({"nodes": 3, "seed": -1, "modell": "x"})
    assert {issue.path for issue in caught.value.issues} == {"nodes", "seed", "modell"}


def test_a_band_must_be_ordered():
    with pytest.raises(DataError, match="lower bound"):
        StudyConfig.parse({"band": [-0.4, -0.6]})


def test_differences_name_the_field_and_both_values():
    assert StudyConfig(seed=1).differences(StudyConfig(seed=2, nodes=50)) == {
        "seed": (1, 2),
        "nodes": (40, 50),
    }


def test_quick_is_a_small_study_that_can_be_changed():
    config = StudyConfig.quick(seed=3)
    assert config.seed == 3
    assert config.iterations < StudyConfig().iterations


@pytest.mark.parametrize("field", ["api_base", "servers"])
def test_no_key_gets_into_a_study_by_an_address(field):
    address = "http://user:planted@localhost:8000/v1"
    with pytest.raises(DataError) as caught:
        StudyConfig.parse({field: address if field == "api_base" else {"model": address}})
    assert "OPENAI_API_KEY" in str(caught.value)
    assert "planted" not in str(caught.value)


NAMED = ("llm", "red_llm", "fallback", "vlms", "judge", "rarity_llm", "recogniser", "encoder")


@pytest.mark.parametrize("field", NAMED)
@pytest.mark.parametrize("name", ["{}", "openai/{}:latest", "replay:/home/me/{}/answers.jsonl"])
def test_no_key_gets_into_a_study_as_a_name(monkeypatch, field, name):
    key = "kEy-13chars!"
    name = name.format(key)
    value = [name] if field == "vlms" else name
    assert StudyConfig.parse({field: value})
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with pytest.raises(DataError) as caught:
        StudyConfig.parse({field: value})
    assert "holds a key" in str(caught.value)
    assert key not in str(caught.value)
    assert StudyConfig.parse({field: ["gpt-4o"] if field == "vlms" else "gpt-4o"})


def test_the_built_in_author_is_no_judge():
    with pytest.raises(DataError, match="judges no answers"):
        StudyConfig.parse({"judge": "builtin"})


@pytest.mark.parametrize("field", ["per_path", "seed", "nodes", "horizon"])
def test_a_truth_value_is_no_number(field):
    with pytest.raises(DataError) as caught:
        StudyConfig(**{field: True})
    assert [issue.path for issue in caught.value.issues] == [field]
    assert StudyConfig(twins=True, chain=True).twins

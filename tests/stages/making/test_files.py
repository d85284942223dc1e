"""Designs are read from whatever holds them; none is dropped in silence, and every fault is told at once."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from oodscen.data._catalogue import Asset
from oodscen.data._designs.prop import Prop
from oodscen.errors import DataError, UsageError
from oodscen.stages._making.files import read_props
from oodscen.testing import example_scene
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.made import WALL

OTHER: dict[str, Any] = {**WALL, "id": "other_wall"}
KERB = (
    'description = "a kerb"\nmass_kg = 90\n'
    'parts = [{ box = [0, 0, 0.2], size = [0.3, 2, 0.4], colour = "grey" }]\n'
)


def ids_in(path: Path) -> list[str]:
    return [prop.id for prop in read_props(path).props]


def faults_in(path: Path, assets: Sequence[Asset] | None = None) -> list[str]:
    with pytest.raises(DataError) as caught:
        read_props(path, assets)
    return [str(issue) for issue in caught.value.issues]


@pytest.fixture
def lines(tmp_path):
    """Return a file with one value per line."""

    def write(*values: dict[str, Any], name: str = "a.jsonl") -> Path:
        path = tmp_path / name
        path.write_text("".join(f"{json.dumps(value)}\n" for value in values))
        return path

    return write


@pytest.mark.parametrize("text", ["a=" + "[" * 5_000 + "]" * 5_000, "x = " + "1" * 5_000, "= 1"])
def test_a_toml_file_that_cannot_be_read_is_one_fault(tmp_path, text):
    path = tmp_path / "a.toml"
    path.write_text(text)
    (fault,) = faults_in(path)
    assert "is not valid TOML" in fault
    assert len(fault) < 200


def test_a_toml_file_names_its_designs_by_their_tables(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(f'[kerb]\n{KERB}\n[kerb_2]\nid = "kerb_2"\n{KERB}')
    assert ids_in(path) == ["kerb", "kerb_2"]
    path.write_text(f'[kerb]\nid = "other"\n{KERB}')
    (fault,) = faults_in(path)
    assert fault.startswith("kerb: ")
    assert "'other'" in fault


@pytest.mark.parametrize("misspelt", ["parts", "id", "description"])
def test_a_line_that_lacks_a_member_is_a_fault_beside_sound_ones(lines, misspelt):
    wrong = {**OTHER, "part": OTHER[misspelt]}
    del wrong[misspelt]
    assert any(
        fault.startswith("line 2") and misspelt in fault for fault in faults_in(lines(WALL, wrong))
    )


def test_every_faulty_design_is_told_with_its_place(lines, tmp_path):
    bad = {"mass_kg": -1}
    first, second = faults_in(lines({**WALL, **bad}, OTHER, {**OTHER, **bad}))
    assert first.startswith("line 1: mass_kg")
    assert second.startswith("line 3: mass_kg")
    (tmp_path / "b.toml").write_text("= 1")
    (tmp_path / "c.json").write_text("{")
    assert [fault.split(":")[0] for fault in faults_in(tmp_path)] == [
        "a.jsonl, line 1",
        "a.jsonl, line 3",
        "b.toml",
        "c.json",
    ]


def test_a_line_that_is_cut_off_is_a_fault_but_in_a_study(tmp_path):
    text = f"{json.dumps(WALL)}\n{json.dumps(OTHER)[:-1]}"
    path = tmp_path / "a.jsonl"
    path.write_text(text)
    assert [fault.split(":")[0] for fault in faults_in(path)] == ["line 2"]
    (tmp_path / "assets.jsonl").write_text(text)
    assert ids_in(tmp_path) == ["low_wall"]


@pytest.mark.parametrize("name", ["scenes.jsonl", "mine.jsonl"])
def test_scenes_give_what_they_carry_and_scenes_without_designs_give_none(lines, name):
    scene = json.loads(example_scene().to_json())
    assert ids_in(lines(scene, {**scene, "made": [WALL, OTHER]}, scene, name=name)) == [
        "low_wall",
        "other_wall",
    ]
    with pytest.raises(UsageError, match="holds no design"):
        read_props(lines(scene, name=name))


def test_a_design_that_is_given_twice_counts_once_and_another_of_its_id_is_refused(lines, tmp_path):
    other = {**WALL, "mass_kg": 55}
    assert read_props(lines(WALL, OTHER, WALL)).props == [Prop.parse(WALL), Prop.parse(OTHER)]
    for first, second in ((WALL, other), (other, WALL)):
        (fault,) = faults_in(lines(first, OTHER, second))
        assert fault == "line 3: id: line 1 holds another design with the id 'low_wall'"
    lines(WALL)
    (tmp_path / "b.json").write_text(json.dumps(other))
    (fault,) = faults_in(tmp_path)
    assert fault == "b.json: id: a.jsonl, line 1 holds another design with the id 'low_wall'"


def test_what_a_catalogue_refuses_is_told_with_all_other_faults(lines, tmp_path):
    taken = {**WALL, "id": "car"}
    unknown = {**OTHER, "parts": [{"asset": "nothing"}]}
    path = lines(taken, WALL, {**WALL, "mass_kg": -1}, unknown)
    (tmp_path / "b.json").write_text(json.dumps({**unknown, "id": "third"}))
    assert [fault.rpartition(": ")[0] for fault in faults_in(tmp_path, FLAT_CATALOGUE.assets)] == [
        "a.jsonl, line 1: id",
        "a.jsonl, line 3: mass_kg",
        "a.jsonl, line 4: parts[0].asset",
        "b.json: parts[0].asset",
    ]
    assert [fault.split(":")[0] for fault in faults_in(path)] == ["line 3"]


def test_things_without_a_design_are_named_once_and_not_if_another_line_has_one(lines):
    unmade = {"id": "odd_thing", "prop": None}
    path = lines(unmade, WALL, unmade, {"id": "low_wall", "prop": None})
    assert read_props(path).unmade == ["odd_thing"]


def test_a_file_that_is_no_text_is_told_with_the_other_faults(tmp_path):
    (tmp_path / "a.json").write_bytes(b"\xff\xfe")
    (tmp_path / "b.json").write_text("{}")
    faults = faults_in(tmp_path)
    assert any(fault.startswith("a.json") and "UTF-8" in fault for fault in faults)
    assert any(fault.startswith("b.json") for fault in faults)

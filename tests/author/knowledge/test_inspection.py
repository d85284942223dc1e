"""A knowledge base as a whole: compared with itself, the recogniser and the catalogues."""

from pathlib import Path

import pytest

from oodscen._doctor import examine_knowledge
from oodscen._registry import make_catalogue
from oodscen.author._knowledge.inspection import inspect_knowledge
from oodscen.testing._flat import FlatSimulator

FLAT = {"flat": FlatSimulator().catalogue()}
PIANO = """
[[hazard]]
id = "grand-piano"
class = "environmental"
family = "Musical instruments on the road"
label = "Grand piano on the road"
words = ["piano"]
places = ["residential", "urban"]
conditions = ["clear"]
events = [
  "A grand piano stands in the ego's lane {where}",
  "A black concert piano blocks the way of the ego vehicle {where}",
  "Somebody has left a piano on three legs in the middle of the lane {where}",
  "The ego's lane is taken up {where} by a piano with its lid open",
  "Movers have put down a piano in front of the ego vehicle and gone",
]
ordinary = "the lane ahead is free"
needs = { assets = ["rock"] }
[hazard.stage]
speed = [8.5, 11.5]
decision = { kind = "distance", value = [29.0, 34.0] }
actors = [{ id = "piano", asset = "cardboard_box", ahead = [55.0, 72.0], lane = 0, parameters = {} }]
"""


def inspected(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "own.toml"
    path.write_text(text)
    return [str(fault) for fault in inspect_knowledge(path, FLAT).faults]


def test_the_shipped_knowledge_has_no_fault() -> None:
    found = inspect_knowledge(None, {"pybullet": make_catalogue("pybullet")})
    assert found.faults == ()
    assert (found.hazards >= 220, found.families >= 30, found.recipes >= 90) == (True,) * 3


def test_a_sound_file_is_counted_and_tried(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(PIANO)
    found = inspect_knowledge(path, FLAT)
    assert found.faults == ()
    assert (found.hazards, found.recipes, found.shown) == (1, 1, {"flat": 1})


WORDS = {
    '"piano"]': ('"piano", "Piano"]', "words[1]: 'Piano' occurs twice"),
    "A black concert piano blocks the way of the ego vehicle": (
        "A grand piano is standing in the ego's lane",
        "events[1]: shares",
    ),
    "Movers have put down a piano in front of the ego vehicle and gone": (
        "A large cardboard box lies in the middle of the ego's lane {where}",
        "reads like 'cardboard-box'",
    ),
    'ordinary = "the lane ahead is free"': ('ordinary = "free"', "ordinary: say"),
    '["rock"]': ('["cardbord_box"]', "did you mean cardboard_box?"),
}
"""Faults of the words of `PIANO`: what is replaced by what, and what is told of it."""


@pytest.mark.parametrize(
    "faulty",
    [
        WORDS,
        {"parameters = {}": ('behaviour = "stand_stil"', "stage.actors: a behaviour: stand stil")},
        {"parameters = {}": ('behaviour = "bolt"', "cardboard_box is object")},
        {
            "parameters = {}": (
                "parameters = { speed = 3.0 }",
                "stand has no parameter 'speed'",
            )
        },
        {
            "parameters = {}": (
                'behaviour = "cross_road", parameters = { speed = 300.0 }',
                "parameters.speed: outside",
            )
        },
        {"parameters = {}": ('state = "open"', "cardboard_box has no 'open'")},
        {
            "parameters = {} }": (
                'offset = 0.0 }, { id = "second", asset = "rock", at = "piano", ahead = 0.0 }',
                "stage: on flat: actors",
            )
        },
    ],
)
def test_every_fault_is_named_with_its_line_and_hazard(
    tmp_path: Path, faulty: dict[str, tuple[str, str]]
) -> None:
    text = PIANO
    for old, (new, _) in faulty.items():
        assert old in text
        text = text.replace(old, new)
    faults = inspected(tmp_path, text)
    for _, message in faulty.values():
        assert any(message in fault for fault in faults), faults
    assert all(fault.startswith("own.toml:2: hazard[0] grand-piano: ") for fault in faults)


@pytest.mark.parametrize(
    ("old", "new", "broken"),
    [
        ('class = "environmental"', 'class = "odd"', "class"),
        ('ordinary = "the lane ahead is free"\n', "", "ordinary"),
        ('conditions = ["clear"]', "conditions = [3]", "conditions[0]"),
        ("  \"The ego's lane is taken", "  3, \"The ego's lane is taken", "events[3]"),
        ('["rock"] }', '["cardbord_box"], x = 1 }', "needs.x"),
        ("lane = 0, ", 'lane = 0, colour = "red", ', "stage.actors[0].colour"),
        (
            PIANO.splitlines()[1],
            '[surprise]\nx = 1\n[[harp]]\n[[hazard]]\nid = "x"\n[[hazard]]',
            "",
        ),
    ],
)
def test_a_fault_of_form_hides_no_other_fault(
    tmp_path: Path, old: str, new: str, broken: str
) -> None:
    text = (
        PIANO.replace('"urban"]', '"nowhere"]')
        .replace("A black concert piano blocks the way of", "A grand piano stands in")
        .replace("[hazard.stage]", "[hazard.stage]\nhorizon = 8.0")
        .replace('state = "open"', "")
        .replace("parameters = {}", 'state = "open"')
    )
    if '["rock"]' not in old:
        text = text.replace('["rock"]', '["cardbord_box"]')
    assert old in text
    faults = "\n".join(inspected(tmp_path, text.replace(old, new, 1)))
    assert f"grand-piano: {broken}: " in faults or not broken
    for known in (
        "places[1]: unknown place 'nowhere'",
        "did you mean cardboard_box?",
        "cardboard_box has no 'open'",
    ):
        assert known in faults, known


def test_what_no_catalogue_has_is_a_note(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(PIANO.replace('["rock"]', '["harpsichord"]'))
    found = inspect_knowledge(path, FLAT)
    assert found.faults == ()
    assert {note.path for note in found.notes} == {"an asset: harpsichord", "harpsichord"}


@pytest.mark.parametrize("text", ["[[hazard", "\xff", '[[hazard]]\nid = "x"\n'])
def test_a_file_that_cannot_be_used_is_told_and_nothing_raised(tmp_path: Path, text: str) -> None:
    path = tmp_path / "own.toml"
    path.write_bytes(text.encode("latin-1"))
    findings = examine_knowledge(path)
    assert findings
    assert not any(finding.is_ok for finding in findings)


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    (finding,) = examine_knowledge(tmp_path / "nowhere.toml")
    assert not finding.is_ok
    assert "nowhere.toml" in finding.detail

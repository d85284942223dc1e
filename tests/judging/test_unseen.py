"""Answers that were written down, with what they say, by somebody who had not seen the reader.

`unseen.jsonl` holds them: the question, the answer, and the readings that pass (`null`: none can be read).
"""

import json
from pathlib import Path
from typing import Any

import pytest

from oodscen.episode import ACTIONS
from oodscen.judging.answers import read_action, read_aspect, read_choice, read_description
from oodscen.judging.reading import Reading

ROWS = [
    json.loads(line)
    for line in Path(__file__).with_name("unseen.jsonl").read_text("utf-8").splitlines()
]
LABELS = (
    "Deer running onto the road",
    "Large group of people on the road (parade, protest)",
    "Nothing is out of the ordinary",
    "Thick fog at night with a vehicle ahead",
    "Overturned vehicle ahead in the lane",
    "Large cardboard box on the road",
    "Sudden police checkpoint",
    "Dog running onto the road",
    "Heavy snowfall covering the road",
    "Fallen tree or large branch on the road",
    "Vehicle in a neighbouring lane cutting in",
    "Pedestrian crossing where no crossing is expected",
)
OPTIONS = {
    "none" if label.startswith("Nothing") else f"leaf{number}": label
    for number, label in enumerate(LABELS, start=1)
}
READERS = {
    "action": lambda said: read_action(said, ACTIONS),
    "aspect": read_aspect,
    "choice": lambda said: read_choice(said, OPTIONS),
    "description": read_description,
}
KNOWN_MISSES = frozenset(
    {
        "Brake gently, then continue.",
        "I'm 60% sure that slow_down is right and 40% that change_lane_left is.",
        "Definitely unusual! \U0001f98c A deer is jumping in front of us.",
        "The most important thing for the driver is the crowd of protesters blocking the street, "
        "which is certainly not ordinary.",
        "\u0427\u0442\u043e-\u0442\u043e \u043d\u0435\u043e\u0431\u044b\u0447\u043d\u043e\u0435: "
        "\u0441\u043e\u0431\u0430\u043a\u0430 \u043d\u0430 \u0434\u043e\u0440\u043e\u0433\u0435. "
        "\u0423\u0432\u0435\u0440\u0435\u043d\u043d\u043e\u0441\u0442\u044c 0.8",
    }
)
"""What is still read otherwise than a person would."""


def said(reading: Reading[Any], question: str) -> Any:
    if reading.outcome == "refused":
        return "refused"
    if question == "choice" and reading.value is not None:
        return 1 + list(OPTIONS).index(reading.value)
    return reading.value


def agrees(found: Any, expected: Any, question: str) -> bool:
    if isinstance(expected, dict) and not isinstance(found, (str, type(None))):
        least, most = expected.get("confidence", (0.0, 1.0))
        sure = found.confidence if "confidence" in expected else 0.5
        return (
            found.is_ood is expected["is_ood"]
            and sure is not None
            and least - 1e-9 <= sure <= most + 1e-9
            and expected.get("aspect", "").lower().replace("-", " ") in found.aspect.lower()
        )
    if question == "description" and expected not in (None, "refused"):
        return isinstance(found, str) and expected in found
    return bool(found == expected)


@pytest.mark.parametrize("question", READERS)
def test_answers_are_read_as_a_person_would(question: str) -> None:
    rows = [row for row in ROWS if row["question"] == question]
    missed = {}
    for row in rows:
        found = said(READERS[question](row["said"]), question)
        if not any(agrees(found, expected, question) for expected in row["expected"]):
            missed[row["said"]] = (found, row["expected"])
    assert {text: why for text, why in missed.items() if text not in KNOWN_MISSES} == {}
    assert {text for text in KNOWN_MISSES if text in {row["said"] for row in rows}} <= set(missed)


def test_there_are_many() -> None:
    assert len(ROWS) >= 700

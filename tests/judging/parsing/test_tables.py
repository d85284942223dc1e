"""Tables of answers: none is read as what it does not say; JSON and plain English are read.

`shapes.py` holds shapes as models give them, `unseen.jsonl` answers that were written down by somebody who had not
seen a reader (`expected`: the readings that pass), `hostile.py` answers that invite a wrong reading.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from oodscen.data._episode import ACTIONS
from oodscen.judging._parsing import (
    ParsedAnswer,
    read_action,
    read_aspect,
    read_choice,
    read_description,
)
from tests.judging.parsing import hostile, shapes, wrappers
from tests.judging.parsing.shapes import LEAVES, REFUSED

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
OPTIONS = {str(number): label for number, label in enumerate(LABELS, start=1)}
READERS = {
    "action": lambda said: read_action(said, ACTIONS),
    "aspect": read_aspect,
    "choice": lambda said: read_choice(said, OPTIONS),
    "description": read_description,
    "leaf": lambda said: read_choice(said, LEAVES),
}


def rows() -> Iterator[tuple[str, str, list[Any]]]:
    """Yield question, answer, and what may be read in it."""
    for said, meant in (*shapes.ACTIONS_SAID, *hostile.ACTIONS_SAID):
        yield "action", said, [meant]
    for said, meant in (*shapes.CHOICES_SAID, *hostile.CHOICES_SAID):
        yield "leaf", said, [meant]
    for said, is_ood, aspect, confidence in shapes.DETECTIONS_SAID:
        given = {} if confidence is None else {"confidence": [confidence, confidence]}
        found = {"is_ood": is_ood, "aspect": aspect, **given}
        yield "aspect", said, [found if isinstance(is_ood, bool) else is_ood]
    for said, is_ood in hostile.DETECTIONS_SAID:
        yield "aspect", said, [None if is_ood is None else {"is_ood": is_ood}]
    for line in Path(__file__).with_name("unseen.jsonl").read_text("utf-8").splitlines():
        row = json.loads(line)
        numbers = row["question"] == "choice"
        meant = [str(m) if numbers and isinstance(m, int) else m for m in row["expected"]]
        yield row["question"], row["said"], meant


ROWS = list(dict.fromkeys((q, said, json.dumps(meant)) for q, said, meant in rows()))


def outcome(reading: ParsedAnswer[Any], question: str, expected: list[Any]) -> str:
    """Return `right`, `not read` or `wrong`."""
    if reading.outcome == "refused":
        return "right" if REFUSED in expected else "not read"
    if reading.value is None:
        return "right" if None in expected else "not read"
    return "right" if any(agrees(reading.value, one, question) for one in expected) else "wrong"


def agrees(found: Any, expected: Any, question: str) -> bool:
    if expected in (None, REFUSED):
        return False
    if question == "description":
        return expected in found
    if question != "aspect":
        return bool(found == expected)
    least, most = expected.get("confidence", (0.0, 1.0))
    named = expected.get("aspect", "").lower().replace("-", " ")
    return (
        found.is_ood is expected["is_ood"]
        and (found.confidence is None or least - 1e-9 <= found.confidence <= most + 1e-9)
        and (not found.aspect or named in found.aspect.lower().replace("-", " "))
    )


def judged(question: str) -> dict[str, str]:
    return {
        said: outcome(READERS[question](said), question, json.loads(meant))
        for asked, said, meant in ROWS
        if asked == question
    }


@pytest.mark.parametrize("question", READERS)
def test_no_answer_is_read_as_what_it_does_not_say(question):
    assert [said for said, found in judged(question).items() if found == "wrong"] == []


UNREAD_JSON = {
    "action": {
        # marks that the question does not give
        '{"answer": "3"}',
        '{"action": 4}',
        '{"choice": "B"}',
        "Final Answer: The final answer is $\\boxed{4}$",
        # no member that was asked for
        '{"stop": 0.7, "slow_down": 0.2, "keep_speed": 0.1}',
        '{"keep_speed": false, "pull_over": true}',
        '{"reasoning" = "x", "action" = "stop"}',
        '{"name": "choose_action", "arguments": "{\\"action\\": \\"pull_over\\"}"}',
        # another option after it
        '{"reasoning": "stop", "action": "slow_down"} Note: "stop" would also work.',
        # words, elements or lists around it
        '[{"action": "stop", "reasoning": "..."}]',
        '// my answer\n{"action": "stop" /* safest */}',
        '<tool_call>{"name": "answer", "arguments": {"reasoning": "x", "action": "stop"}}</tool_call>',
        '<tool_call>\n{"name": "choose_action", "arguments": {"action": "change_lane_left"}}\n</tool_call>',
        # members that nobody asked for
        '{"action": "stop", "alternative": "pull_over"}',
        '{"name": "choose_action", "arguments": {"action": "pull_over"}}',
    },
    "leaf": {'{"answer": "tree"}'},
    "choice": {
        '{"choice": "fallen tree"}',
        '{"choice": 08}',
        '{"result": {"option_number": 11, "option_text": "Vehicle in a neighbouring lane cutting in"}}',
    },
}
"""Answers with an object that ends and are asked for once more all the same."""


def test_a_reason_that_is_no_text_is_named_and_not_called_unasked():
    found = read_action('{"reasoning": 1, "action": "stop"}', ACTIONS)
    assert (found.value, found.note) == (None, "'reasoning' is no text")


@pytest.mark.parametrize("question", READERS)
def test_json_is_read(question):
    unread = {
        said
        for said, found in judged(question).items()
        if re.search(r'{\s*"', said)
        and found == "not read"
        and said.count("{") == said.count("}")
        and "JSON objects" not in READERS[question](said).note
        and said not in {one for one, *_ in (*hostile.ACTIONS_SAID, *hostile.CHOICES_SAID, *hostile.DETECTIONS_SAID)}
        and '": 0.' not in said
    }  # fmt: skip
    assert unread - UNREAD_JSON.get(question, set()) == set()


@pytest.mark.parametrize(
    ("question", "least"),
    [("action", 0.5), ("choice", 0.5), ("aspect", 0.4), ("description", 0.9)],
)
def test_most_prose_is_read(question, least):
    found = [result for said, result in judged(question).items() if "{" not in said]
    assert found.count("right") / len(found) >= least


PLAIN = [
    "{}",
    "{}.",
    "**{}**",
    "`{}`",
    "- {}",
    "Answer: {}",
    "**Action:** {}",
    "Final answer: {}.",
    "The answer is {}.",
    "My choice is {}.",
    "I choose {}.",
    "I would choose {} here.",
    "I would {}.",
    "I'd {}, because the lane is blocked.",
    "The ego vehicle should {} to avoid a collision.",
    "The safest action is to {}.",
    "The best action is {}, since there is no room elsewhere.",
    "{} is the safest choice.",
    "So: {}",
    "The lane ahead is blocked by a box. Therefore, I would {}.",
    "The lane ahead is blocked, so I would {}.",
    "The lane ahead is blocked.\n\n{}",
    "{}\n\nThe lane ahead is blocked.",
    "Reasoning: one could brake or turn.\nAction: {}",
    "Action: {}\nReason: nothing else is possible, but this is not ideal either.",
    "<answer>{}</answer>",
    "\\boxed{{{}}}",
    "<think>Hmm.</think>{}",
    "We should {} now.",
    "Let's {}.",
]


@pytest.mark.parametrize("form", PLAIN)
@pytest.mark.parametrize("action", ACTIONS)
def test_plain_english_is_read(form, action):
    for name in (action, action.replace("_", " "), action.upper()):
        assert read_action(form.format(name), ACTIONS).value == action


MIRRORED = {
    "left": "right",
    "right": "left",
    "Left": "Right",
    "Right": "Left",
    "LEFT": "RIGHT",
    "RIGHT": "LEFT",
}
ONE_SIDED = re.compile(r"pull|shoulder|edge|oncoming|the right thing", re.IGNORECASE)
"""Matches words of the roadside, which is on the right, of the oncoming lane, and of what is right."""


def mirrored(said: str) -> str:
    """Return an answer with left for right and right for left."""
    return re.sub("|".join(MIRRORED), lambda side: MIRRORED[side[0]], said)


def test_left_and_right_are_read_alike():
    sided = [said for question, said, _ in ROWS if question == "action" and mirrored(said) != said]
    assert len(sided) > 100
    for said in sided:
        if not ONE_SIDED.search(said):
            found, other = (read_action(one).value for one in (said, mirrored(said)))
            assert other == mirrored(found or "") or not (found or other), said


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    "verb",
    ["Move", "Move over", "Change", "I would move", "Merge", "The safest action is to move"],
)
@pytest.mark.parametrize(
    "where",
    [
        "{}",
        "to the {}",
        "to the {} lane",
        "into the {} lane",
        "to the {}-hand lane",
        "to the next lane on the {}",
    ],
)
def test_moving_to_a_side_changes_the_lane(verb: str, where: str, side: str) -> None:
    for reason in ("", f" because the {MIRRORED[side]} lane is blocked"):
        assert read_action(f"{verb} {where.format(side)}{reason}.").value == f"change_lane_{side}"


@pytest.mark.parametrize(
    ("said", "action"),
    [
        ("Slow down and pull over.", "pull_over"),
        ("Move onto the right shoulder.", "pull_over"),
        ("Pull over to the right.", "pull_over"),
        ("Stop on the right.", "pull_over"),
        ("Stop on the right lane.", None),
        ("Slow down to a stop.", "stop"),
        ("Slow to a halt", "stop"),
        ("Bring the vehicle to a complete stop.", "stop"),
        ("Apply the brakes fully.", "emergency_brake"),
    ],
)
def test_where_and_how_to_stop(said: str, action: str | None) -> None:
    assert read_action(said).value == action


def test_what_is_not_listed_is_not_read():
    said = wrappers.hostile()
    assert len(said) >= 500
    assert [one for one in said if read_action(one, ACTIONS).value is not None] == []


def test_what_models_plainly_say_is_read():
    said = wrappers.friendly()
    assert len(said) >= 100
    assert [one for one in said if read_action(one, ACTIONS).value != "stop"] == []


def test_there_are_many():
    hostile_ones = {said for said, _ in (*hostile.ACTIONS_SAID, *hostile.CHOICES_SAID)}
    assert len(ROWS) >= 1_500
    assert len(hostile_ones) >= 200

"""Read what a model answered as a person would, also where it is not the JSON that was asked for.

Every reader takes a model's words and says what was answered, and how that was found out. It never
raises, and it never guesses: two different answers, or none, are `unparsed` and not wrong.
"""

import re
from collections.abc import Mapping, Sequence

from oodscen.judging.choosing import Question
from oodscen.judging.descriptions import read_description
from oodscen.judging.detection import Detected, read_aspect
from oodscen.judging.meaning import meaning
from oodscen.judging.patterns import compiled
from oodscen.judging.reading import LONGEST, TWO_ANSWERS, Reading, is_refusal, tail
from oodscen.judging.resembling import resembled
from oodscen.judging.settling import settled
from oodscen.judging.wording import Mention, find_actions, longest, normalise
from oodscen.judging.yes_or_no import says_usual
from oodscen.verdict import NOTHING

__all__ = [
    "TWO_ANSWERS",
    "Detected",
    "Reading",
    "contradiction",
    "is_refusal",
    "read_action",
    "read_aspect",
    "read_choice",
    "read_description",
]

# ------------------------------------------------------------------ actions


def read_action(text: str, offered: Sequence[str]) -> Reading[str]:
    """Read which of the offered actions was chosen.

    Args:
        text: A model's words.
        offered: Action ids in the order in which they were offered, so that "3" and "C" count.
    """
    return Question(offered, lambda plain: find_actions(plain, offered), _ACTION_KEYS).read(text)


_GENERAL_KEYS = (
    "choice",
    "decision",
    "selection",
    "selected",
    "chosen",
    "option",
    "id",
    "response",
    "result",
    "output",
    "recommendation",
)
_KEYS_OF_ACTIONS = (
    "action",
    "chosen_action",
    "selected_action",
    "final_action",
    "best_action",
    "action_id",
)
_ACTION_KEYS = (*_KEYS_OF_ACTIONS, "answer", "final_answer", *_GENERAL_KEYS)
"""Members of an object that may hold an action, the likeliest first."""


def contradiction(reasoning: str, action: str, offered: Sequence[str]) -> str:
    """Say where a chain of thought settles on another action than the answer; empty where not."""
    if not reasoning.strip() or len(reasoning) > LONGEST:
        return ""
    plain = normalise(tail(reasoning))
    meant = [meaning(plain, mention) for mention in find_actions(plain, offered)]
    settled_on = settled(plain, meant, least=1)
    if settled_on and settled_on != action:
        return f"the reasoning settles on {settled_on}, the answer is {action}"
    levels = [one.level for one in meant if one.mention.option == action]
    if -2 in levels and max(levels) < 0:
        return f"the reasoning rejects {action}, which is the answer"
    return ""


# ------------------------------------------------------------------ options of the closed question


def read_choice(text: str, labels: Mapping[str, str]) -> Reading[str]:
    """Read which option of the closed question was chosen.

    Args:
        text: A model's words.
        labels: Text of every option by id, in the order in which they were offered.
    """
    finders = {name: _finder(name, label) for name, label in labels.items()}

    def find(part: str) -> list[Mention]:
        found = []
        for name, finder in finders.items():
            found += [Mention(m.start(), m.end(), name) for m in finder.finditer(part)]
        return longest(found)

    def resembling(part: str) -> Reading[str] | None:
        if _NO_OPTION.search(part):
            return None
        if NOTHING in labels and says_usual(part):
            return Reading(NOTHING, "answered", "prose: nothing is unusual")
        found = resembled(part, labels)
        return Reading(found[0], "answered", f"prose: {found[1]}") if found else None

    return Question(list(labels), find, _CHOICE_KEYS, resembling, is_numbered=True).read(text)


def _finder(name: str, label: str) -> re.Pattern[str]:
    """Return what finds an option by its label, or by its id; but "none" may deny all options."""
    texts = [label] if name == NOTHING else [label, name]
    words = sorted({normalise(text) for text in texts if text}, key=len, reverse=True)
    return re.compile("|".join(rf"(?<!\w){re.escape(one)}(?!\w)" for one in words))


_CHOICE_KEYS = (
    "choice",
    "answer",
    "final_answer",
    "option",
    "number",
    "label",
    *_KEYS_OF_ACTIONS,
    *_GENERAL_KEYS[1:],
)
"""Members of an object that may hold an option, the likeliest first."""

_NO_OPTION = compiled(
    r"\bnone of (?:the|these|those|them)(?: (?:above|options?))?\W*$",
    r"\bnone fits?\b",
)

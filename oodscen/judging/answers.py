"""Read what a model answered as a person would, also where it is not the JSON that was asked for.

Every reader takes a model's words and says what was answered, and how that was found out. It never
raises, and it never guesses: two different answers, or none, are `unparsed` and not wrong.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Any

from oodscen.judging.detection import Detected, read_aspect, read_description, read_usual
from oodscen.judging.echoes import without_echo
from oodscen.judging.marks import NOT_OFFERED, Finder, find_marks, own_list
from oodscen.judging.matching import affirmed_words, telling_words
from oodscen.judging.reading import (
    LONGEST,
    TWO_ANSWERS,
    Reading,
    is_refusal,
    member,
    tail,
    told,
    too_long,
)
from oodscen.judging.settling import settled
from oodscen.judging.wording import (
    CROSS,
    TICK,
    Mention,
    find_actions,
    longest,
    meaning,
    normalise,
)
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


def read_action(text: str, offered: Sequence[str]) -> Reading[str]:
    """Read which of the offered actions was chosen.

    Args:
        text: A model's words.
        offered: Action ids in the order in which they were offered, so that "3" and "C" count.
    """
    return _Question(offered, lambda plain: find_actions(plain, offered), _ACTION_KEYS).read(text)


def read_choice(text: str, labels: Mapping[str, str]) -> Reading[str]:
    """Read which option of the closed question was chosen.

    Args:
        text: A model's words.
        labels: Text of every option by id, in the order in which they were offered.
    """
    named = {
        name: re.compile(
            "|".join(_as_words(text) for text in {label, _unless_nothing(name)} if text)
        )
        for name, label in labels.items()
    }

    def find(part: str) -> list[Mention]:
        found = []
        for name, pattern in named.items():
            found += [Mention(m.start(), m.end(), name) for m in pattern.finditer(part)]
        return longest(found)

    def resembling(part: str) -> Reading[str] | None:
        if _NO_OPTION.search(part):
            return None
        if NOTHING in labels and read_usual(part):
            return Reading(NOTHING, "answered", "prose: nothing is unusual")
        return _resembling(part, labels)

    return _Question(list(labels), find, _CHOICE_KEYS, resembling, is_numbered=True).read(text)


def contradiction(reasoning: str, action: str, offered: Sequence[str]) -> str:
    """Say where a chain of thought settles on another action than the answer; empty where not."""
    if not reasoning.strip() or len(reasoning) > LONGEST:
        return ""
    plain = normalise(tail(reasoning))
    meant = [meaning(plain, mention) for mention in find_actions(plain, offered)]
    rejected = {one.mention.option for one in meant if one.level == -2}
    settled_on = settled(plain, meant, least=1)
    if settled_on and settled_on != action:
        return f"the reasoning settles on {settled_on}, the answer is {action}"
    affirmed = {one.mention.option for one in meant if one.level >= 0}
    if action in rejected and action not in affirmed:
        return f"the reasoning rejects {action}, which is the answer"
    return ""


# ------------------------------------------------------------------ one of several options

_ACTION_KEYS = (
    "action",
    "chosen_action",
    "selected_action",
    "final_action",
    "best_action",
    "action_id",
    "answer",
    "final_answer",
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
_CHOICE_KEYS = (
    "choice",
    "answer",
    "final_answer",
    "option",
    "number",
    "label",
    *_ACTION_KEYS[:6],
    *_ACTION_KEYS[9:],
)
_SOME_KEY = re.compile(r"option|choice|answer|action|decision", re.IGNORECASE)
_NO_OPTION = re.compile(
    r"\bnone\s+of\s+(?:the|these|those|them)(?:\s+(?:above|options?))?\W*$|\bnone\s+fits?\b"
)


@dataclass(frozen=True)
class _Question:
    """What is asked for: one of several options."""

    offered: Sequence[str]
    """Ids, in the order in which they were offered."""
    find: Finder
    """Finds where a normalised text names them."""
    keys: Sequence[str]
    """Members of an object that may hold the answer."""
    resort: Callable[[str], Reading[str] | None] = lambda plain: None
    """Looks at a text that names none of them."""
    is_numbered: bool = False
    """Whether they were offered with numbers, so that a number can contradict a name."""

    def read(self, text: str) -> Reading[str]:
        """Read what a model said."""
        if len(text) > LONGEST:
            return too_long(text)
        given = told(text, self._in_object, self.keys)
        if given.is_disputed:
            return Reading(None, "unparsed", f"{TWO_ANSWERS}, each in JSON")
        if given.value:
            later = self._in_prose(given.corrected) if given.corrected else None
            return later if later and later.value else Reading(given.value, "answered", "JSON")
        reading = _none_of_them() if given.is_void else self._in_words(tail(text))
        is_open = reading.outcome == "unparsed" and not reading.note.startswith(TWO_ANSWERS)
        if is_open and is_refusal(text):
            return Reading(None, "refused", "a refusal")
        return reading

    def _in_words(self, said: str) -> Reading[str]:
        plain = normalise(said)
        answer = without_echo(plain, self.find, len(self.offered))
        if not answer.strip():
            return Reading(None, "unparsed", "nothing but the question" if plain else "no answer")
        lines = plain.split("\n")
        ticked = [line for line in lines if re.search(TICK, line)]
        if len(ticked) == 1 and any(re.search(CROSS, line) for line in lines if line != ticked[0]):
            answer = " ".join(re.split(rf"{TICK}|\W{{2,}}", ticked[0]))
        return self._in_prose(answer, own_list(plain, self.find))

    def _in_object(self, value: Mapping[str, Any], further: Sequence[str] = ()) -> str | None:
        for key in (*self.keys, *further):
            found = member(value, (key,))
            if isinstance(found, (list, tuple)) and len(found) == 1:
                found = found[0]
            if isinstance(found, dict):
                inner = None if further else self._in_object(found, ("name", "value"))
                if inner:
                    return inner
            if isinstance(found, (int, float)) and not isinstance(found, bool):
                count = len(self.offered)
                return self.offered[int(found) - 1] if found in range(1, count + 1) else None
            if isinstance(found, str):
                reading = self._in_prose(normalise(found))
                if reading.value:
                    return reading.value
        return self._by_key(value) or self._heaviest(value)

    def _by_key(self, value: Mapping[str, Any]) -> str | None:
        """Return what an object says under a key of its own, e.g. `option_number`."""
        for key, said in value.items():
            if _SOME_KEY.search(key) and isinstance(said, (str, int)):
                found = self._in_prose(normalise(str(said))).value
                if found:
                    return found
        return None

    def _heaviest(self, value: Mapping[str, Any]) -> str | None:
        """Return the option of most weight, in an object that gives each a weight."""
        weights = {
            name: float(weight)
            for name in self.offered
            if isinstance(weight := member(value, (name,)), (int, float))
        }
        best = [name for name, weight in weights.items() if weight == max(weights.values())]
        return best[0] if len(weights) > 1 and len(best) == 1 else None

    def _in_prose(self, plain: str, own: Mapping[str, str] | None = None) -> Reading[str]:
        """Read normalised words; `own` says what the marks in a list of their own stand for."""
        named = self.find(plain)
        marks = find_marks(plain, self.offered, self.find, own or {})
        if not self.is_numbered:
            marks = [mark for mark in marks if not _marks_a_name(plain, mark, named)]
        mentions = longest([*named, *marks])
        if not mentions:
            whole = plain.strip(" .,;:!?()[]{}'\n")
            near = _misspelt(whole, self.offered) if len(whole) <= 30 else None
            if near:
                return Reading(near, "answered", "misspelt")
            return self.resort(plain) or Reading(None, "unparsed", "no option is named")
        meant = [meaning(plain, mention) for mention in mentions]
        settled_on = settled(plain, meant)
        if settled_on == NOT_OFFERED:
            return _none_of_them()
        if settled_on:
            return Reading(settled_on, "answered", f"prose: {_LEVELS[max(m.level for m in meant)]}")
        left = {one.mention.option for one in meant if one.level > -2}
        if not left:
            rejected = Reading[str](None, "unparsed", "every option it names is rejected")
            return self.resort(plain) or rejected
        return Reading(None, "unparsed", f"{TWO_ANSWERS}: {', '.join(sorted(left))}")


def _marks_a_name(plain: str, mark: Mention, named: Sequence[Mention]) -> bool:
    """Whether a mark only begins a line or a phrase that goes on with a name: "2. stop"."""
    return any(
        mark.end <= one.start <= mark.end + 4 and not re.search(r"\w", plain[mark.end : one.start])
        for one in named
    )


def _none_of_them() -> Reading[str]:
    return Reading(None, "unparsed", "it is none of the options")


_LEVELS = {3: "given", 2: "chosen", 1: "concluded", 0: "named", -1: "considered", -2: "rejected"}


def _misspelt(whole: str, offered: Sequence[str]) -> str | None:
    scores = sorted(
        ((SequenceMatcher(None, whole, normalise(name)).ratio(), name) for name in offered),
        reverse=True,
    )
    is_clear = len(scores) < 2 or scores[0][0] - scores[1][0] > 0.1
    return scores[0][1] if scores and scores[0][0] >= 0.8 and is_clear else None


def _as_words(text: str) -> str:
    return rf"(?<!\w){re.escape(normalise(text))}(?!\w)"


def _unless_nothing(name: str) -> str:
    """The id of an option is as good as its label, but "none" also says that none is right."""
    return "" if name == NOTHING else name


def _begins_one(word: str, words: set[str]) -> bool:
    return word in words or any(len(word) > 3 and one.startswith(word) for one in words)


def _resembling(text: str, labels: Mapping[str, str]) -> Reading[str] | None:
    """Return the one option whose telling words a short answer has, all or most of them."""
    words = affirmed_words(text)
    if not words:
        return None
    own = {name: telling_words(label) for name, label in labels.items()}
    holding = [name for name, label in own.items() if all(_begins_one(w, label) for w in words)]
    if len(holding) == 1:
        return Reading(holding[0], "answered", "prose: words of the label")
    shared = [name for name, label in own.items() if 2 * len(label & words) >= len(label) > 0]
    if len(shared) == 1:
        return Reading(shared[0], "answered", "prose: words of the label")
    scores = sorted(
        ((len(label & words) / len(label | words), name) for name, label in own.items() if label),
        reverse=True,
    )
    if scores and scores[0][0] >= 0.6 and (len(scores) < 2 or scores[1][0] < scores[0][0]):
        return Reading(scores[0][1], "answered", "prose: most words of the label")
    return None

"""Read which of several options was chosen, in an object, by a mark, or in words."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen.judging.echoes import without_echo
from oodscen.judging.marks import NOT_OFFERED, Finder, find_marks, own_list
from oodscen.judging.meaning import CROSS, TICK, meaning
from oodscen.judging.reading import (
    LONGEST,
    TWO_ANSWERS,
    Reading,
    disputed,
    is_refusal,
    member,
    tail,
    told,
    too_long,
)
from oodscen.judging.resembling import misspelt
from oodscen.judging.settling import settled
from oodscen.judging.wording import Mention, longest, normalise


@dataclass(frozen=True)
class Question:
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
            return disputed()
        if given.value:
            later = self._in_words(given.corrected) if given.corrected else None
            return later if later and later.value else Reading(given.value, "answered", "JSON")
        reading = _none_of_them() if given.is_void else self._in_prose(tail(text))
        is_open = reading.outcome == "unparsed" and not reading.note.startswith(TWO_ANSWERS)
        if is_open and is_refusal(text):
            return Reading(None, "refused", "a refusal")
        return reading

    # -------------------------------------------------------------- in an object

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
                is_offered = found in range(1, len(self.offered) + 1)
                return self.offered[int(found) - 1] if is_offered else None
            if isinstance(found, str) and (chosen := self._in_words(normalise(found)).value):
                return chosen
        return self._by_key(value) or self._heaviest(value)

    def _by_key(self, value: Mapping[str, Any]) -> str | None:
        """Return what an object says under a key of its own, e.g. `option_number`."""
        for key, said in value.items():
            if _SOME_KEY.search(key) and isinstance(said, (str, int)):
                found = self._in_words(normalise(str(said))).value
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

    # -------------------------------------------------------------- in words

    def _in_prose(self, said: str) -> Reading[str]:
        """Read what was said after the thinking, without what it repeats of the question."""
        plain = normalise(said)
        answer = without_echo(plain, self.find, len(self.offered))
        if not answer.strip():
            return Reading(None, "unparsed", "nothing but the question" if plain else "no answer")
        return self._in_words(_ticked(plain) or answer, own_list(plain, self.find))

    def _in_words(self, plain: str, own: Mapping[str, str] | None = None) -> Reading[str]:
        """Read normalised words; `own` says what the marks in a list of their own stand for."""
        mentions = self._mentions(plain, own or {})
        if not mentions:
            if near := misspelt(plain, self.offered):
                return Reading(near, "answered", "misspelt")
            return self.resort(plain) or Reading(None, "unparsed", "no option is named")
        meant = [meaning(plain, mention) for mention in mentions]
        settled_on = settled(plain, meant)
        if settled_on == NOT_OFFERED:
            return _none_of_them()
        if settled_on:
            return Reading(settled_on, "answered", f"prose: {_LEVELS[max(m.level for m in meant)]}")
        left = {one.mention.option or "another" for one in meant if one.level > -2}
        if left:
            return Reading(None, "unparsed", f"{TWO_ANSWERS}: {', '.join(sorted(left))}")
        rejected = Reading[str](None, "unparsed", "every option it names is rejected")
        return self.resort(plain) or rejected

    def _mentions(self, plain: str, own: Mapping[str, str]) -> list[Mention]:
        """Return where options are named or marked, the longest where they overlap."""
        named = self.find(plain)
        marks = find_marks(plain, self.offered, self.find, own)
        if not self.is_numbered:
            marks = [mark for mark in marks if not _marks_a_name(plain, mark, named)]
        return longest([*named, *marks])


_SOME_KEY = re.compile(r"option|choice|answer|action|decision", re.IGNORECASE)

_LEVELS = {3: "given", 2: "chosen", 1: "concluded", 0: "named", -1: "considered", -2: "rejected"}


def _none_of_them() -> Reading[str]:
    return Reading(None, "unparsed", "it is none of the options")


def _ticked(plain: str) -> str:
    """Return the one line with a tick where others have crosses; empty where there is none."""
    lines = plain.split("\n")
    ticked = [line for line in lines if re.search(TICK, line)]
    crossed = [line for line in lines if re.search(CROSS, line) and line not in ticked]
    if len(ticked) != 1 or not crossed:
        return ""
    return " ".join(re.split(rf"{TICK}|\W{{2,}}", ticked[0]))


def _marks_a_name(plain: str, mark: Mention, named: Sequence[Mention]) -> bool:
    """Whether a mark only begins a line or a phrase that goes on with a name: "2. stop"."""
    return any(
        mark.end <= one.start <= mark.end + 4 and not re.search(r"\w", plain[mark.end : one.start])
        for one in named
    )

"""Parses the option chosen in an answer: an action, or an answer to the closed question."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen._arguments import checked
from oodscen._prose import fold, is_refusal, tidy
from oodscen.data._episode import ACTIONS
from oodscen.errors import UsageError
from oodscen.judging._parsing.reading import (
    ParsedAnswer,
    Question,
    members,
    read,
    unwrap,
)
from oodscen.judging._parsing.stating import FIRST, GERUNDS, OPTION, is_against, stated_option
from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError

Marking = Callable[[str], str]
"""Replaces every option that folded prose names with a character of `stating.OPTION`."""


@checked
def read_action(text: str, offered: Sequence[str] = ACTIONS) -> ParsedAnswer[str]:
    """Return which of the offered actions was chosen.

    Args:
        text: A model's answer.
        offered: Ids of the actions; all of them by default.

    Raises:
        UsageError: When no action is offered, an id is empty, or the answer is not a text.
    """
    if not offered or "" in offered:
        raise UsageError("no action is offered, or the id of one is empty")
    words = {name: _ACTION_WORDS.get(name, re.escape(fold(name))) for name in offered}
    return _Reader(list(offered), _marking(words), _ACTION).read(text)


def read_choice(text: str, labels: Mapping[str, str]) -> ParsedAnswer[str]:
    """Return the chosen option of the closed question, given by its number or its label.

    `labels` holds the text of every option by id, in the order in which they were offered.
    """
    words = {name: re.escape(fold(tidy(label))) for name, label in labels.items()}
    mark = _marking(words, is_numbered=True)
    return _Reader(list(labels), mark, _CHOICE, is_numbered=True).read(text)


def contradiction(reasoning: str, action: str, offered: Sequence[str]) -> str:
    """Return a sentence if the reasoning states another action than the answer; else an empty string."""
    found = read_action(tidy(reasoning), offered).value
    if found is None or found == action:
        return ""
    return f"the reasoning settles on {found}, the answer is {action}"


_FINAL = r"(?:final|chosen|selected|best|my|the|safest|recommended|correct)*"
_ASKED = r"(?:answer|choice|decision|option|selection|response|result|output)"
_ACTION = re.compile(rf"{_FINAL}(?:action|{_ASKED})(?:id|name|taken)?")
_CHOICE = re.compile(rf"{_FINAL}(?:number|label|{_ASKED})(?:id|number)?")
_INSIDE = re.compile(r"(?:id|name|value|number|label|option|action|choice|answer)")
_DANGER = re.compile(
    r"\b(?:dangerous|hazardous|unsafe|risky|risks?|fatal|deadly|problem|collisions?|accidents?|poses?|creates?)\b"
)
"""Matches words that condemn an action, and not a thing that is named in the closed question."""
_DEEPEST = 4
"""Levels of lists and objects in which a choice may be wrapped."""


@dataclass(frozen=True)
class _Reader:
    """Finds the chosen option, as its place among those that were offered."""

    names: Sequence[str]
    mark: Marking
    keys: re.Pattern[str]
    """Matches the members that hold the choice."""
    is_numbered: bool = False
    """True if a number, from 1, stands for an option."""

    def read(self, text: str) -> ParsedAnswer[str]:
        """Return the name of the option that an answer chooses."""
        reading = read(text, Question(self._picked, self._stated, self.keys, self._denies))
        if reading.value is None:
            return ParsedAnswer(None, reading.outcome, reading.note)
        return ParsedAnswer(self.names[reading.value], "answered", reading.note)

    def _picked(self, value: Mapping[str, Any]) -> int | None:
        held = members(value, self.keys)
        found = self._agreed(held, _DEEPEST)
        if held and found is None:
            raise UnusableError(f"{str(held[0])[:80]!r} is no option")
        return found

    def _agreed(self, values: Iterable[Any], depth: int) -> int | None:
        """Return the option of all of some values; `None` if they have none."""
        found = {self._option(value, depth) for value in values}
        if len(found) > 1:
            raise UnusableError(TWO_ANSWERS)
        return found.pop() if found else None

    def _option(self, value: Any, depth: int) -> int | None:
        """Return the option of a value: its number, its words, or that of the only value inside."""
        if isinstance(value, list) and len(value) == 1 and depth:
            return self._option(value[0], depth - 1)
        if isinstance(value, dict) and depth:
            held, reasons = unwrap(value, _INSIDE)
            found = self._agreed(held.values(), depth - 1)
            return None if found is None or self._denies(tidy(reasons), found) else found
        if self.is_numbered and isinstance(value, (int, float)) and not isinstance(value, bool):
            return int(value) - 1 if value in range(1, len(self.names) + 1) else None
        is_text = isinstance(value, str) and re.match(r"[\s*`\"'(#]*\w", value)
        return self._stated(tidy(value)) if is_text else None

    def _stated(self, prose: str) -> int | None:
        found = None if is_refusal(prose) else stated_option(self.mark(fold(prose)))
        return found if found is not None and found < len(self.names) else None

    def _denies(self, reasons: str, option: int) -> bool:
        plain = self.mark(fold(reasons))
        return is_against(_DANGER.sub("seen", plain) if self.is_numbered else plain, option)


# ------------------------------------------------------------------ options in prose


def _marking(words: Mapping[str, str], *, is_numbered: bool = False) -> Marking:
    """Return a function that replaces the options that prose names with characters.

    `words` holds a pattern by name, in the order in which the options were offered. If they were offered with
    numbers, the longest label matches first; otherwise the patterns match in the order of `_ACTION_WORDS`.
    """
    places = {name: place for place, name in enumerate(list(words)[:_MOST])}
    rank = {name: place for place, name in enumerate(_ACTION_WORDS)}
    order = sorted(
        places, key=lambda name: -len(words[name]) if is_numbered else rank.get(name, len(rank))
    )
    finder = re.compile(
        "|".join(rf"(?P<o{places[name]}>(?<!\w)(?:{words[name]})(?!\w))" for name in order)
    )

    def called(found: re.Match[str]) -> str:
        gerund = GERUNDS if not is_numbered and _GERUND.match(found.group()) else 0
        return chr(FIRST + int(str(found.lastgroup)[1:]) + gerund)

    def numbered(found: re.Match[str]) -> str:
        place = int(found["number"]) - 1
        return found.group()[: found.start("mark") - found.start()] + chr(
            FIRST + (place if place in range(len(places)) else _MOST)
        )

    def mark(plain: str) -> str:
        if not is_numbered:
            return finder.sub(called, _LIST_MARK.sub("\u2022 ", plain))
        plain = finder.sub(called, re.sub(r"#(?=\d)", "", plain))
        for pattern in _NUMBERS:
            plain = pattern.sub(numbered, plain)
        return plain

    return mark


_MOST = 2_000
"""The most options found in prose; later ones count only by number in JSON. Also the place of no option."""
_LIST_MARK = re.compile(r"^\(?(?:\d{1,2}|[a-h])[.)] (?=\D)", re.MULTILINE)
_GERUND = re.compile(r"\w+ing\b|.*\bbraking$")
_MARK = r"(?P<mark>\(?(?<![-.,\d])(?P<number>\d{1,3})(?![\d%]|[.,]\d)\)?)"
_NUMBERS = (
    re.compile(rf"\b(?:option|number|no\.) ?(?:is )?:? ?{_MARK}"),
    re.compile(rf"^[\s(.:-]{{0,8}}{_MARK}(?=[ .!)]{{0,8}}$)", re.MULTILINE),
    re.compile(rf"(?:^|(?<=[\s:(])){_MARK}(?=[.):\s-]{{0,4}}{OPTION})", re.MULTILINE),
    re.compile(
        r"\b(?:answer|choice|description|it|that|choose|pick|select|go with|say|id)(?: (?:is|would be))?"
        rf" ?[:=]* ?{_MARK}(?=[ .!;,)]{{0,8}}$|[.,;!\n)]| because| since)",
        re.MULTILINE,
    ),
)
"""Match a number that stands for an option, and not for a count or a measurement."""

# ------------------------------------------------------------------ words for the actions

_THE = r"(?:(?:the|my|your|its|our|a|same|current|constant) )*"
_GENTLY = r"(?: (?:gently|gradually|slightly|carefully|smoothly|comfortably|safely))?"
_SIDE = r"(?:(?:hard )?shoulder|(?:right )?(?:side|edge)(?: of the road)?|right)"


def _lane_change(side: str) -> str:
    lane = rf"(?:in|on)?(?:to )?(?:the )?(?:next )?(?:{side}(?: hand)?(?: lane)?|lane (?:to|on) the {side})"
    rest = "(?:, even if it is for oncoming traffic)?" if side == "left" else ""
    return (
        rf"(?:chang|mov|merg|swerv|steer|shift|switch|veer)(?:e|ing)? (?:the )?(?:over )?(?:lanes? )?{lane}{rest}"
        rf"|{side} lane change|lane change,? {lane}"
    )


_ACTION_WORDS = {
    "pull_over": (
        rf"(?:slow down, )?(?:pull(?:ing)? ?over|(?:pull|mov)(?:e|ing)? (?:in|on)?to the {_SIDE})"
        rf"(?: to the {_SIDE})?(?: or the shoulder)?(?:,? and (?:stop|park|wait)(?: there)?)?"
        rf"|(?:stop|park)(?:p?ing)? (?:on|at) the {_SIDE}"
    ),
    "emergency_brake": (
        r"(?:emergency|panic|full|hard|maximum) brak(?:e|ing)|emergency stop(?:ping)?"
        r"|(?:keep the lane and )?brak(?:e|ing) (?:hard|sharply|fully|as hard as (?:possible|i can|the road allows))"
        r"|slam(?:ming)? (?:on )?the brakes?|apply(?:ing)? (?:full|emergency) (?:brakes|braking)"
    ),
    "change_lane_left": _lane_change("left"),
    "change_lane_right": _lane_change("right"),
    "stop": (
        rf"(?:keep the lane and )?(?:com(?:e|ing)|brak(?:e|ing)){_GENTLY} to an?"
        r" (?:(?:complete|full|controlled|safe|smooth) )*(?:stop|halt|standstill)|(?:a )?(?:complete|full|controlled) stop"
        r"|(?<!bus )(?<!non )(?<!truck )stop(?:ping)?(?: the (?:car|vehicle|ego vehicle))?"
        r"(?! ?(?:signs?|lines?|lights?|signals?|at nothing|\w+ing\b))|halt(?:ing)?"
    ),
    "slow_down": (
        rf"(?:keep the lane and )?slow(?:ing)? ?down{_GENTLY}(?: to half the speed)?|decelerat(?:e|ing){_GENTLY}"
        rf"|(?:reduc|lower)(?:e|ing)? {_THE}speed|brak(?:e|ing) (?:gently|lightly|softly|slightly)|gentle braking"
    ),
    "keep_speed": (
        rf"(?:keep|maintain|hold)(?:ing)? {_THE}(?:lane and (?:the )?)?speed(?: and lane)?(?! (?:low|down|slow|under(?! any)|below|of)\b)"
        rf"|(?:keep (?:going|driving)|continue(?: driving| straight| ahead)?)(?: at {_THE}speed)(?! of\b)"
        r"|keep(?:ing)? (?:going|driving)|continu(?:e|ing) (?:driving|straight|ahead)"
        r"|continue(?= ?(?:[.!]|$|because\b|since\b))|(?<![^\n])keeps (?:its|the) (?:lane and (?:the )?)?speed(?= ?(?:[.!\n]|$))"
    ),
}
"""Names of each action as a pattern over folded prose; if two start together, the first one wins."""

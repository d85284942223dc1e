"""Read which of several options was chosen: an action, or an answer to the closed question."""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from oodscen.judging.parsing.reading import (
    TWO_ANSWERS,
    Reading,
    UnusableError,
    is_placeholder,
    is_refusal,
    members,
    read,
)
from oodscen.judging.parsing.stating import FIRST, FIRST_GERUND, OPTION, AmbiguousError, stated
from oodscen.judging.parsing.text import LONGEST, folded, tidied

Marking = Callable[[str], str]
"""Puts a character of `stating.OPTION` in place of every option that folded prose names."""


def read_action(text: str, offered: Sequence[str]) -> Reading[str]:
    """Read which of the offered actions was chosen.

    Args:
        text: A model's words.
        offered: Ids of the actions.
    """
    words = {name: _ACTION_WORDS.get(name, re.escape(folded(name))) for name in offered}
    return _read(text, list(offered), _marking(words), _ACTION, is_numbered=False)


def read_choice(text: str, labels: Mapping[str, str]) -> Reading[str]:
    """Read which option of the closed question was chosen, by its number or its label.

    Args:
        text: A model's words.
        labels: Text of every option by id, in the order in which they were offered.
    """
    words = {name: re.escape(folded(tidied(label))) for name, label in labels.items()}
    return _read(text, list(labels), _marking(words, is_numbered=True), _CHOICE, is_numbered=True)


def contradiction(reasoning: str, action: str, offered: Sequence[str]) -> str:
    """Say where a chain of thought states another action than the answer; empty where not."""
    if len(reasoning) > LONGEST:
        return ""
    marked = _marking({name: _ACTION_WORDS.get(name, re.escape(folded(name))) for name in offered})(
        folded(tidied(reasoning))
    )
    try:
        found = stated(marked)
    except AmbiguousError:
        return ""
    if found is None or offered[found] == action:
        return ""
    return f"the reasoning settles on {offered[found]}, the answer is {action}"


_ACTION = re.compile(
    r"(?:final|chosen|selected|best|my|the|safest|recommended)*(?:action|answer|choice|decision|option|selection|response|result|output)"
    r"s?(?:id|name|taken)?"
)
_CHOICE = re.compile(
    r"(?:final|chosen|selected|best|my|the|correct)*(?:choice|answer|option|selection|number|label|decision|response|result|output)(?:id|number)?"
)
_INSIDE = re.compile(r"(?:id|name|value|number|label|option|action|choice|answer)")
_WRAPPERS = re.compile(
    r"(?:final|json|data|arguments|parameters|properties)?(?:answer|response|result|output)?"
)


def _read(
    text: str, names: list[str], mark: Marking, keys: re.Pattern[str], *, is_numbered: bool
) -> Reading[str]:
    def resolved(value: Any, depth: int = 4) -> int | None:
        if isinstance(value, list) and len(value) == 1 and depth:
            return resolved(value[0], depth - 1)
        if isinstance(value, dict) and depth:
            return agreed(members(value, keys) or members(value, _INSIDE), depth - 1)
        if is_numbered and isinstance(value, (int, float)) and not isinstance(value, bool):
            return int(value) - 1 if value in range(1, len(names) + 1) else None
        return in_prose(tidied(value)) if isinstance(value, str) else None

    def agreed(values: Sequence[Any], depth: int) -> int | None:
        found = [resolved(value, depth) for value in values]
        known = {one for one in found if one is not None}
        if len(known) > 1:
            raise UnusableError(TWO_ANSWERS)
        return known.pop() if known and found[0] is not None else None

    def in_prose(prose: str) -> int | None:
        if is_refusal(prose):
            return None
        try:
            found = stated(mark(folded(prose)))
        except AmbiguousError as error:
            raise UnusableError(str(error)) from None
        return found if found is not None and found < len(names) else None

    def picked(value: Mapping[str, Any], depth: int = 4) -> int | None:
        held = [one for one in members(value, keys) if not is_placeholder(one)]
        if not held:
            inner = [one for one in members(value, _WRAPPERS) if isinstance(one, dict)]
            return picked(inner[0], depth - 1) if len(inner) == 1 and depth else None
        found = agreed(held, 4)
        if found is None:
            raise UnusableError(f"{str(held[0])[:80]!r} is no option")
        return found

    reading = read(text, picked, in_prose)
    if reading.value is None:
        return Reading(None, reading.outcome, reading.note)
    return Reading(names[reading.value], "answered", reading.note)


# ------------------------------------------------------------------ options in prose


def _marking(words: Mapping[str, str], *, is_numbered: bool = False) -> Marking:
    """Return what puts characters for the options that prose names, given a pattern of each.

    Args:
        words: Pattern by name, in the order in which the options were offered.
        is_numbered: Whether they were offered with numbers. The longest label counts then; else the first pattern
            in the order of `_ACTION_WORDS`.
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
        gerund = FIRST_GERUND - FIRST if not is_numbered and _GERUND.match(found.group()) else 0
        return chr(FIRST + int(str(found.lastgroup)[1:]) + gerund)

    def numbered(found: re.Match[str]) -> str:
        place = int(found["number"]) - 1
        return found.group()[: found.start("mark") - found.start()] + chr(
            FIRST + (place if place in range(len(places)) else _MOST)
        )

    def mark(plain: str) -> str:
        if not is_numbered:
            return finder.sub(
                called, re.sub(r"^\d{1,2}[.)] (?=\D)", "\u2022 ", plain, flags=re.MULTILINE)
            )
        plain = finder.sub(called, plain)
        for pattern in _NUMBERS:
            plain = pattern.sub(numbered, plain)
        return plain

    return mark


_MOST = 2_000
"""Options beyond this many are known by their number in JSON alone; also the place of a number that is no option's."""
_GERUND = re.compile(r"\w+ing\b|.*\bbraking$")
_MARK = r"(?P<mark>\(?(?<![-.,\d])(?P<number>\d{1,3})(?![\d%]|[.,]\d)\)?)"
_NUMBERS = (
    re.compile(rf"\b(?:option|number|no\.) ?(?:is )?:? ?{_MARK}"),
    re.compile(rf"^[\s(.:-]{{0,8}}{_MARK}(?=[ .!)]{{0,8}}$)", re.MULTILINE),
    re.compile(rf"(?:^|(?<=[\s:(])){_MARK}(?=[.):\s-]{{0,4}}{OPTION})", re.MULTILINE),
    re.compile(
        r"\b(?:answer|choice|description|match|it|that|choose|pick|select|go with|say|id)(?: (?:is|would be))? ?[:=]* ?"
        rf"{_MARK}(?=[ .!;,)]{{0,8}}$|[.,;!\n)]| \(| because| since)",
        re.MULTILINE,
    ),
)
"""A number that stands for an option, and neither counts nor measures."""

# ------------------------------------------------------------------ words for the actions

_THE = r"(?:(?:the|my|your|its|our|a|this|same|present|current|constant|steady) )*"
_CAR = r"(?: the (?:car|vehicle|ego|ego vehicle))?"
_BRAKE = r"brak(?:e|ing)"
_SIDE = r"(?:(?:right )?(?:hard )?shoulder|roadside|(?:right )?(?:side|edge|verge)(?: of the road)?|kerb|curb)"


def _lane_change(side: str) -> str:
    lane = rf"(?:in ?|on ?)?(?:to )?(?:the )?(?:next |adjacent )?(?:{side}(?: ?hand)?(?: lane| side)?|lane (?:to|on) the {side})"
    rest = ", even if it is for oncoming traffic" if side == "left" else ""
    return (
        rf"chang(?:e|ing) (?:the )?(?:lanes? )?{lane}(?:{rest})?|{side} lane change|lane change,? {lane}"
        rf"|(?:mov|merg|swerv|steer|shift|switch|veer)(?:e|ing)? (?:over )?{lane}"
    )


_ACTION_WORDS = {
    "pull_over": (
        rf"(?:slow down, )?(?:pull(?:ing)? ?over|(?:pull|mov)(?:e|ing)? (?:over )?(?:in ?|on ?)?to the {_SIDE})"
        rf"(?: (?:to|on|onto) the (?:right|{_SIDE}))?(?: or the shoulder)?(?:,? (?:and|to) (?:stop|park|halt|wait)(?:ping|ing)?(?: there)?)?"
        rf"|(?:stop|park)(?:p?ing)?{_CAR} (?:on|at) the {_SIDE}"
    ),
    "emergency_brake": (
        rf"(?:emergency|panic|full|hard|maximum|sharp) {_BRAKE}|emergency stop(?:ping)?"
        rf"|(?:keep the lane and )?{_BRAKE} (?:very |really )?(?:hard|sharply|fully|firmly|as hard as (?:possible|(?:i|we|you) can|the road allows))"
        r"(?: to a (?:stop|halt))?|slam(?:ming)? (?:on )?the brakes?|(?:apply(?:ing)? (?:the )?(?:emergency|full) brak(?:es?|ing))"
        r"|apply(?:ing)? the brakes? (?:hard|fully|firmly)|hit(?:ting)? the brakes? (?:hard|as hard as possible)"
    ),
    "change_lane_left": _lane_change("left"),
    "change_lane_right": _lane_change("right"),
    "stop": (
        rf"(?:keep the lane and )?(?:com(?:e|ing)|{_BRAKE}|slow(?:ing)?(?: down)?|decelerat(?:e|ing)|bring(?:ing)? the (?:car|vehicle))"
        r" (?:comfortably |gently |gradually |smoothly |safely )?to an? (?:(?:complete|full|controlled|safe|smooth|gentle) )*(?:stop|halt|standstill)"
        rf"|(?:an? )?(?:complete|full|controlled|immediate|safe) stop|(?<!bus )(?<!non )(?<!truck )(?<!pit )stop(?:ping)?{_CAR}"
        rf"(?! ?(?:signs?|lines?|lights?|signals?|lamps?|distance|at nothing|\w+ing\b))|halt(?:ing)?{_CAR}"
    ),
    "slow_down": (
        rf"(?:keep the lane and )?slow(?:ing)? ?down(?: gently| gradually| slightly| carefully)?(?: to half the speed)?|slowing"
        rf"|(?:reduc|lower|decreas)(?:e|ing)? {_THE}speed|decelerat(?:e|ing)(?: gently| gradually)?"
        rf"|{_BRAKE} (?:gently|lightly|softly|slightly)|gentle braking|(?:eas|lift)(?:e|ing)? off the (?:gas|accelerator|throttle)"
    ),
    "keep_speed": (
        rf"(?:keep|maintain|hold)(?:ing)? {_THE}(?:lane and (?:the )?)?speed(?: and lane)?(?! (?:low|down|slow|under|below|up|of)\b)"
        r"|(?:keep|maintain)(?:ing)? (?:the )?lane and (?:the )?speed"
        rf"|keep(?:ing)? (?:going|driving)(?: (?:straight|at {_THE}speed))?|continu(?:e|ing) (?:driving|straight|(?:straight )?ahead|forward)"
        rf"(?: at {_THE}speed)?|continu(?:e|ing) at {_THE}speed|(?:drive|carry) on(?! the)|do(?:ing)? nothing"
    ),
}
"""By action: what it is called, as a pattern over folded prose; of two that begin together the first one counts."""

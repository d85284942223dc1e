"""Parses the option chosen in an answer: an action, or an answer to the closed question."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen._arguments import checked
from oodscen._words.prose import fold, is_refusal, tidy
from oodscen.data._episode import ACTIONS
from oodscen.errors import UsageError
from oodscen.judging._parsing.confidence import without_confidence
from oodscen.judging._parsing.marking import (
    FIRST,
    OPTION,
    Marking,
    action_marking,
    label_marking,
    number,
)
from oodscen.judging._parsing.members import members
from oodscen.judging._parsing.reading import ParsedAnswer, Question, read
from oodscen.judging._parsing.reasons import is_against
from oodscen.judging._parsing.stated_option import stated_option
from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError


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
    actions = list(dict.fromkeys(offered))
    return _Reader(actions, action_marking(actions), _ACTION).read(text)


def read_choice(text: str, labels: Mapping[str, str]) -> ParsedAnswer[str]:
    """Return the chosen option of the closed question, given by its number or its label.

    `labels` holds the text of every option by id, in the order in which they were offered.
    """
    mark = label_marking(list(labels.values()))
    return _Reader(list(labels), mark, _CHOICE, is_numbered=True).read(text)


def contradiction(reasoning: str, action: str, offered: Sequence[str]) -> str:
    """Return a sentence if the reasoning states another action than the answer; else an empty string."""
    reasoned = read_action(tidy(reasoning), offered).value
    if reasoned is None or reasoned == action:
        return ""
    return f"the reasoning settles on {reasoned}, the answer is {action}"


_FINAL = r"(?:final|chosen|selected|best|my|the|safest|recommended|correct)*"
_ANSWER = r"(?:answer|choice|decision|option|selection|response|result|output)"
_ACTION = re.compile(rf"{_FINAL}(?:action|{_ANSWER})(?:id|name|taken)?")
_CHOICE = re.compile(rf"{_FINAL}(?:number|label|{_ANSWER})(?:id|number)?")
_INNER = re.compile(r"(?:id|name|value|number|label|option|action|choice|answer)")
_LEAST_SURE = 0.5
"""The least share that is a confidence in a choice, and no doubt about it."""
_DANGER = re.compile(
    r"\b(?:dangerous|hazardous|unsafe|risky|risks?|fatal|deadly|problem|collisions?|accidents?|poses?|creates?)\b"
)
"""Matches words that condemn an action, and not a thing that is named in the closed question."""


@dataclass(frozen=True)
class _Reader:
    """Finds the chosen option, as its index among those that were offered."""

    names: Sequence[str]
    """Ids of the options."""
    mark: Marking
    keys: re.Pattern[str]
    """Matches the members that hold the choice."""
    is_numbered: bool = False
    """True if a number, from 1, stands for an option."""

    def read(self, text: str) -> ParsedAnswer[str]:
        """Return the name of the option that an answer chooses."""
        reading = read(text, self._question(self._picked, self.keys))
        if reading.value is None:
            return ParsedAnswer(None, reading.outcome, reading.note)
        return ParsedAnswer(self.names[reading.value], "answered", reading.note, reading.reasons)

    def _question(
        self, pick: Callable[[Mapping[str, Any]], int | None], keys: re.Pattern[str]
    ) -> Question[int]:
        return Question(pick, self._stated, keys, self._denies, self._rivals)

    def _picked(self, value: Mapping[str, Any]) -> int | None:
        choices = members(value, self.keys)
        option = self._agreed(choices)
        if choices and option is None:
            raise UnusableError(f"{str(choices[0])[:80]!r} is no option")
        return option

    def _agreed(self, values: Iterable[Any]) -> int | None:
        """Return the option of all of some values; `None` if they have none."""
        options = {self._option(value) for value in values}
        if len(options) > 1:
            raise UnusableError(TWO_ANSWERS)
        return options.pop() if options else None

    def _option(self, value: Any) -> int | None:
        """Return the option of a value: its number, its words, or that of the only value inside."""
        if isinstance(value, list) and len(value) == 1:
            return self._option(value[0])
        if isinstance(value, dict):
            return self._question(self._inner, _INNER).answer_in(value)[0]
        if self.is_numbered and isinstance(value, (int, float)) and not isinstance(value, bool):
            return int(value) - 1 if value in range(1, len(self.names) + 1) else None
        is_text = isinstance(value, str) and re.match(r"[\s*`\"'(#]*\w", value)
        return self._stated(tidy(value)) if is_text else None

    def _inner(self, value: Mapping[str, Any]) -> int | None:
        return self._agreed(value.values())

    def _stated(self, prose: str) -> int | None:
        if is_refusal(prose):
            return None
        plain = fold(without_confidence(prose, _LEAST_SURE))
        option = stated_option(self.mark(plain))
        return option if option is not None and option < len(self.names) else None

    def _denies(self, reasons: str, option: int) -> bool:
        return self._is_against(self.mark(fold(reasons)), option)

    def _rivals(self, words: str, option: int) -> bool:
        """Return whether words name another option, or condemn this one when they stand beside it."""
        plain = self.mark(fold(words))
        named = {number(mark) for mark in re.findall(OPTION, plain)}
        if self.is_numbered:
            named |= {int(digits) - 1 for digits in re.findall(r"\d{1,9}", plain)}
        own = chr(FIRST + option)
        return not named.isdisjoint({*range(len(self.names))} - {option}) or any(
            self._is_against(said, option) for said in (f"{own} {plain}", f"{plain} {own}")
        )

    def _is_against(self, plain: str, option: int) -> bool:
        return is_against(_DANGER.sub("seen", plain) if self.is_numbered else plain, option)

"""Marks the options that prose names: each becomes a single character."""

import re
from collections.abc import Callable, Sequence

from oodscen._words.prose import fold, tidy
from oodscen.judging._parsing.action_words import ACTION_WORDS

Marking = Callable[[str], str]
"""Replaces every option that folded prose names with a character of `OPTION`."""

FIRST, GERUNDS = 0xE000, 0x800
"""The character of the first option, and the offset of an option named as a gerund ("stopping", not "stop"), of which
the first is a multiple."""
OPTION = f"[{chr(FIRST)}-{chr(FIRST + 2 * GERUNDS - 1)}]"
BASE = f"[{chr(FIRST)}-{chr(FIRST + GERUNDS - 1)}]"
"""Matches an option that is not named as a gerund."""
GERUND = f"(?!{BASE}){OPTION}"


def action_marking(actions: Sequence[str]) -> Marking:
    """Return the function that marks actions, by `ACTION_WORDS` in its order; others are named by their ids.

    Of ids that begin alike the longest matches first.
    """
    actions = actions[:_MOST]
    patterns = [ACTION_WORDS.get(action, re.escape(fold(action))) for action in actions]
    ranks = {action: rank for rank, action in enumerate(ACTION_WORDS)}
    order = sorted(
        range(len(actions)),
        key=lambda index: (ranks.get(actions[index], len(ranks)), -len(patterns[index])),
    )
    finder = _finder(patterns, order)

    def marked(named: re.Match[str]) -> str:
        is_gerund = _GERUND_FORM.match(named.group()) is not None
        return chr(FIRST + _index(named) + (GERUNDS if is_gerund else 0))

    return lambda plain: finder.sub(marked, _LIST_MARK.sub("\u2022 ", plain))


def label_marking(labels: Sequence[str]) -> Marking:
    """Return the function that marks options by their labels, of which the longest matches first, or their numbers."""
    patterns = [re.escape(fold(tidy(label))) for label in labels[:_MOST]]
    order = sorted(range(len(patterns)), key=lambda index: -len(patterns[index]))
    finder = _finder(patterns, order)

    def numbered(named: re.Match[str]) -> str:
        index = int(named["number"]) - 1
        option = index if index in range(len(patterns)) else _MOST
        before = named.group()[: named.start("mark") - named.start()]
        return before + chr(FIRST + option)

    def mark(plain: str) -> str:
        plain = finder.sub(lambda named: chr(FIRST + _index(named)), re.sub(r"#(?=\d)", "", plain))
        for pattern in _NUMBERS:
            plain = pattern.sub(numbered, plain)
        return plain

    return mark


def number(option: str) -> int:
    """Return the number of the option that a character stands for."""
    return ord(option) % GERUNDS


def _finder(patterns: Sequence[str], order: Sequence[int]) -> re.Pattern[str]:
    """Return the pattern that matches one of some patterns as a whole, the first in order that does."""
    return re.compile(
        "|".join(rf"(?P<o{index}>(?<!\w)(?:{patterns[index]})(?!\w))" for index in order)
    )


def _index(named: re.Match[str]) -> int:
    return int(str(named.lastgroup)[1:])


_MOST = 2_000
"""The most options found in prose; later ones count only by number in JSON. Also the number of no option."""
_LIST_MARK = re.compile(r"^\(?(?:\d{1,2}|[a-h])[.)] (?=\D)", re.MULTILINE)
_GERUND_FORM = re.compile(r"\w+ing\b|.*\bbraking$")
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

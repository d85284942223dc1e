"""Questions and lists of options that a model repeats before it answers."""

import re
from collections.abc import Mapping

from oodscen.judging.marks import Finder
from oodscen.judging.patterns import compiled, either

FULL_LIST = 4
"""So many options on neighbouring lines, or all that there are, repeat the question."""

INLINE_LIST = 3
"""So many options after "options:" repeat the question."""


def without_echo(plain: str, find: Finder, count: int) -> str:
    """Drop the list of options and the question, where a model repeats them before it answers.

    Args:
        plain: A normalised text.
        find: Finds options by name.
        count: How many options were offered.
    """
    text = _QUESTION.sub(" ", _without_list(plain, find, count))

    def kept(listing: re.Match[str]) -> str:
        options = {mention.option for mention in find(listing.group())}
        return " " if len(options) >= INLINE_LIST else listing.group()

    return _LISTING.sub(kept, text)


_QUESTION = compiled(r"(?:choose|select|pick) (?:the )?one (?:action|of)[^\n]*?(?::|\n|\.\s|$)")
_LISTING = compiled(
    r"(?:options?|(?:(?:available|possible) )?actions?|choices)(?: (?:are|were|available))?"
    r" *: *[^\n]*?(?=\n|[.;]\s|$)"
)
"""A list on one line: "options: stop, slow_down, pull_over"."""


def _without_list(plain: str, find: Finder, count: int) -> str:
    lines = plain.split("\n")
    listed = {index: option for index, line in enumerate(lines) if (option := _listed(line, find))}
    options = len(set(listed.values()))
    if options < min(FULL_LIST, count) and not 1 < options == count:
        return plain
    run = _longest_run(listed)
    return "\n".join(
        line
        for index, line in enumerate(lines)
        if index not in run and not _INSTRUCTION.match(line)
    )


_INSTRUCTION = compiled(
    r" *" + either("answer with json", "choose (?:the )?one", "options?:", "available actions")
)


def _listed(line: str, find: Finder) -> str:
    """Return the option that a line begins with, after a mark or none."""
    mark = _BULLET.match(line)
    start = mark.end() if mark else 0
    named = find(line)[:1]
    return named[0].option if named and named[0].start <= start + 1 else ""


_BULLET = re.compile(r"\s*(?:[-\u2022\u2014+]|\(?(?:\d{1,2}|[a-z])[.):])?\s*")


def _longest_run(listed: Mapping[int, str]) -> set[int]:
    """Return the longest stretch of neighbouring lines that list options, each once."""
    runs: list[list[int]] = []
    for index, option in listed.items():
        before = runs[-1] if runs else []
        if index - 1 in before and option not in {listed[one] for one in before}:
            before.append(index)
        else:
            runs.append([index])
    longest_run: list[int] = max(runs, key=len, default=[])
    return set(longest_run)

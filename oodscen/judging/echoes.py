"""Questions and lists of options that a model repeats before it answers."""

import re
from collections.abc import Mapping

from oodscen.judging.marks import Finder


def without_echo(plain: str, find: Finder, count: int) -> str:
    """Drop the list of options and the question, where a model repeats them before it answers."""
    lines = plain.split("\n")
    listed = {index: option for index, line in enumerate(lines) if (option := _listed(line, find))}
    options = set(listed.values())
    is_list = len(options) >= min(4, count) or (len(options) == count and count > 1)
    if is_list:
        run = _longest_run(listed)
        rest = [line for index, line in enumerate(lines) if index not in run]
        lines = [
            line
            for line in rest
            if not re.match(
                r"\s*(?:answer with json|choose the one|choose one|options?:|available actions)",
                line,
            )
        ]
    text = "\n".join(lines)
    text = re.sub(
        r"(?:choose|select|pick)\s+(?:the\s+)?one\s+(?:action|of)[^\n]*?(?::|\n|\.\s|$)", " ", text
    )
    return re.sub(
        r"(?:options?|actions?|choices|available actions?|possible actions?)(?:\s+(?:are|were|available))?\s*:\s*[^\n]*?(?=\n|[.;]\s|$)",
        lambda m: " " if len({f.option for f in find(m.group())}) >= 3 else m.group(),
        text,
    )


def _listed(line: str, find: Finder) -> str:
    """Return the option that a line begins with, after a mark or none."""
    mark = re.match(r"\s*(?:[-\u2022\u2014+]|\(?(?:\d{1,2}|[a-z])[.):])?\s*", line)
    start = mark.end() if mark else 0
    named = find(line)[:1]
    return named[0].option if named and named[0].start <= start + 1 else ""


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

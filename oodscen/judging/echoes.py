"""Questions and lists of options that a model repeats before it answers."""

import re
from collections.abc import Sequence

from oodscen.judging.marks import Finder


def without_echo(plain: str, find: Finder, count: int) -> str:
    """Drop the list of options and the question, where a model repeats them before it answers."""
    lines = plain.split("\n")
    listed = [
        index
        for index, line in enumerate(lines)
        if re.match(r"\s*(?:[-\u2022\u2014+]|\(?(?:\d{1,2}|[a-z])[.):])?\s*", line)
        and _begins(line, find)
    ]
    options = {found.option for index in listed for found in find(lines[index])[:1]}
    is_list = len(options) >= min(4, count) or (len(options) == count and count > 1)
    if is_list:
        run = _longest_run(listed, lines)
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


def _begins(line: str, find: Finder) -> bool:
    mark = re.match(r"\s*(?:[-\u2022\u2014+]|\(?(?:\d{1,2}|[a-z])[.):])?\s*", line)
    start = mark.end() if mark else 0
    return any(found.start <= start + 1 for found in find(line)[:1])


def _longest_run(listed: Sequence[int], lines: Sequence[str]) -> set[int]:
    """Return the longest stretch of neighbouring lines that list options; blank lines may part them."""
    runs: list[list[int]] = []
    for index in listed:
        if runs and not any(lines[i].strip() for i in range(runs[-1][-1] + 1, index)):
            runs[-1].append(index)
        else:
            runs.append([index])
    longest_run: list[int] = max(runs, key=len, default=[])
    return set(longest_run)

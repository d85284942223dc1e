"""Numbers and letters that stand for an option: "Option 4", "(c)", "the third one", "it is 5"."""

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from oodscen.judging.languages import ANSWER
from oodscen.judging.wording import Mention

NOT_OFFERED = ""
"""The option of a mark that is on no list."""

Finder = Callable[[str], list[Mention]]
_NONE: Mapping[str, str] = {}


def find_marks(
    plain: str, offered: Sequence[str], find: Finder, own: Mapping[str, str] = _NONE
) -> list[Mention]:
    """Find where a normalised text chooses, weighs or rejects an option by its mark.

    Numbers that count or measure something are none: "4 cars", "8 m/s", "frame 2", "90 %", and so are
    those that number the steps of a chain of thought.

    Args:
        plain: The text.
        offered: Option ids in the order in which they were offered.
        find: Finds options by name.
        own: What the marks stand for in a list that the text gives itself (see `own_list`).
    """

    def by_mark(mark: str) -> str:
        return own.get(mark) or _at(mark, offered)

    bare = _BARE.fullmatch(plain.strip())
    if bare and not find(plain):
        start = plain.index(bare[1])
        return [Mention(start, start + len(bare[1]), by_mark(bare[1]))]
    spans: dict[int, tuple[int, str]] = {}
    steps = _is_numbered(plain)
    for pattern in _PATTERNS:
        for match in pattern.finditer(plain):
            if pattern is _LEADING and (steps or match["mark"] in ("0", "1", "a")):
                continue
            spans[match.start("mark")] = (match.end("mark"), by_mark(match["mark"]))
            end = match.end("mark")
            while more := _MORE.match(plain, end):
                end = more.end("mark")
                spans[more.start("mark")] = (end, by_mark(more["mark"]))
    for match in _ORDINAL.finditer(plain):
        spans[match.start()] = (match.end(), _counted(match, offered))
    return [Mention(start, end, option) for start, (end, option) in sorted(spans.items())]


_MARK = r"(?P<mark>(?<![-\d.])\d{1,3}|[b-h]|a(?=\s*(?:[)\].:!]|$)))"
_NUMBER = r"(?P<mark>(?<![-\d.])\d{1,3})"
_NO_MEASURE = r"(?![a-z\u00e0-\u024f\d_%])(?!\s*(?:[.,]\d|%|percent\b|/\s*\d|\w+/\w|m\b|km|met(?:er|re)|second|s\b))"
_ENDS = rf"{_NO_MEASURE}(?=\s*(?:[)\]}}.:,;!?\n\u2014(/<|]|$|\b(?:because|since|as|is|isn't|was|would|does|doesn't|do|seems?|fits?|applies|appl|describes?|looks?|might|may|could|can|and|or|but|not|rather|instead|than|best|which|also|matches|with|for|to)\b|[\u3000-\u9fff]))"
_NOUN = (
    rf"(?:option|answer|ans|choice|number|action|no\.|nr\.?|n\u00ba|item|choose|pick|select|go(?:ing)?\s+with|nummer|num\u00e9ro|n\u00famero|boxed|{ANSWER}"
    r"|\u9009\u9879|\u9078\u629e\u80a2|\u9078\u9805|\u7b2c)"
)
_LINK = r"(?:\s*(?:is|the|la|le|die|correcta?|correcte|richtige|was|would\s+be|must\s+be|should\s+be|ist|est|es|\u662f|\u4e3a|\u306f|\u756a|:|=|\{|\(|\[|\u2014|>|option|number|no\.))*"
_LEADING = re.compile(
    rf"\A[^\w\n]{{0,3}}(?P<mark>\d{{1,3}}|[b-h](?=\s*[)\].:])){_NO_MEASURE}(?=\s*(?:[.):,(\]\u2014\n]|$|because\b|since\b|as\b))"
)
_PATTERNS = (
    re.compile(rf"(?<![a-z]){_NOUN}s?{_LINK}\s*{_MARK}{_ENDS}"),
    re.compile(
        rf"\b(?:(?:it|that|this|one|which|answer|choice|(?:description|match|fit|category|label)(?:\s+(?:of|for)\s+(?:\w+\s+){{0,2}}\w+)?)(?:'s|\s+(?:is|was|would\s+be|must\s+be|should\s+be|has\s+to\s+be))"
        rf"|not|but|so|hence|thus|therefore|no|actually|wait|than|rather|choose|pick|select|go(?:ing)?\s+with|thought|think|guess|say|left\s+with|leaves|i'd)"
        rf"\W{{1,5}}{_NUMBER}{_ENDS}(?!\s*(?:and|with|for|to|can|do|could|may)\b)"
    ),
    re.compile(rf"^[^\w\n]*{_NUMBER}[^\w\n]*$", re.MULTILINE),
    re.compile(rf"\b(?:id|index)\s*[=:]\s*{_NUMBER}\b"),
    re.compile(rf"^\s*[(\[]{_MARK}[)\]]", re.MULTILINE),
    re.compile(rf"<\s*/?\s*\w+\s*>\s*{_NUMBER}\s*<"),
    _LEADING,
)
_MORE = re.compile(
    rf"\s*(?:,|\bor\b|\band\b|/|&)\s*(?:option\s+|number\s+)?(?P<mark>\d{{1,3}}|[b-h](?=\s*(?:[)\].,]|$))){_NO_MEASURE}"
)
_BARE = re.compile(
    r"(?:the\s+)?(?:my\s+)?(?:final\s+)?(?:(?:option|answer|choice|number|no|nr)\s*[.:=]?\s*)?[^\w\s]*\s*((?<!-)(?:[a-z]|\d{1,3}))\s*[^\w\s]*"
)
_ORDINALS = (
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
    "ninth",
    "tenth",
)
_NUMERALS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_ORDINAL = re.compile(
    rf"\b({'|'.join(_ORDINALS)}|last)\s+(?:option|action|one|answer)\b"
    rf"|\b(?:option|number|choice|action|answer)\s*(?:is\b|[:=])?\s*(?:number\s+)?({'|'.join(_NUMERALS)})\b"
)


def _at(mark: str, offered: Sequence[str]) -> str:
    index = int(mark) - 1 if mark.isdecimal() else ord(mark) - ord("a")
    return offered[index] if 0 <= index < len(offered) else NOT_OFFERED


def _counted(match: re.Match[str], offered: Sequence[str]) -> str:
    if match[1] == "last":
        return offered[-1]
    index = _ORDINALS.index(match[1]) if match[1] else _NUMERALS.index(match[2])
    return offered[index] if index < len(offered) else NOT_OFFERED


def _is_numbered(plain: str) -> bool:
    """Whether a text numbers its steps or parts: a "1." and later a "2."."""
    numbers = [int(m[1]) for m in re.finditer(r"(?:^|\s)[(]?(\d{1,2})[.):]\s", plain)]
    return any(later == number + 1 for number, later in pairwise(numbers))


def own_list(plain: str, find: Finder) -> Mapping[str, str]:
    """Return what the marks stand for in a text that lists options by marks of its own."""
    own: dict[str, str] = {}
    for match in re.finditer(r"^\W*?[(\[]?(\d{1,2}|[a-z])[.):\]]+\s*(?=\S)", plain, re.MULTILINE):
        end = plain.find("\n", match.end())
        line = plain[match.end() : end if end >= 0 else len(plain)]
        named = find(line)
        if named and named[0].start <= 1:
            if own.get(match[1], named[0].option) != named[0].option:
                return {}
            own[match[1]] = named[0].option
    return own if len(own) > 1 else {}

"""Numbers and letters that stand for an option: "Option 4", "(c)", "the third one", "it is 5"."""

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from oodscen.judging.languages import ANSWER
from oodscen.judging.patterns import compiled, either
from oodscen.judging.wording import Mention

NOT_OFFERED = ""
"""The option of a mark that is on no list."""

Finder = Callable[[str], list[Mention]]
_NONE: Mapping[str, str] = {}


def find_marks(
    plain: str, offered: Sequence[str], find: Finder, own: Mapping[str, str] = _NONE
) -> list[Mention]:
    """Find where a normalised text chooses, weighs or rejects an option by its mark.

    Numbers that count or measure something are none: "4 cars", "8 m/s", "frame 2", "90 %", and so
    are those that number the steps of a chain of thought.

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
    patterns = _MARKED if _numbers_its_steps(plain) else (*_MARKED, _LEADING)
    spans: dict[int, tuple[int, str]] = {}
    for pattern in patterns:
        for match in pattern.finditer(plain):
            marked: re.Match[str] | None = match
            while marked:
                end = marked.end("mark")
                spans[marked.start("mark")] = (end, by_mark(marked["mark"]))
                marked = _MORE.match(plain, end)
    for match in _COUNTED.finditer(plain):
        spans[match.start()] = (match.end(), _counted(match, offered))
    return [Mention(start, end, option) for start, (end, option) in sorted(spans.items())]


def _at(mark: str, offered: Sequence[str]) -> str:
    index = int(mark) - 1 if mark.isdecimal() else ord(mark) - ord("a")
    return offered[index] if 0 <= index < len(offered) else NOT_OFFERED


def _numbers_its_steps(plain: str) -> bool:
    """Whether a text numbers its steps or parts: a "1." and later a "2."."""
    numbers = [int(m[1]) for m in re.finditer(r"(?:^|\s)[(]?(\d{1,2})[.):]\s", plain)]
    return any(later == number + 1 for number, later in pairwise(numbers))


# ------------------------------------------------------------------ a mark alone

_BARE = compiled(
    r"(?:the )?(?:my )?(?:final )?(?:(?:option|answer|choice|number|no|nr) *[.:=]? *)?"
    r"[^\w\s]* *((?<!-)(?:[a-z]|\d{1,3})) *[^\w\s]*"
)
"""All of a text: "3", "(c)", "The final answer: 3."."""

# ------------------------------------------------------------------ a mark in a text

_NUMBER = r"(?P<mark>(?<![-\d.])\d{1,3})"
_NUMBER_OR_LETTER = r"(?P<mark>(?<![-\d.])\d{1,3}|[b-h]|a(?= *(?:[)\].:!]|$)))"
"""An "a" is a letter only where a mark follows; else it is an article."""

_NO_MEASURE = (
    r"(?![a-zà-ɏ\d_%])"
    r"(?! *(?:[.,]\d|%|percent\b|/ *\d|\w+/\w|m\b|km|met(?:er|re)|second|s\b))"
)
_NO_COUNT = (
    r"(?= *"
    + either(
        r"[)\]}.:,;!?\n\u2014(/<|]|$",
        r"\b"
        + either(
            r"because|since|as|and|or|but|not|rather|instead|than|with|for|to|which|best|also",
            r"is|isn't|was|would|does|doesn't|do|seems?|looks?|might|may|could|can",
            r"fits?|applies|matches|describes?",
        )
        + r"\b",
        r"[\u3000-\u9fff]",
    )
    + ")"
)
_ENDS = _NO_MEASURE + _NO_COUNT
"""Follows a mark, and no number that measures or counts: "8 m/s", "4 cars"."""

_CALLED = either(
    r"option|answer|ans|choice|number|action|no\.|nr\.?|nº|item|boxed",
    r"choose|pick|select|go(?:ing)? with",
    r"nummer|numéro|número",
    ANSWER,
    r"选项|選択肢|選項|第",
)
_LINK = (
    r"(?: *"
    + either(
        r"is|was|would be|must be|should be|the|option|number|no\.",
        r"ist|est|es|la|le|die|correcta?|correcte|richtige",
        r"是|为|は|番",
        r":|=|\{|\(|\[|\u2014",
    )
    + r")*"
)
_IT_IS = (
    either(
        r"it|that|this|one|which|answer|choice",
        r"(?:description|match|fit|category|label)(?: (?:of|for) (?:\w+ ){0,2}\w+)?",
    )
    + r"(?:'s| (?:is|was|would be|must be|should be|has to be))"
)
_MARKED = (
    # "option 3", "answer: (c)"
    compiled(rf"(?<![a-z]){_CALLED}s?{_LINK} *{_NUMBER_OR_LETTER}{_ENDS}"),
    # "it is 3", "not 3 but 4", "I'd say 3"
    compiled(
        r"\b"
        + either(
            _IT_IS,
            r"not|but|so|hence|thus|therefore|no|actually|wait|than|rather",
            r"choose|pick|select|go(?:ing)? with|thought|think|guess|say|left with|leaves|i'd",
        )
        + rf"\W{{1,5}}{_NUMBER}{_ENDS}(?! *(?:and|with|for|to|can|do|could|may)\b)"
    ),
    # a line of its own
    compiled(rf"^[^\w\n]*{_NUMBER}[^\w\n]*$", flags=re.MULTILINE),
    compiled(rf"\b(?:id|index) *[=:] *{_NUMBER}\b"),
    # "(c) ..."
    compiled(rf"^ *[(\[]{_NUMBER_OR_LETTER}[)\]]", flags=re.MULTILINE),
)
_LEADING = compiled(
    r"\A[^\w\n]{0,3}(?P<mark>(?![01]\b)\d{1,3}|[b-h](?= *[)\].:]))"
    rf"{_NO_MEASURE}(?= *(?:[.):,(\]\u2014\n]|$|(?:because|since|as)\b))"
)
"""What a text begins with: "3. The lane is blocked"; a "1." may number a step."""

_MORE = compiled(
    r" *(?:,|\bor\b|\band\b|/|&) *(?:(?:option|number) )?"
    rf"(?P<mark>\d{{1,3}}|[b-h](?= *(?:[)\].,]|$))){_NO_MEASURE}"
)
"""Goes on after a mark: "option 3 or 4"."""

# ------------------------------------------------------------------ numbers in words

_ORDINALS = "first second third fourth fifth sixth seventh eighth ninth tenth".split()
_NUMERALS = "one two three four five six seven eight nine ten".split()
_COUNTED = compiled(
    rf"\b({'|'.join(_ORDINALS)}|last) (?:option|action|one|answer)\b",
    r"\b(?:option|number|choice|action|answer) *(?:is\b|[:=])? *(?:number )?"
    rf"({'|'.join(_NUMERALS)})\b",
)


def _counted(match: re.Match[str], offered: Sequence[str]) -> str:
    if match[1] == "last":
        return offered[-1]
    index = _ORDINALS.index(match[1]) if match[1] else _NUMERALS.index(match[2])
    return offered[index] if index < len(offered) else NOT_OFFERED


# ------------------------------------------------------------------ a list of the text's own


def own_list(plain: str, find: Finder) -> Mapping[str, str]:
    """Return what the marks stand for in a text that lists options by marks of its own."""
    own: dict[str, str] = {}
    for match in _LISTED.finditer(plain):
        end = plain.find("\n", match.end())
        line = plain[match.end() : end if end >= 0 else len(plain)]
        named = find(line)
        if named and named[0].start <= 1:
            if own.get(match[1], named[0].option) != named[0].option:
                return {}
            own[match[1]] = named[0].option
    return own if len(own) > 1 else {}


_LISTED = re.compile(r"^\W*?[(\[]?(\d{1,2}|[a-z])[.):\]]+\s*(?=\S)", re.MULTILINE)

"""Finds reasons that are against the option that they stand beside, or that disown an answer."""

import re
import tomllib
from collections.abc import Sequence

from oodscen._io.files import bundled
from oodscen._words.prose import fold
from oodscen.judging._parsing.denials import denies, plain_words
from oodscen.judging._parsing.marking import GERUND, OPTION, number
from oodscen.judging._parsing.stated_option import CRASH


def is_against(plain: str, option: int | None = None) -> bool:
    """Return whether folded reasons deny or condemn an option, or disown the answer."""
    return bool(_CONDEMNED.fullmatch(plain)) or any(
        _DISOWNS.search(sentence)
        or any(map(_is_denied, _CLAUSE.finditer(_kinds(sentence, option))))
        for sentence in re.split(r"(?<=[.!?;])\s+|\n+", plain)
    )


def is_open(plain: str) -> bool:
    """Return whether plain words retract an answer or leave it open."""
    return bool(_OPEN.search(plain))


def disputes(words: str) -> bool:
    """Return whether words beside an answer may deny it, leave it open or give another one."""
    plain = plain_words(words)
    is_doubt = denies(plain) or is_open(plain) or _DISPUTING.search(plain)
    return bool(is_doubt) or is_against(fold(words))


def _kinds(sentence: str, option: int | None) -> str:
    """Return the kind of every word of a sentence, with `O` for the option; nothing for a question."""
    return "".join(
        "O" if word["P"] and number(word["P"]) == option else str(word.lastgroup)
        for word in (() if sentence.endswith("?") else _WORD.finditer(sentence))
    )


def _is_denied(clause: re.Match[str]) -> bool:
    """Return whether denials and bad words are odd in number, and nothing outweighs them."""
    edge, condition, before, after = clause.groups()
    rest = clause.string[clause.end() :]
    count = len(re.findall("b+|[nmu]", f"{before}O{after}"))
    is_open = (condition or before[:1] == "m") and not re.search("[bg]", after)
    is_admitted = "b" in before + after and (edge == "a" or "h" in rest) and "P" not in rest
    return count % 2 == 1 and not is_open and not is_admitted and rest[:1] not in ("i", "u", "t")


_BAD = (
    r"(?:an? |the )?(?:(?:(?!hardly)\w+ly|very|too|so|most) )?(?:dangerous|unsafe|forbidden|illegal|prohibited|wrong|incorrect|bad|worst|worse|fatal"
    r"|deadly|lethal|suicid\w+|impossible|reckless|out of the question|ruled out|terrible|stupid|mistake|no option|unnecessary|needless|pointless|false|lie|decoy|joke)"
)
_FILLINGS = {"{bad}": _BAD, "{crash}": CRASH, "{gerund}": GERUND, "{option}": OPTION}


def _kind(letter: str, words: Sequence[str]) -> str:
    """Return the pattern of a whole word of a kind, in a group of its letter."""
    pattern = "|".join(words)
    for name, filling in _FILLINGS.items():
        pattern = pattern.replace(name, filling)
    return rf"(?P<{letter}>(?:{pattern})(?!(?<=\w)[\w']))"


_TABLE = tomllib.loads(bundled("reasons.toml", "oodscen.judging._parsing"))
_OPEN = re.compile(rf"\b(?:{'|'.join(_TABLE['open'])})\b")
_DISPUTING = re.compile(rf"\b(?:{'|'.join(_TABLE['disputing'])})\b")
_WORD = re.compile("|".join(_kind(**kind) for kind in _TABLE["kind"]))
_GAP = "(?:[knu]|r[OPx])*"
_CLAUSE = re.compile(
    "(?:^|(?<=([ecah])))(?=([iu])?)((?:[kgbnmiu]|[OP]r|nc[kx]{1,6}c){0,99})O(?(2)c?)"
    f"(c{_GAP}(?=e|$)|(?:{_GAP}[bg])*(?:{_GAP}(?=[ecah]|$))?)"
)
"""Matches an option and the known words before and after it; the comma of "if we stop, we crash" ends no clause.

The limit on the words before it keeps the time linear in those of an answer."""
_CONDEMNED = re.compile(
    r"\W*(?:(?:(?:this|that|it) is )?(?:wrong|incorrect|false|a mistake|not (?:recommended|advisable|right|correct|true))|the opposite)\W*"
)
_IS = r"(?:is|was|are|(?:would|will|could|can|may|might) be|seems|looks)"
_NAMED = r"(?:answer|choice|action|option|decision|idea)"
_DISOWNS = re.compile(
    r"\A\W*(?:placeholder|example|n/?a|dummy|test|todo|tbd|no|not|nope|never|wrong|false)\W*\Z"
    r"|\A\W*(?:the |my )?answer (?:is )?(?:withheld|omitted|redacted)\b"
    r"|\b(?:this|it) is (?:only|just|merely) (?:an? )?(?:example|placeholder|test|template|dummy)\b"
    r"|\b(?:opposite of (?:what|my|this|the (?:answer|choice|action|option|decision))|just kidding|joking|i (?:lied|lie|am lying)"
    rf"|(?:this|the|my|that) {_NAMED}(?: below| field)? {_IS} (?:not (?:my|the)|{_BAD})"
    rf"|(?<!but )(?:this|that|it|what follows|the (?:above|below|following)) (?:would be {_BAD}(?! (?:not )?to\b| for\b)|{_IS} (?:not (?:my|what (?:i|we) (?:would|should))"
    rf"|{_BAD} {_NAMED}|an? (?:lie|mistake|decoy|joke)(?! (?:not )?to\b)))"
    r"|as an? (?:ai )?language model|i (?:cannot|can't|won't|will not|refuse to|decline to) (?:help|assist|comply|answer)"
    r"|(?:do not|don't|never) (?:do|use|take|choose|follow|trust) (?:this|that|it)|(?:ignore|disregard) (?:this|that|the (?:answer|action)))\b"
)
"""Matches a sentence that disowns the answer beside it, and placeholders for reasons."""

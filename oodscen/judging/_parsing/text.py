"""Removes reasoning, control tokens and markup from a model's answer."""

import re
import unicodedata

from oodscen.llm._json_objects import cleaned

LONGEST = 200_000
"""The longest answer that is parsed, in characters."""

TWO_ANSWERS = "two answers"


class UnusableError(ValueError):
    """An answer has the requested member, but with no usable value or with two."""


def spoken(text: str) -> str:
    """Return the text outside the reasoning; reasoning that never ends leaves no answer."""
    text = _CONTROL_TOKENS.sub(" ", _FINAL_CHANNEL.sub("</think>", text))
    kept: list[str] = []
    depth = start = 0
    for mark in _THINKING.finditer(text):
        if mark[1]:  # an end tag without a start tag: everything before it was reasoning
            kept, depth = kept if depth else [], 0
        else:
            kept += [] if depth else [text[start : mark.start()]]
            depth = 1
        start = mark.end()
    return "\n".join([*kept, "" if depth else text[start:]]).strip()


_THINKING = re.compile(
    r"[<\[\u25c1](/)?\s?(?:think|thinking|thought|reasoning|reflection|scratchpad|analysis)\s?[>\]\u25b7]",
    re.IGNORECASE,
)
_FINAL_CHANNEL = re.compile(r"<\|channel\|>\s?final\s?<\|message\|>")
_CONTROL_TOKENS = re.compile(r"<\|[a-z_]{1,30}\|>|</?s>|\[/?INST\]")


def tidied(text: str) -> str:
    """Return prose without markup: one form of quotes and spaces, `name: value` for XML elements.

    Text that is struck through is dropped, and so are private-use characters, which stand for options elsewhere.
    """
    text = unicodedata.normalize("NFKC", cleaned(text))
    text = _INVISIBLE.sub("", text)
    text = _STRUCK.sub(" ", text)
    text = _LATEX.sub(r"\1", text)
    text = _LATEX.sub(r"\1", text.replace("\\_", "_"))
    text = re.sub(r"\\boxed\s*\{([^{}\n]*)\}", r" answer: \1 ", text)
    text = _ELEMENT.sub(r"\n\1: ", text)
    text = re.sub(r"</\w{1,30}>|<br ?/?>", "\n", text)
    text = re.sub(r"[\u2018\u2019\u02bc]", "'", text)
    text = _MARKUP.sub(" ", text)
    text = re.sub(r"(?<!\w)'|'(?!\w)", " ", text)
    text = re.sub(r"^[^\S\n]*[-+\u2022][^\S\n]*(?=[^\W\d])", "\u2022 ", text, flags=re.MULTILINE)
    text = re.sub(r"[^\S\n]+", " ", text)
    return re.sub(r" ?\n[\n ]*", "\n", text).strip()


_INVISIBLE = re.compile(
    "[\u200b-\u200f\u2060\ufeff\u00ad\ufe0f\u20e3\ue000-\uf8ff\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ufffd]"
)
_STRUCK = re.compile(r"~~[^~\n]{0,200}~~|<(del|strike)>[^<\n]{0,200}</\1>")
_LATEX = re.compile(r"\\(?:text(?:bf|tt|rm)?|math(?:rm|bf|tt))\s*\{([^{}\n]*)\}")
_ELEMENT = re.compile(r"<(\w{1,30})>(?=[^<]{1,2000}</\1>)")
_MARKUP = re.compile(
    r"[*`\"#>$\[\]{}\u201c\u201d\u00ab\u00bb]"
    r"|(?![\u26d4\u274c\u274e\u2716-\u2718\U0001f44e\U0001f600-\U0001f64f\U0001f6ab\U0001f910-\U0001f97a])"
    r"[\u2600-\u27bf\U0001f300-\U0001faff]"
)


def folded(tidy: str) -> str:
    """Return tidied prose in lower case, with spaces for underscores and hyphens in words."""
    text = _CAMEL_CASE.sub(" ", tidy).casefold().replace("_", " ")
    text = re.sub(r"(?<=[a-z])[-\u2010\u2011](?=[a-z])", " ", text)
    return re.sub(r" +", " ", text).strip()


_CAMEL_CASE = re.compile(r"(?<=[a-z])(?=[A-Z])")

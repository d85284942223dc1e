"""Removes reasoning, control tokens and markup from a model's answer."""

import re
import unicodedata

from oodscen.llm._json_objects import clean_surrogates

LONGEST = 200_000
"""The longest answer that is parsed, in characters."""

TWO_ANSWERS = "two answers"


class UnusableError(ValueError):
    """An answer that must not be read, with the reason."""


def after_reasoning(text: str) -> str:
    """Return the text after the reasoning; empty if there is reasoning anywhere but at the start."""
    text = _CONTROL_TOKENS.sub(" ", _FINAL_CHANNEL.sub("</think>", text))
    marks = list(_THINKING.finditer(text))
    ends = [mark.end() for mark in marks if mark["ends"]]
    if not ends:
        return "" if marks else text.strip()
    first = marks[0]
    is_first = bool(first["ends"]) or not text[: first.start()].strip()
    return text[ends[-1] :].strip() if is_first and marks[-1]["ends"] else ""


_THINKING = re.compile(
    r"[<\[\u25c1](?P<ends>/)?\s?(?:think|thinking|thought|reasoning|reflection|scratchpad|analysis)\s?[>\]\u25b7]",
    re.IGNORECASE,
)
_FINAL_CHANNEL = re.compile(r"<\|channel\|>\s?final\s?<\|message\|>")
_CONTROL_TOKENS = re.compile(r"<\|[a-z_]{1,30}\|>|</?s>|\[/?INST\]")


def tidy(text: str) -> str:
    """Return prose without emphasis, with one form of quotes and spaces, and `name: value` for headings and elements.

    Private-use characters are dropped, since they stand for options elsewhere.
    """
    text = unicodedata.normalize("NFKC", clean_surrogates(text))
    text = _INVISIBLE.sub("", text).replace("\\_", "_")
    text = _BOXED.sub(r" answer: \1 ", text)
    text = _ELEMENT.sub(r"\n\1: \2\n", text)
    text = re.sub(r"[\u2018\u2019\u02bc]", "'", text)
    text = re.sub(r"[*`\"\u201c\u201d]", " ", text)
    text = re.sub(r"(?<!\w)'|'(?!\w)", " ", text)
    text = re.sub(r"\s*\n\s*", "\n", re.sub(r"[^\S\n]+", " ", text)).strip()
    return re.sub(r"(?m)^#{1,6} ([^\n:]*):?(?=\n)", r"\1:", text)


_INVISIBLE = re.compile(
    "[\u200b-\u200f\u2060\ufeff\u00ad\ufe0f\ue000-\uf8ff\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ufffd]"
)
_BOXED = re.compile(r"\${0,2}\\boxed\s?\{(?:\\text\{)?([^{}\n]{0,200})\}{1,2}\${0,2}")
_ELEMENT = re.compile(r"<(\w{1,30})>([^<]{1,2000})</\1>")


def fold(tidy: str) -> str:
    """Return tidied prose in lower case, with spaces for underscores and hyphens in words."""
    text = _CAMEL_CASE.sub(" ", tidy).casefold().replace("_", " ")
    text = re.sub(r"(?<=[a-z])[-\u2010\u2011](?=[a-z])", " ", text)
    return re.sub(r" +", " ", text).strip()


_CAMEL_CASE = re.compile(r"(?<=[a-z])(?=[A-Z])")

"""What a text must be to serve as a label, and when two labels are the same.

A label comes from a model or a file, is shown in pages, charts and terminals, and goes into later
prompts. So it has to be plain words: no markup, nothing unseen, nothing that speaks to a model. What
speaks to a model cannot be listed in full; besides, prompts mark labels as data and answers are checked.
"""

import html
import re
import unicodedata

from oodscen._text import BLANK, is_visible, one_line

MAX_LABEL = 200
"""Longest label, in characters."""

_JOINERS = "\u200c\u200d"
"""Between letters these shape a word (Persian, Indic scripts)."""

_MARKUP = re.compile(r"<[a-z/!?]|javascript\s*:|```|~~~|\{\{|\}\}|\{%|%\}|\$\{", re.IGNORECASE)
"""A tag as HTML reads it, code fences, braces of templates; `< 10 cm` is none."""

_ORDERS = (
    r"(?:instructions?|prompts?|rules?|messages?|guidelines?|directions?|commands?|context|text)"
)
_ROLES = r"(?:system|assistant|developer|user|human)"
_ADDRESSED = tuple(
    re.compile(pattern, flags)
    for pattern, flags in (
        # "ignore all previous instructions", "disregard the rules above"
        (
            r"\b(?:ignore|disregard|forget|override)\b(?:\s+(?:all|any|every|of|the|your|my|these|those))*"
            rf"\s+(?:previous|prior|preceding|earlier|above|foregoing)\s+(?:\w+\s+)?{_ORDERS}\b",
            re.IGNORECASE,
        ),
        (
            r"\b(?:ignore|disregard|forget|override)\b(?:\s+(?:all|any|every|of|the|your|my|these|those))*"
            rf"\s+{_ORDERS}\s+(?:\w+\s+)?(?:above|before|so far|earlier|previously)\b",
            re.IGNORECASE,
        ),
        # as an order, at the start of a sentence: "Disregard your instructions"
        (
            r"(?:^|[.;!?]\s*)\W*(?:please\s+)?(?:ignore|disregard|forget|override)\s+"
            r"(?:(?:all|any|every|of|the|your|my|these|those)\s+)*"
            r"(?:instructions?|prompts?|guidelines?)\b",
            re.IGNORECASE,
        ),
        (r"\b(?:ignore|disregard|forget)\s+everything\b", re.IGNORECASE),
        # a role: "System: ...", "Fog. Assistant: ...", "Fog SYSTEM: ..."
        (rf"(?:^|[^\w\s-]\s*){_ROLES}\s*:", re.IGNORECASE),
        (rf"\b{_ROLES.upper()}\s*:", 0),
        (
            rf"\b{_ROLES}\s*:\s*(?:you|answer|respond|reply|output|return|say|always|never)\b",
            re.IGNORECASE,
        ),
        # marks of chat templates
        (r"<\||\|>|\[/?INST\]|<<\s*/?SYS\s*>>|^\s*#+\s*(?:instruction|system|response)", re.I),
        (r"\byou are (?:now|an? (?:ai|assistant|language model|chatbot))\b", re.IGNORECASE),
        (r"\b(?:new|updated) instructions?\s*:|\bsystem prompt\b", re.IGNORECASE),
    )
)
"""Few and general; labels about driving such as "Driver ignores a red light" match none."""


def label_fault(label: str) -> str:
    """Say why a text cannot be a label, or return an empty string.

    Refused are: nothing to see, more than `MAX_LABEL` characters, line breaks and control characters,
    characters that show nothing or turn the direction of writing (joiners between letters may stay),
    tags, HTML entities, code fences and template braces, and words that speak to a model.
    """
    if not is_visible(label):
        return "the label is empty"
    if len(label) > MAX_LABEL:
        return f"the label has {len(label)} characters, at most {MAX_LABEL} are allowed"
    if label.isascii() and label.isprintable():
        text = label
    else:
        if any(unicodedata.category(char) in ("Cc", "Cs", "Zl", "Zp") for char in label):
            return "the label contains line breaks, control characters or halves of characters"
        if _has_unseen(label):
            return "the label contains characters that do not show or turn the direction of writing"
        text = _seen(label)
    if _MARKUP.search(text) or ("&" in text and html.unescape(text) != text):
        return "the label contains markup or code: plain words are wanted"
    text = one_line(text)
    if any(pattern.search(text) for pattern in _ADDRESSED):
        return "the label speaks to a model: plain words for a kind of scenario are wanted"
    return ""


def same_words(label: str) -> str:
    """Return what two labels share that differ only in case, width, spaces and what does not show."""
    return one_line(_seen(label).casefold())


def _has_unseen(label: str) -> bool:
    for index, char in enumerate(label):
        if unicodedata.category(char) != "Cf":
            continue
        around = label[index - 1 : index] if index else "", label[index + 1 : index + 2]
        is_joint = all(side and unicodedata.category(side)[0] in "LM" for side in around)
        if char not in _JOINERS or not is_joint:
            return True
    return False


def _seen(label: str) -> str:
    """Return the letters that show, in their common form."""
    if label.isascii():
        return label
    return "".join(
        char
        for char in unicodedata.normalize("NFKC", label)
        if char not in BLANK
        and unicodedata.category(char) != "Cf"
        and not ("\ufe00" <= char <= "\ufe0f" or char == "\u034f")
    )

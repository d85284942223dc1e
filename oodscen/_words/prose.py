"""A model's prose without reasoning, control tokens and markup, and the refusals in it."""

import re
import unicodedata

from oodscen._words.text import clean_surrogates


def without_thoughts(text: str) -> str:
    """Return what stands after reasoning that has ended; empty if it begins with reasoning that has not."""
    text = _one_spelling(text)
    marks = list(_THINKING.finditer(text))
    ends = [mark.end() for mark in marks if mark["ends"]]
    if ends:
        is_nested = len(marks) - len(ends) > len(ends)
        return "" if is_nested else text[ends[-1] :]
    is_open = bool(marks) and "{" not in text[: marks[0].start()]
    return "" if is_open else text


def after_reasoning(text: str) -> str:
    """Return the text after the reasoning; empty if there is reasoning anywhere but at the start."""
    text = _CONTROL_TOKENS.sub(" ", _one_spelling(text))
    marks = list(_THINKING.finditer(text))
    ends = [mark.end() for mark in marks if mark["ends"]]
    if not ends:
        return "" if marks else text.strip()
    first = marks[0]
    is_first = bool(first["ends"]) or not text[: first.start()].strip()
    return text[ends[-1] :].strip() if is_first and marks[-1]["ends"] else ""


def _one_spelling(text: str) -> str:
    """Return a text with the marks of chat templates around reasoning as `<think>` and `</think>`."""
    return _ENDS.sub("</think>", _BEGINS.sub("<think>", text))


_THINKING = re.compile(
    r"[<\[\u25c1](?P<ends>/)?\s?(?:\w{1,20}:)?(?:think|thinking|thought|reasoning|reflection|scratchpad|analysis)"
    r"(?:\s[^<>\[\]{}]{0,80})?\s?[>\]\u25b7]",
    re.IGNORECASE,
)
_BEGINS = re.compile(
    r"<\|begin_of_thought\|>|<\|channel\|>\s?(?:analysis|commentary)\s?<\|message\|>"
)
_ENDS = re.compile(r"<\|end_of_thought\|>|<\|channel\|>\s?final\s?<\|message\|>")
_CONTROL_TOKENS = re.compile(r"<\|[a-z_]{1,30}\|>|</?s>|\[/?INST\]")


def tidy(text: str) -> str:
    """Return prose without emphasis, with one form of quotes and spaces, and `name: value` for headings and elements.

    Private-use characters are dropped, since they stand for options elsewhere.
    """
    text = unicodedata.normalize("NFKC", clean_surrogates(text))
    text = _INVISIBLE.sub("", text).replace("\\_", "_")
    # What most texts lack is looked for before patterns that try every place.
    if "\\boxed" in text:
        text = _BOXED.sub(r" answer: \1 ", text)
    text = _ELEMENT.sub(r"\n\1: \2\n", text).translate(_QUOTES)
    if "'" in text:
        text = _OUTER_APOSTROPHE.sub(" ", text)
    text = _BLANKS.sub(" ", text)
    if "\n" in text:
        text = _LINE_END.sub("\n", text)
    text = text.strip()
    return _HEADING.sub(r"\1:", text) if "#" in text else text


_INVISIBLE = re.compile(
    "[\u200b-\u200f\u2060\ufeff\u00ad\ufe0f\ue000-\uf8ff\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ufffd]"
)
_QUOTES = str.maketrans('\u2018\u2019\u02bc*`"\u201c\u201d', "'''     ")
"""Typographic apostrophes as plain ones; quotes and marks of emphasis as blanks."""
_OUTER_APOSTROPHE = re.compile(r"(?<!\w)'|'(?!\w)")
_BLANKS = re.compile(r"[^\S\n]+")
_LINE_END = re.compile(r"\s*\n\s*")
_HEADING = re.compile(r"(?m)^#{1,6} ([^\n:]*):?(?=\n)")
_BOXED = re.compile(r"\${0,2}\\boxed\s?\{(?:\\text\{)?([^{}\n]{0,200})\}{1,2}\${0,2}")
_ELEMENT = re.compile(r"<(\w{1,30})>([^<]{1,2000})</\1>")


def fold(tidy: str) -> str:
    """Return tidied prose in lower case, with spaces for underscores and hyphens in words."""
    text = _CAMEL_CASE.sub(" ", tidy).casefold().replace("_", " ")
    text = re.sub(r"(?<=[a-z])[-\u2010\u2011](?=[a-z])", " ", text)
    return re.sub(r" +", " ", text).strip()


_CAMEL_CASE = re.compile(r"(?<=[a-z])(?=[A-Z])")


def is_refusal(text: str) -> bool:
    """Return whether a model declines to answer, or cannot see the picture."""
    return bool(_REFUSAL.search(fold(tidy(after_reasoning(text[:20_000])))))


_CANNOT = (
    r"\bi(?:'m| am| have decided)? (?:\w+ )?(?:can ?not|can't|won't|will not|do not|don't|unable to|not able to"
    r"|not (?:allowed|permitted|comfortable) to|not to|decline to|refuse to)"
)
_PICTURES = r"(?:image|picture|frame|photo|video|attachment)s?"
_REFUSAL = re.compile(
    rf"{_CANNOT} (?:(?!know |have |think )\w+ ){{0,2}}(?:assist|help|comply|answer|respond|feel comfortable)\b(?! but\b)"
    rf"|{_CANNOT} (?:choose|provide|give|make|tell|offer) (?:an?|any|you|driving|guidance|real)\b"
    rf"|{_CANNOT} (?:\w+ )?(?:view|see|access|describe|analy[sz]e|identify) (?:\w+ ){{0,4}}{_PICTURES}\b(?! (?:well|clearly)\b)"
    rf"|\bi have no access to (?:\w+ )?{_PICTURES}|\bi (?:must|have to) decline\b|\bas an? (?:ai )?language model\b"
)


def declines_to_write(text: str) -> bool:
    """Return whether words that stand for a text decline to be one; a driver's own "I cannot stop in time" does not."""
    return bool(_UNWRITTEN.search(fold(tidy(text[:20_000]))))


_UNWRITTEN = re.compile(
    r"^\W*(?:(?:unfortunately|sorry|i am sorry|i'm sorry|i apologi[sz]e|(?:my )?apologies|regrettably)\b[\s,.;:-]*(?:but )?)*"
    rf"{_CANNOT} (?:\w+ ){{0,2}}(?:write|describe|create|generate|produce|compose|depict|fulfill?"
    r"|provide (?:an?|any|further|more|such|that|this))\b"
    r"|\b(?:against|violat\w+|breach\w*) (?:\w+ ){0,2}(?:(?:content|usage|safety|use) (?:policy|guidelines)|policies|guidelines)\b"
)


def is_disowned(before: str, after: str) -> bool:
    """Return whether the words right before or after something say that it is not meant: "not this: ...", "~~...~~"."""
    return bool(_DENIED_AHEAD.search(before[-80:]) or _DENIED_BEHIND.match(after[:80]))


_DENIED_AHEAD = re.compile(
    r"(?:~~|(?:\bnot|n['\u2019]t|\bnever|\bwrong|\bincorrect|\binvalid|\binstead of|\brather than|\bbad)"
    r"(?: (?:be|this|that|it|the|an?|answer|output|give|say|write|example|object|json)){0,4})[\s:*_`\"'(]*(?:json)?\s*$",
    re.IGNORECASE,
)
_DENIED_BEHIND = re.compile(
    r"[\s`*_)\"'.,;:\u2013\u2014-]*(?:~~|(?:(?:this|that|it|which|the (?:above|answer|object)) )?"
    r"(?:(?:(?:is|was|would be)(?: not|n['\u2019]t)) (?:(?:the|my|an?) )?(?:answer|right|correct|valid|true|it|so|meant)"
    r"|(?:is|was|would be) (?:wrong|incorrect|invalid|false)|wrong)\b(?!-\w))",
    re.IGNORECASE,
)


def is_taken_back(after: str) -> bool:
    """Return whether words behind something correct it: "Wait, actually ...", "Correction: number 1 is 3"."""
    return bool(_SECOND_THOUGHT.search(after))


_SECOND_THOUGHT = re.compile(
    # The beginning of a sentence, and words that only lead up to it.
    r"(?:^|[.!?:;\n\u2013\u2014-])[\s>*_`#\"'(\[]{0,8}+"
    r"(?:(?:oh|ah|well|but|so|no|hmm+|ok|okay|please|sorry|apologies|my apologies|i(?:'|\u2019| a)m sorry)\b[\s,.!:\u2026\u2013\u2014-]{1,4}){0,3}"
    r"(?:wait\b(?:\s*(?:[,!\u2026\u2013\u2014]|\.\.|\s-\s)|\s+(?:no|actually)\b)(?!\s*(?:then|until|and|for)\b)"
    r"|hold on\s*[,.!\u2026\u2013\u2014]|(?:oops|whoops|(?:scratch|strike) that|never ?mind)\b"
    r"|(?:hmm+|no|oh)[,.\u2026]{1,3}\s+(?:no|wait|actually)\b"
    r"|(?:disregard|ignore|forget) (?:(?:that|this|it)\s*[.,;:!]|(?:the|my) (?:above|previous|earlier|first|last)\b)"
    r"|(?:correction|corrected|erratum|edit)\b(?:[^.:!?\n{]{0,40}:|\s*[\u2013\u2014]|\s+-\s)(?!\s*(?:```\w*\s*)?\{)"
    r"|(?:on|upon|after) (?:second thoughts?|(?:further )?(?:reflection|reconsideration))\b"
    r"|my (?:mistake|bad|error)\b|i (?:was|am) (?:wrong|mistaken)\b|i (?:have )?made an? (?:mistake|error)\b"
    r"|i (?:have )?mis(?:read|took|taken|counted|stated|calculated|typed|judged|interpreted|understood)\b"
    r"|i (?:meant|retract|take (?:that|it) back|should have (?:said|written|put|given|answered))\b"
    r"|(?:i (?:need|have|want|must|would like) (?:to )?|let me )(?:correct|revise|amend|redo|restate|reconsider|rethink)\b"
    r"|(?:that|this|it|the (?:above|answer|object|first|json)|my answer)(?:'s|\u2019s| is| was) "
    r"(?:wrong|incorrect|mistaken|not (?:right|correct)|a mistake|an error)(?=\s*(?:[.,;:!\u2013\u2014]|$))"
    r"|actually\b[^.!?\n]{0,200}(?:\b(?:should|instead)\b|(?:\b(?:is|be|are)|[=:>])\s*-?\d)"
    r"|sorry\b[^.!?\n]{0,200}\b(?:should (?:be|read|have been)|meant|instead of)\b"
    r"|(?:number|text|entry|item|estimate|the (?:first|second|third|last|answer|best|estimate))\b[^.!?\n]{0,40}"
    r"\bshould (?:be|read|have been)[\s:\"'`]{1,3}-?\d)",
    re.IGNORECASE,
)

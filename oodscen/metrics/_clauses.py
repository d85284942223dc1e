"""Splits a text into clauses, so that an event is scored apart from its setting."""

import re

_CUT = re.compile(
    r"[.;:,?!]\s+|\s[-\u2013\u2014]\s"
    r"|\s(?=(?:and|but|while|as|where|which|who|because|so|when|before|after|until|behind|towards"
    r"|with|without)\s)"
)
_MOST = 64


def clauses(text: str) -> tuple[str, ...]:
    """Split a text at punctuation and before conjunctions; parts of one word are dropped.

    Returns:
        At least one and at most 64 parts; the text itself if it cannot be split.
    """
    parts = [part.strip(" .,;:?!\t\n") for part in _CUT.split(text)]
    found = tuple(part for part in parts if len(part.split()) > 1)
    return found[:_MOST] or (text,)

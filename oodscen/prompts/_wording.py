"""The rule for the words of a scenario: a description, and nothing that a reader or a model could take for more."""

import re

from oodscen._prose import is_refusal
from oodscen._text import one_line
from oodscen.tree._labels import wording_fault


def text_fault(text: str) -> str:
    """Return why words cannot be the text of a scenario, or an empty string."""
    if is_refusal(text):
        return "is a refusal: describe a situation in traffic"
    if _LISTED.match(text):
        return "begins with the number or mark of a list: leave that out"
    return wording_fault(one_line(text), "the text")


_LISTED = re.compile(r"\s*(?:\d{1,3}[.)]|[-*\u2022])\s")

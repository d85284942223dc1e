"""Parses the answers of judged models: JSON first, then the one option that plain English prose states.

The parser never guesses. An answer that two people could read differently is `unparsed`, and the model is asked
once more.
"""

from oodscen._words.prose import is_refusal
from oodscen.judging._parsing.aspects import Detected, names_nothing, read_aspect, read_named_aspect
from oodscen.judging._parsing.choices import contradiction, read_action, read_choice
from oodscen.judging._parsing.descriptions import read_description
from oodscen.judging._parsing.reading import ParsedAnswer

__all__ = [
    "Detected",
    "ParsedAnswer",
    "contradiction",
    "is_refusal",
    "names_nothing",
    "read_action",
    "read_aspect",
    "read_choice",
    "read_description",
    "read_named_aspect",
]

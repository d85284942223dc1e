"""Rules for labels, and the comparison of labels; their wording is that of `oodscen._words.wording`."""

import re
import unicodedata

from oodscen._words.text import is_visible, one_line
from oodscen._words.wording import is_left_out, seen, wording_fault

CLASSES = ("Environmental", "Interactional")
"""Labels of the two classes of OOD scenarios (paper, section III-A)."""
MAX_LABEL = 200
"""Length of the longest label, in characters."""


def label_fault(label: str) -> str:
    """Return why a text cannot be a label, or an empty string.

    The following are refused: nothing visible, placeholders such as `null` or `NA`, words that nothing is unusual,
    more than `MAX_LABEL` characters, line breaks and control characters, characters that are invisible or change the
    direction of writing (joiners between letters are allowed), tags, HTML entities, code fences and template braces,
    words that mix two alphabets or use look-alike letters, and instructions to a model.
    """
    if not is_visible(label):
        return "the label is empty"
    if is_left_out(label):
        return f"the label is {label.strip()!r}, which names nothing"
    if len(label) > MAX_LABEL:
        return f"the label has {len(label)} characters, at most {MAX_LABEL} are allowed"
    fault = wording_fault(label)
    return f"the label {fault}" if fault else ""


def same_words(label: str) -> str:
    """Return a key that is equal for labels that differ only in case, width, spaces and invisible characters."""
    folded = seen(label).casefold()
    return one_line(unicodedata.normalize("NFKC", folded))


def slug(label: str, longest: int = 48) -> str:
    """Turn a label into an id that is safe in file names and URLs, cut to a number of characters."""
    plain = unicodedata.normalize("NFKD", label).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", plain)[:longest].strip("-") or "node"

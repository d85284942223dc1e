"""Makes text from outside safe for files, pages and terminals, and reduces words to their stems."""

import os
import re
import sys
import unicodedata
from collections.abc import Mapping, Sequence
from functools import lru_cache

CHARACTERS_PER_TOKEN = 4
"""Characters per token of English text, about."""

_LONE_SLASHES = re.compile(r"(?<!\S)/+(?!\S)")

_HALVES = re.compile("[\ud800-\udfff]")

_UNSEEN = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Control characters except tabs and line breaks, and characters that change the writing direction."""

BLANK = "\u115f\u1160\u2800\u3164\uffa0"
"""Letters and symbols without a visible glyph."""


def whole(text: str) -> str:
    """Replace lone surrogates, which UTF-8 cannot encode; valid pairs are joined."""
    if not _HALVES.search(text):
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def clean_surrogates(text: str) -> str:
    """Replace lone surrogates, escaped or not."""
    joined = whole(text)
    if "\\" not in joined:
        return joined
    return _ESCAPE.sub(lambda match: "\\ufffd" if match[1] else match[0], joined)


_ESCAPE = re.compile(
    r"\\(?:u[dD][89abAB][0-9a-fA-F]{2}\\u[dD][c-fC-F][0-9a-fA-F]{2}|u([dD][89a-fA-F][0-9a-fA-F]{2})|.)",
    re.DOTALL,
)
"""An escape in a JSON string; its group matches a lone surrogate."""


def text_fault(word: str) -> str:
    """Return the reason why a word from the command line or a terminal is no text, with the word; empty if it is.

    Where the locale's encoding has no such characters, Python keeps the bytes as lone surrogates.
    """
    shown, fault = word, ""
    if whole(word) != word:
        try:
            shown = os.fsencode(word).decode("utf-8")
            encoding = sys.getfilesystemencoding()
            fault = f"has characters that the locale's encoding, {encoding}, cannot hold; set LC_ALL=C.UTF-8"
        except UnicodeError:
            fault = "is not valid UTF-8"
    elif "\0" in word:
        fault = "holds a null character"
    return f"{one_line(printable(shown))[:100]!r} {fault}" if fault else ""


def without_possessives(text: str) -> str:
    """Return a text without the endings of "driver's" and "it's"; quoted words stay whole."""
    return re.sub(r"(?<=\w)['\u2019]s\b", "", text)


def folded_words(text: str) -> str:
    """Return a text without case and punctuation, for comparisons; spellings of one accent are equal."""
    plain = unicodedata.normalize("NFC", text.casefold())
    if plain.isascii():
        return one_line(_BETWEEN_WORDS.sub(" ", plain))
    return one_line("".join(char if _is_in_a_word(char) else " " for char in plain))


_BETWEEN_WORDS = re.compile(r"[^a-z0-9]+")


def _is_in_a_word(char: str) -> bool:
    """Return whether a character is a letter, a digit, or a vowel sign or accent of one."""
    if char.isascii() or char.isalnum():
        return char.isalnum()
    return unicodedata.category(char) in ("Mn", "Mc") and not "\ufe00" <= char <= "\ufe0f"


def printable(text: str) -> str:
    r"""Escape characters that could control a terminal, e.g. as `\u001b`; tabs and line breaks stay."""
    return _UNSEEN.sub(lambda match: f"\\u{ord(match[0]):04x}", whole(text))


def one_line(text: str) -> str:
    """Return the text on one line: runs of white space become single spaces, and the ends are stripped."""
    return " ".join(text.split())


def first_few(names: Sequence[str]) -> str:
    """Return the first five names with commas between them, and an ellipsis for the rest."""
    listed = ", ".join(names[:5])
    return f"{listed}, ..." if len(names) > 5 else listed


def path_name(labels: Sequence[str]) -> str:
    """Return the labels of a path, joined so that no other path has the same name.

    A slash that stands between blanks within a label is doubled.
    """
    return " / ".join(_LONE_SLASHES.sub(r"\g<0>/", label) for label in labels)


def is_visible(text: str) -> bool:
    """Return whether the text has at least one visible character."""
    return any(unicodedata.category(char)[0] in "LNPS" and char not in BLANK for char in text)


def is_name(text: str) -> bool:
    """Return whether a text is visible and on one line, without halves and what could control a terminal."""
    return is_visible(text) and printable(text) == text and not _BREAK.search(text)


_BREAK = re.compile("[\t\n\u2028\u2029]")


AMERICAN: Mapping[str, str] = {
    "centre": "center",
    "colour": "color",
    "grey": "gray",
    "kerb": "curb",
    "metre": "meter",
    "plough": "plow",
    "tyre": "tire",
}
"""American spellings of British words about traffic."""
_BRITISH = {
    f"{american}{end}": f"{british}{end}"
    for british, american in AMERICAN.items()
    for end in ("", "s")
}


def stem(word: str) -> str:
    """Return the stem that the inflections and spellings of an English word share: `block` for `blocked`.

    Args:
        word: A single word in lower case.
    """
    return inflection_stem(_BRITISH.get(word, word))


@lru_cache(maxsize=65_536)
def inflection_stem(word: str) -> str:
    """Return the stem that the inflections of an English word share, whatever its spelling.

    Args:
        word: A single word in lower case.
    """
    # The package loads the rules of every language, so it is imported only where words are compared.
    import snowballstemmer

    # A stemmer holds the word that it works on, and other threads may be at work.
    return str(snowballstemmer.stemmer("english").stemWord(word))

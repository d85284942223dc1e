"""Names of the ego vehicle in texts.

Events and openings are written with `the ego vehicle` and `the ego's`; each text uses a single name
throughout.
"""

import re
from typing import Literal

Name = Literal["the ego vehicle", "ego", "the ego car", "I"]

_POSSESSIVE = re.compile(r"\b([Tt])he ego(?: vehicle)?'s( (?:own )?lane\b)?")
_VEHICLE = re.compile(r"\b([Tt])he ego vehicle\b")
_TO_ME = re.compile(
    r"\b(in front of|ahead of|behind|towards|past|beside|alongside|around|straight at) the ego vehicle\b"
    r"(?! (?:as|itself)\b)",
    re.IGNORECASE,
)
_ITS_LANE = re.compile(r"(\bme (?:in|inside|into|across|down)) its( own)? lane\b")
_INTO_ITS_PATH = re.compile(r"(\bme\b[^.,;]{0,40}\binto) its path\b")
_SUBJECT = re.compile(r"\b[Tt]he ego vehicle (is|has|was|drives|travels|moves|proceeds|heads)\b")
_NOT_SUBJECT = re.compile(
    r"\b(?:of|and|at|to|from|with|for|on|by|into|between|than) $", re.IGNORECASE
)


def with_ego_named(text: str, name: Name) -> str:
    """Return a text with the ego vehicle renamed; `I` makes the driver the narrator."""
    if name == "ego":
        text = _POSSESSIVE.sub(lambda m: _capitalised_like(m[1], f"ego's{m[2] or ''}"), text)
        return _VEHICLE.sub(lambda m: _capitalised_like(m[1], "ego"), text)
    if name == "the ego car":
        text = _POSSESSIVE.sub(
            lambda m: _capitalised_like(
                m[1], "the ego lane" if m[2] == " lane" else f"the ego car's{m[2] or ''}"
            ),
            text,
        )
        return _VEHICLE.sub(lambda m: _capitalised_like(m[1], "the ego car"), text)
    if name == "I":
        return _by_driver(text)
    return text


def _capitalised_like(first: str, words: str) -> str:
    """Match the capitalisation of the words that are replaced."""
    return words[0].upper() + words[1:] if first.isupper() else words


def _by_driver(text: str) -> str:
    text = _POSSESSIVE.sub(lambda m: _capitalised_like(m[1], f"my{m[2] or ''}"), text)
    text = _TO_ME.sub(r"\1 me", text)
    text = _ITS_LANE.sub(r"\1 my\2 lane", text)
    text = _INTO_ITS_PATH.sub(r"\1 my path", text)
    if " its " not in text and " it " not in text:
        text = _SUBJECT.sub(lambda m: _first_person_clause(m, text), text)
    return _VEHICLE.sub(lambda m: _capitalised_like(m[1], "my car"), text)


def _first_person_clause(match: re.Match[str], text: str) -> str:
    if _NOT_SUBJECT.search(text[: match.start()]):
        return match[0]
    return f"I {_first_person(match[1])}"


_EGO_AND_VERB = re.compile(r"(?:^|(?<=, and )|(?<=while ))the ego vehicle (\w+)", re.IGNORECASE)
_EGOS = re.compile(r"\b[Tt]he ego vehicle's\b")
_ITS = re.compile(r"\bits\b")


def clause_with_ego_named(clause: str, name: Name) -> str:
    """Return a clause about the ego vehicle with the ego renamed; unlike `with_ego_named`, `I` also replaces `its`."""
    if name != "I":
        return with_ego_named(clause, name)
    if clause.casefold().startswith("the ego vehicle "):
        clause = _ITS.sub("my", clause)
    clause = _EGOS.sub("my", clause)
    clause = _EGO_AND_VERB.sub(lambda m: f"I {_first_person(m[1])}", clause)
    return _VEHICLE.sub("me", clause)


def _first_person(verb: str) -> str:
    """Return the form of a verb that follows `I`."""
    irregular = {"has": "have", "is": "am", "was": "was"}
    return irregular.get(verb, re.sub(r"(?<=ss|go)es$|s$", "", verb))

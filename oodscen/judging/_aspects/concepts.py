"""The table of concepts, and the search for its expressions in a text."""

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib import resources
from typing import Any, Literal, get_args

from oodscen._wording import is_left_out
from oodscen.claims._cancelled import describes_noun, is_weather_cancelled

Kind = Literal["odd", "ordinary", "state", "act", "place", "aside"]
"""The kinds of concept; `concepts.toml` explains them."""

WIDEST_GAP = 3
"""The most words that "*" in an expression can match."""


@dataclass(frozen=True)
class Concept:
    """One entry of the table."""

    name: str
    kind: Kind
    expressions: tuple[str, ...]
    wider: tuple[str, ...] = ()
    """The broader concepts that this one is a kind of."""
    implied: str = ""
    """For a state: the thing that it describes if the text names none."""


@dataclass(frozen=True)
class Naming:
    """The concepts and words found in a text."""

    concepts: tuple[Concept, ...]
    """Every concept named, ordered by its first word; denied ones are excluded."""
    heads: tuple[Concept, ...]
    """The things that the text is about: those named before its first preposition, state or act."""
    words: tuple[str, ...]
    """All words, normalised to the forms used in the table."""
    rest: tuple[str, ...]
    """The words outside any expression, without prepositions."""


@cache
def concepts() -> Mapping[str, Concept]:
    """Return the table of concepts, by name.

    Raises:
        ValueError: If an entry refers to a concept that is not in the table.
    """
    table = _table()
    kinds: tuple[Kind, ...] = get_args(Kind)
    found = {
        name: Concept(
            name,
            kind,
            (*([name] if kind != "aside" else []), *expressions),
            tuple(table["wider"].get(name, ())),
            table["implied"].get(name, ""),
        )
        for kind in kinds
        for name, expressions in table[kind].items()
    }
    named = {*table["wider"], *table["implied"], *table["implied"].values()}
    named |= set(table["unseen"]["concepts"])
    unknown = named.union(*table["wider"].values()) - set(found)
    if unknown:
        raise ValueError(f"no such concept: {', '.join(sorted(unknown))}")
    return found


@cache
def _table() -> dict[str, dict[str, Any]]:
    source = resources.files("oodscen.judging._aspects").joinpath("concepts.toml")
    return tomllib.loads(source.read_text(encoding="utf-8"))


@cache
def seen_label(label: str) -> str:
    """Return a label without the words for what no frame shows: "Sudden police checkpoint" loses "Sudden".

    A label of which nothing that names something would be left stays as it is.
    """
    words = sorted(_table()["unseen"]["words"], key=len, reverse=True)
    pattern = r"\b(?:" + "|".join(map(re.escape, words)) + r")\b,?"
    left = " ".join(re.sub(pattern, " ", label, flags=re.IGNORECASE).split())
    if not re.search(r"\w", left) or is_left_out(left):
        return label
    return left[:1].upper() + left[1:]


@lru_cache(maxsize=4096)
def visible_naming(text: str) -> Naming:
    """Return what a label names that frames can show.

    A concept that cannot be seen gives way to what it is a kind of: an angry person to a person.
    """
    whole, hidden = naming_of(text), set(_table()["unseen"]["concepts"])

    def shown(found: Sequence[Concept]) -> tuple[Concept, ...]:
        names: list[str] = []
        for concept in found:
            names += concept.wider if concept.name in hidden else [concept.name]
        return tuple(concepts()[name] for name in dict.fromkeys(names))

    return Naming(shown(whole.concepts), shown(whole.heads), whole.words, whole.rest)


@cache
def with_broader(name: str) -> frozenset[str]:
    """Return the names of a concept and of all its broader concepts."""
    found, ahead = set[str](), [name]
    while ahead:
        one = ahead.pop()
        if one not in found:
            found.add(one)
            ahead.extend(concepts()[one].wider)
    return frozenset(found)


@lru_cache(maxsize=4096)
def naming_of(text: str) -> Naming:
    """Return what a text names; if several expressions start at the same word, the longest wins."""
    words, parts = _split(_without_past_weather(text))
    found: list[tuple[int, Concept]] = []
    used: set[int] = set()
    for start in range(len(words)):
        for expression, concept in _index().get(words[start], ()):
            places = _places(expression, words, start)
            if places and not used.intersection(places):
                used.update(places)
                found.append((start, concept))
                break
    stated = [(start, one) for start, one in found if one.kind != "aside"]
    denied = _denied(words, parts, used, [start for start, _ in stated])
    stated = [(start, one) for start, one in stated if start not in denied]
    return Naming(
        tuple(one for _, one in stated),
        tuple(_heads(stated, words, used)),
        tuple(words),
        tuple(one for i, one in enumerate(words) if i not in used and one not in _LINKS),
    )


# ------------------------------------------------------------------ expressions in a text


def _places(expression: Sequence[str], words: Sequence[str], start: int) -> tuple[int, ...]:
    """Return the positions of an expression's words when it begins at `start`; empty if it does not match."""
    places: list[int] = []
    at, gap = start, 0
    for word in expression:
        if word == "*":
            gap = WIDEST_GAP
            continue
        at = next((i for i in range(at, min(at + gap + 1, len(words))) if words[i] == word), -1)
        if at < 0:
            return ()
        places.append(at)
        at, gap = at + 1, 0
    return tuple(places)


def _denied(
    words: Sequence[str], parts: Sequence[int], used: set[int], starts: Sequence[int]
) -> set[int]:
    """Return the start positions of denied concepts, as in "no deer" or "a deer is not there"."""
    first: dict[int, int] = {}
    wholly: set[int] = set()
    last = {parts[start]: start for start in starts}
    for index, word in enumerate(words):
        if word in _DENIALS and index not in used:
            first.setdefault(parts[index], index)
            if word in ("not", "never") and last.get(parts[index], -1) < index:
                wholly.add(parts[index])
    return {
        start
        for start in starts
        if parts[start] in wholly or start > first.get(parts[start], len(words))
    }


_DENIALS = frozenset({"no", "not", "without", "never", "neither", "nor", "free", "absence"})


def _heads(
    stated: Sequence[tuple[int, Concept]], words: Sequence[str], used: set[int]
) -> Iterator[Concept]:
    things = [(start, concept) for start, concept in stated if concept.kind in ("odd", "ordinary")]
    if not things:
        return
    first = things[0][0]
    ends = [i for i, word in enumerate(words) if i > first and i not in used and word in _LINKS]
    ends += [
        start for start, concept in stated if start > first and concept.kind in ("state", "act")
    ]
    end = min(ends, default=len(words))
    starts = {start for start, _ in things}
    # In "truck tyre" the truck only says which tyre.
    yield from (
        concept
        for start, concept in things
        if start < end and (concept.kind == "odd" or start + 1 not in starts)
    )


_LINKS = frozenset(
    """
    about above across after against ahead along around at before behind below beside between by
    down during for from in inside into near off on onto out outside over past round since that
    through to toward towards under until up when where which while who with
    """.split()
)

# ------------------------------------------------------------------ words


def _without_past_weather(text: str) -> str:
    """Return a text without weather that is over, or that only describes a thing: a snow plough."""
    return _weather().sub(
        lambda match: "-" if _is_cancelled(text, match.end()) else match.group(0), text
    )


def _is_cancelled(text: str, end: int) -> bool:
    return is_weather_cancelled(text[end:]) or describes_noun(text, end)


@cache
def _weather() -> re.Pattern[str]:
    words = {word for name in _WEATHER for word in concepts()[name].expressions if word.isalpha()}
    return re.compile(rf"\b(?:{'|'.join(sorted(words, key=len, reverse=True))})\b", re.IGNORECASE)


_WEATHER = ("fog", "dust storm", "snow", "rain", "hail", "ice")


def _split(text: str) -> tuple[list[str], list[int]]:
    """Return a text's words in the table's form, and the number of the clause that holds each word."""
    text = text.casefold().replace("\u2019", "'").replace("n't", " not").replace("'s", "")
    words: list[str] = []
    parts: list[int] = []
    for number, part in enumerate(re.split(r"[,;.:!?]|\b(?=and\b|but\b)", text)):
        found = re.findall(r"[^\W_]+", part)
        words += [_forms().get(word, word) for word in found]
        parts += [number] * len(found)
    return words, parts


@cache
def _forms() -> Mapping[str, str]:
    """Map every inflected form to the table's word: "stopping" to "stop"."""
    vocabulary = {
        word
        for concept in concepts().values()
        for expression in concept.expressions
        for word in re.findall(r"[^\W_]+", expression.casefold().replace("'s", ""))
    }
    found: dict[str, str] = {}
    for word in sorted(vocabulary, key=lambda one: (len(one), one)):
        base = found.get(word, word)
        for form in _inflected(word):
            found.setdefault(form, base)
    return found


def _inflected(word: str) -> Iterator[str]:
    yield word
    if len(word) < 3 or word in _LINKS or word in _RIGID:
        return
    is_open = word.endswith(("s", "x", "z", "ch", "sh"))
    yield word + ("es" if is_open else "s")
    if word.endswith("y") and word[-2] not in "aeiou":
        yield from (word[:-1] + "ies", word[:-1] + "ied")
    cut = word.removesuffix("e")
    yield from (cut + "ing", cut + "ed")
    if word[-1] not in "aeiouwxy" and word[-2] in "aeiou":
        yield from (word + word[-1] + "ing", word + word[-1] + "ed")


_RIGID = frozenset({"stag", "its", "was", "all", "the", "not", "red", "two", "box", "men"})
"""Words that must not be inflected: their inflected forms are other words, or do not exist."""


@cache
def _index() -> Mapping[str, Sequence[tuple[tuple[str, ...], Concept]]]:
    """Return the expressions by their first word, longest first."""
    found: dict[str, list[tuple[tuple[str, ...], Concept]]] = {}
    for concept in concepts().values():
        for expression in concept.expressions:
            text = expression.casefold().replace("'s", "").replace("*", " * ")
            words = tuple(_forms().get(one, one) for one in re.findall(r"[^\W_]+|\*", text))
            found.setdefault(words[0], []).append((words, concept))
    for expressions in found.values():
        expressions.sort(key=lambda one: -sum(word != "*" for word in one[0]))
    return found

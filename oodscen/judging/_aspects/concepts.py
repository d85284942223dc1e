"""What a text names: the table of concepts, and where its expressions stand in a text."""

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib import resources
from typing import Literal, get_args

Kind = Literal["odd", "ordinary", "state", "act", "place", "aside"]
"""Kinds of concepts, as `concepts.toml` explains them."""

WIDEST_GAP = 3
"""How many words "*" in an expression stands for at most."""


@dataclass(frozen=True)
class Concept:
    """A line of the table."""

    name: str
    kind: Kind
    expressions: tuple[str, ...]
    wider: tuple[str, ...] = ()
    """Concepts that it is a kind of."""
    implied: str = ""
    """The thing that a state is about where none is named."""


@dataclass(frozen=True)
class Naming:
    """What a text names."""

    concepts: tuple[Concept, ...]
    """In the order of their first words; what is denied is left out."""
    heads: tuple[Concept, ...]
    """The things that the text is about: those named before its first preposition, or first act."""
    words: tuple[str, ...]
    """All words, in the form the table has of them."""
    rest: tuple[str, ...]
    """The words that belong to no expression, without prepositions."""


@cache
def concepts() -> Mapping[str, Concept]:
    """Return the table of concepts, by name.

    Raises:
        ValueError: When a line refers to a concept that is not in the table.
    """
    source = resources.files("oodscen.judging._aspects").joinpath("concepts.toml")
    table = tomllib.loads(source.read_text(encoding="utf-8"))
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
    unknown = named.union(*table["wider"].values()) - set(found)
    if unknown:
        raise ValueError(f"no such concept: {', '.join(sorted(unknown))}")
    return found


@cache
def widened(name: str) -> frozenset[str]:
    """Return a concept's name and those of everything that it is a kind of."""
    found, ahead = set[str](), [name]
    while ahead:
        one = ahead.pop()
        if one not in found:
            found.add(one)
            ahead.extend(concepts()[one].wider)
    return frozenset(found)


@lru_cache(maxsize=4096)
def named(text: str) -> Naming:
    """Find what a text names; of expressions that begin at the same word, the longest counts."""
    words, parts = _split(text)
    found: list[tuple[int, Concept]] = []
    used: set[int] = set()
    for start in range(len(words)):
        for expression, concept in _index().get(words[start], ()):
            places = _places(expression, words, start)
            if places and not used.intersection(places):
                used.update(places)
                found.append((start, concept))
                break
    told = [(start, one) for start, one in found if one.kind != "aside"]
    denied = _denied(words, parts, used, [start for start, _ in told])
    told = [(start, one) for start, one in told if start not in denied]
    return Naming(
        tuple(one for _, one in told),
        tuple(_heads(told, words, used)),
        tuple(words),
        tuple(one for i, one in enumerate(words) if i not in used and one not in _LINKS),
    )


# ------------------------------------------------------------------ expressions in a text


def _places(expression: Sequence[str], words: Sequence[str], start: int) -> tuple[int, ...]:
    """Return where the words of an expression stand when it begins at `start`, or nothing."""
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
    """Return where something begins that is denied: "no deer", "a deer is not there"."""
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
    told: Sequence[tuple[int, Concept]], words: Sequence[str], used: set[int]
) -> Iterator[Concept]:
    things = [(start, one) for start, one in told if one.kind in ("odd", "ordinary")]
    if not things:
        return
    first = things[0][0]
    ends = [i for i, word in enumerate(words) if i > first and i not in used and word in _LINKS]
    ends += [start for start, one in told if start > first and one.kind in ("state", "act")]
    end = min(ends, default=len(words))
    yield from (one for start, one in things if start < end)


_LINKS = frozenset(
    """
    about above across after against ahead along around at before behind below beside between by
    down during for from in inside into near off on onto out outside over past round since that
    through to toward towards under until up when where which while who with
    """.split()
)

# ------------------------------------------------------------------ words


def _split(text: str) -> tuple[list[str], list[int]]:
    """Return a text's words in the table's form, and the number of the part each stands in."""
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
    """Return the table's word for each of its forms: "stopping" is "stop"."""
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
"""Words whose forms are other words, or none."""


@cache
def _index() -> Mapping[str, Sequence[tuple[tuple[str, ...], Concept]]]:
    """Return the expressions by their first word, the longest first."""
    found: dict[str, list[tuple[tuple[str, ...], Concept]]] = {}
    for concept in concepts().values():
        for expression in concept.expressions:
            text = expression.casefold().replace("'s", "").replace("*", " * ")
            words = tuple(_forms().get(one, one) for one in re.findall(r"[^\W_]+|\*", text))
            found.setdefault(words[0], []).append((words, concept))
    return {word: sorted(ones, key=lambda one: -_length(one[0])) for word, ones in found.items()}


def _length(expression: Sequence[str]) -> int:
    return sum(word != "*" for word in expression)

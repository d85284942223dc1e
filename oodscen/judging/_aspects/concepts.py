"""The table of concepts, by which open answers and labels are read."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, get_args

from oodscen._io.files import bundled
from oodscen._words.wording import is_left_out

Kind = Literal["odd", "ordinary", "state", "act", "place", "aside"]
"""The kinds of concept; `concepts.toml` explains them."""


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


@cache
def concepts() -> Mapping[str, Concept]:
    """Return the table of concepts, by name.

    Raises:
        ValueError: If an entry refers to a concept that is not in the table.
    """
    table = _table()
    kinds: tuple[Kind, ...] = get_args(Kind)
    entries = {
        name: Concept(
            name=name,
            kind=kind,
            expressions=tuple(expressions) if kind == "aside" else (name, *expressions),
            wider=tuple(table["wider"].get(name, ())),
            implied=table["implied"].get(name, ""),
        )
        for kind in kinds
        for name, expressions in table[kind].items()
    }
    references = {*table["wider"], *table["implied"], *table["implied"].values()}
    references |= set(table["unseen"]["concepts"]).union(*table["wider"].values())
    unknown = references - set(entries)
    if unknown:
        raise ValueError(f"no such concept: {', '.join(sorted(unknown))}")
    return entries


@cache
def unseen_concepts() -> frozenset[str]:
    """Return the names of the concepts that no frame shows."""
    return frozenset(_table()["unseen"]["concepts"])


@cache
def _table() -> dict[str, dict[str, Any]]:
    return tomllib.loads(bundled("concepts.toml", "oodscen.judging._aspects"))


@cache
def seen_label(label: str) -> str:
    """Return a label without the words for what no frame shows: "Sudden police checkpoint" loses "Sudden".

    A label of which nothing that names something would be left stays as it is.
    """
    words = sorted(_table()["unseen"]["words"], key=len, reverse=True)
    pattern = r"\b(?:" + "|".join(map(re.escape, words)) + r")\b,?"
    seen = " ".join(re.sub(pattern, " ", label, flags=re.IGNORECASE).split())
    if is_left_out(seen):
        return label
    return seen[:1].upper() + seen[1:]


@cache
def with_broader(name: str) -> frozenset[str]:
    """Return the names of a concept and of all its broader concepts."""
    names, ahead = set[str](), [name]
    while ahead:
        concept = ahead.pop()
        if concept not in names:
            names.add(concept)
            ahead.extend(concepts()[concept].wider)
    return frozenset(names)

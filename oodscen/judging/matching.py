"""Whether an open answer names what a path is about: a matcher whose rules anyone can check."""

import re
from collections.abc import Mapping, Sequence

MOST_THINGS = 6
"""A list of more parts than this names nothing in particular."""


def names_aspect(aspect: str, path: Sequence[str]) -> bool:
    """Whether an open answer names what a path is about.

    The leaf's label decides. The answer and the label agree when they share a telling word: equal
    up to its ending, or a synonym of it, and neither common in driving texts nor denied, as in "no
    deer". One such word is enough: the matcher is lenient towards wording and strict towards
    content. The label itself is always right; an answer that lists more than `MOST_THINGS` things
    names none.

    Args:
        aspect: The answer.
        path: Labels from the root to the leaf.
    """
    if not path or not aspect.strip():
        return False
    if _words(aspect) == _words(path[-1]):
        return True
    if len(_parts(aspect)) > MOST_THINGS:
        return False
    said = affirmed_words(aspect)
    return bool(_widened(said) & _widened(telling_words(path[-1])))


def _words(text: str) -> list[str]:
    return re.findall(r"\w+", text.casefold())


def _widened(stems: set[str]) -> set[str]:
    """Return stems, and for each the groups of synonyms that it belongs to."""
    return stems | {f"={index}" for one in stems for index in _GROUPS.get(one, ())}


def affirmed_words(text: str) -> set[str]:
    """Return the telling words of those parts of a text that deny nothing ("no deer")."""
    said: set[str] = set()
    for part in _parts(text):
        if not _DENIAL.search(part):
            said |= telling_words(part)
    return said


_DENIAL = re.compile(r"\b(?:no|not|without|free\s+of|absence\s+of|never|neither|nor)\b")


def _parts(text: str) -> list[str]:
    parts = re.split(r"[,;.]|\b(?:and|but|or)\b", text.casefold())
    return [part for part in parts if part.strip()]


# ------------------------------------------------------------------ telling words


def telling_words(text: str) -> set[str]:
    """Return the stems of a text's words that are not common in driving texts."""
    words = re.findall(r"[a-z]+", text.casefold().replace("'s", "").replace("bour", "bor"))
    return {stem(word) for word in words if word not in COMMON and len(word) > 2}


COMMON = frozenset(
    """
    a an and are as at be by for from in into is it its near no not of off on onto or other out over
    that the their there this to with without ego vehicle car lane road street driver driving
    traffic ahead front middle side left right sudden suddenly unexpected unusual large small
    another someone something object scene situation across where none
    """.split()
)
"""Words that two descriptions share without meaning the same."""


def stem(word: str) -> str:
    """Cut the ending off an English word."""
    for ending, rest in _ENDINGS:
        if word.endswith(ending) and len(word) - len(ending) >= 3:
            return _undoubled(word.removesuffix(ending) + rest)
    is_plural = len(word) > 3 and not word.endswith("ss")
    return _undoubled(word.removesuffix("s") if is_plural else word)


_ENDINGS = (("ies", "y"), ("ings", ""), ("ing", ""), ("ed", ""), ("es", ""), ("ly", ""))


def _undoubled(word: str) -> str:
    """Return what the forms of a word share: "stopp" and "stop", "merg" and "merge"."""
    is_doubled = len(word) > 3 and word[-1] == word[-2] and word[-1] not in "sl"
    return word[:-1] if is_doubled else word.removesuffix("e")


SYNONYMS: tuple[frozenset[str], ...] = tuple(
    frozenset(words.split())
    for words in (
        "overturned rollover flipped upturned toppled capsized overturn",
        "fog mist haze foggy misty",
        "snow snowfall snowstorm blizzard snowy snowing",
        "rain rainfall downpour rainstorm rainy raining cloudburst",
        "ice icy frozen slippery",
        "deer stag doe elk moose",
        "animal wildlife livestock cattle cow sheep deer dog horse boar",
        "people crowd pedestrian person protester marcher demonstrator "
        "parade protest procession demonstration rally march",
        "police officer checkpoint roadblock",
        "construction roadworks works excavator digger barricade barrier cone",
        "wrong opposite wrongway contraflow ghost",
        "box carton cardboard package crate",
        "debris rubble litter wreckage",
        "tree branch trunk log",
        "child kid boy girl toddler",
        "bicycle bike cyclist bicyclist",
        "motorcycle motorbike motorcyclist biker",
        "lorry truck trailer",
        "crash accident collision wreck",
        "flood flooded flooding inundated",
        "ambulance firetruck emergency siren",
        "smoke fire burning flames",
        "pot planter flowerpot",
        "ball football",
        "halted stopped stationary parked stranded broken stalled",
        "merge merging cutin cutting",
    )
)
"""Words that count as the same."""

_GROUPS: Mapping[str, set[int]] = {
    one: {index for index, group in enumerate(SYNONYMS) if one in {stem(word) for word in group}}
    for one in {stem(word) for group in SYNONYMS for word in group}
}
"""By stem: the groups of synonyms that hold it."""

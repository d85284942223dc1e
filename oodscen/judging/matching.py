"""Whether an open answer names what a path is about: a matcher whose rules anyone can check."""

import re
from collections.abc import Iterable, Sequence

from oodscen.judging.concepts import Concept, Naming, concepts, named, widened

MOST_THINGS = 6
"""A list of more parts than this names nothing in particular."""

GENERAL = frozenset({"vehicle", "person"})
"""Things so common that a mere act of theirs, such as standing, tells nothing."""


def names_aspect(aspect: str, path: Sequence[str]) -> bool:
    """Whether an open answer names what a path is about.

    The leaf's label decides. Both texts are read as concepts of `concepts.toml`: odd and ordinary
    things, states and acts. The label's heads are the things it is about. An answer is right when

    1. it is the label itself, or
    2. it names a head that is odd in itself, or a wider word for it ("an animal" for a dog) and
       nothing else of that wider kind, or
    3. it names a head that is ordinary, or a wider or narrower word for it, or leaves the thing
       out, and also a state of the label ("a car on its roof"), or another odd thing of it. Where
       the label has neither, an act, a place or a word of its own must be shared. A wider state
       ("stopped" for "broken down") is enough beside the very head, unless that is `GENERAL`, or
    4. the label is made of words that the table does not have, and it names their head word.

    What is denied does not count, and an answer that lists more than `MOST_THINGS` things names
    none. Adjectives such as "heavy" and times such as "night" are no concepts: alone they never
    make an answer right.

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
    said, label = named(aspect), named(path[-1])
    heads = label.heads or _implied(label.concepts)
    if not heads:
        return _names_state(said, label) or _names_word(aspect, path[-1])
    return any(_names_oddity(said, head) or _names_case(said, label, head) for head in heads)


def _names_oddity(said: Naming, head: Concept) -> bool:
    """Rule 2: whether an answer names a thing that is odd in itself."""
    if head.kind != "odd":
        return False
    if any(head.name in widened(one.name) for one in said.concepts):
        return True
    wider = {one.name for one in said.concepts if one.kind == "odd"} & widened(head.name)
    return any(
        not any(name in widened(one.name) and one.name != name for one in said.concepts)
        for name in wider
    )


def _names_case(said: Naming, label: Naming, head: Concept) -> bool:
    """Rule 3: whether an answer names an ordinary thing with what makes it unusual."""
    things = [one for one in said.concepts if one.kind in ("odd", "ordinary")]
    things += [] if things else _implied(said.concepts)
    is_very = any(head.name in widened(one.name) for one in things)
    is_wider = any(one.name in widened(head.name) for one in things)
    if not (is_very or is_wider):
        return False
    others = [one for one in label.concepts if one != head]
    given = {name for one in said.concepts for name in widened(one.name)}
    telling = {one.name for one in others if one.kind in ("odd", "state")}
    if telling & given:
        return True
    acts = {one.name for one in others if one.kind in ("act", "ordinary")}
    places = {one.name for one in others if one.kind == "place"}
    if telling:
        loose = {name for one in telling for name in widened(one)} - GENERAL
        is_close = any(one.name in widened(head.name) and one.name not in GENERAL for one in things)
        is_close |= is_very and head.name != "vehicle"
        return is_close and bool((loose | acts | places) & given)
    words = telling_words(" ".join(label.rest))
    own = words & telling_words(" ".join(said.rest))
    if not is_very:
        return len((acts | places) & given) + len(own) >= 2
    if head.name in GENERAL and places:
        has_act = head.name == "person" or not acts or acts & given
        return bool(places & given and has_act)
    return bool((acts | places) & given or own) or not (acts | places | words)


def _names_state(said: Naming, label: Naming) -> bool:
    return bool(
        {one.name for one in label.concepts if one.kind == "state"}
        & {name for one in said.concepts for name in widened(one.name)}
    )


def _implied(found: Iterable[Concept]) -> list[Concept]:
    """Return the things that states are about though none is named."""
    return [concepts()[one.implied] for one in found if one.implied]


def _names_word(aspect: str, label: str) -> bool:
    """Rule 4: whether an answer has the last word of the label's first phrase."""
    phrase = _PHRASE_END.split(label.casefold(), maxsplit=1)[0]
    head = [word for word in re.findall(r"[a-z]+", phrase) if word not in COMMON][-1:]
    return bool(head) and stem(head[0]) in affirmed_words(aspect)


_PHRASE_END = re.compile(r"\b(?:on|in|into|onto|at|from|over|across|with|of|by|to|behind)\b")


def _words(text: str) -> list[str]:
    return re.findall(r"\w+", text.casefold())


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

"""A rule-based matcher that decides whether an open answer names what a path is about."""

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from oodscen._arguments import checked
from oodscen._numbers import said
from oodscen._words.text import stem, without_possessives
from oodscen.data._scene import Visible
from oodscen.errors import UsageError
from oodscen.judging._aspects.concepts import Concept, concepts, with_broader
from oodscen.judging._aspects.naming import Naming, naming_of, visible_naming

MOST_THINGS = 6
"""The most parts an answer may list; a longer list names nothing in particular."""

GENERAL = frozenset({"vehicle", "person"})
"""Things too common for an ordinary act, such as standing, to single them out."""

ENOUGH_SHARED = 2
"""The number of shared acts, places and words that makes up for naming a thing by a broader word only."""

COMMON = frozenset(
    """
    a an and are as at be by for from in into is it its near no not of off on onto or other out over
    that the their there this to with without ego vehicle car lane road street driver driving
    traffic ahead front middle side left right sudden suddenly unexpected unusual large small
    another someone something object scene situation across where none
    """.split()
)
"""Words too common for a match on them to mean anything."""

_PHRASE_END = re.compile(r"\b(?:on|in|into|onto|at|from|over|across|with|of|by|to|behind)\b")
_DENIAL = re.compile(r"\b(?:no|not|without|free\s+of|absence\s+of|never|neither|nor)\b")


class AspectMatch(NamedTuple):
    """The result of comparing an open answer with the truth, in two steps."""

    thing: bool
    """True if it names the thing, or a broader or narrower word for it."""
    right: bool
    """True if it also names what is wrong with the thing, as far as that can be seen."""


@checked
def names_aspect(aspect: str, path: Sequence[str], visible: Sequence[Visible] = ()) -> bool:
    """Return whether an open answer names what a path is about; see `score_naming`.

    Raises:
        UsageError: If the labels of the path have no order, as those of a set.
    """
    if not hasattr(path, "__getitem__"):
        raise UsageError(
            f"path must be a list of labels from the root to the leaf, not {said(path)}"
        )
    return score_naming(aspect, path, visible).right


def score_naming(aspect: str, path: Sequence[str], visible: Sequence[Visible] = ()) -> AspectMatch:
    """Compare an open answer with what a path is about, as far as it can be seen.

    The leaf's label decides, or what can be seen of the hazard in this scene; an answer that fits either is
    right. Texts are read as concepts of `concepts.toml`: odd and ordinary things, states and acts. A label's
    heads are the things it is about. Concepts that no frame shows (a temper, a cause) give way to what they are
    a kind of. An answer is right in any of these cases:

    1. It is the label itself.
    2. It names a head that is odd in itself, or a broader word for it ("an animal" for a dog) and
       nothing else of that broader kind.
    3. It names a head, or a broader or narrower word for it, or omits the thing, and also names a
       state of the label ("a car on its roof") or another odd thing of the label. If the answer names
       the thing more precisely than `GENERAL` does, a broader state ("stopped" for "broken down"), an
       act or a place is enough, unless all states that it names are others ("overturned").
    4. The label has no state and no other odd thing, and the answer names its head together with an
       act, a place or another word of the label. For a head in `GENERAL`, it must name a place of
       the label if the label has any, unless both say that it stands in a lane.
    5. None of the label's words are in the table, and the answer contains the label's head word.

    Denied concepts do not count, and an answer that lists more than `MOST_THINGS` things matches
    nothing. Modifiers such as "heavy" and "night" are ignored: alone they make no answer right.

    Args:
        aspect: The answer.
        path: Labels from the root to the leaf.
        visible: Everything that can be seen of the hazard.
    """
    if not len(path) or not aspect.strip():
        return AspectMatch(thing=False, right=False)
    if is_same_wording(aspect, path[-1]):
        return AspectMatch(thing=True, right=True)
    if len(_parts(aspect)) > MOST_THINGS:
        return AspectMatch(thing=False, right=False)
    answer_naming = naming_of(aspect)
    truths = [(path[-1], naming_of(path[-1])), (path[-1], visible_naming(path[-1]))]
    for thing in visible:
        sight = " ".join(filter(None, (thing.what, thing.doing, thing.where)))
        if sight:
            truths.append((thing.what, naming_of(sight)))
    is_right = any(_fits(answer_naming, aspect, truth, naming) for truth, naming in truths)
    is_thing = is_right or any(_names_thing(answer_naming, naming) for _, naming in truths)
    return AspectMatch(is_thing, is_right)


def _fits(answer_naming: Naming, aspect: str, truth: str, label: Naming) -> bool:
    """Return whether an answer is right about one truth, by rules 2 to 5.

    Args:
        answer_naming: The concepts of the answer.
        aspect: The answer.
        truth: The label, or the visible thing.
        label: The concepts of the label, or of everything that can be seen of the thing.
    """
    heads = label.heads or _implied(label.concepts)
    if not heads:
        states = {concept.name for concept in label.concepts if concept.kind == "state"}
        return bool(states & _widened(answer_naming.concepts)) or _names_word(aspect, truth)
    return any(
        _names_oddity(answer_naming, head) or _names_case(answer_naming, label, head)
        for head in heads
    )


def _names_thing(answer_naming: Naming, label: Naming) -> bool:
    """Return whether an answer names a head of the label, or a broader or narrower word for one."""
    things = _things(answer_naming)
    heads = label.heads or _implied(label.concepts)
    return any(
        head.name in with_broader(thing.name) or thing.name in with_broader(head.name)
        for thing in things
        for head in heads
    )


def is_same_wording(aspect: str, label: str) -> bool:
    """Return whether two texts have the same words."""
    first, second = (re.findall(r"\w+", text.casefold()) for text in (aspect, label))
    return first == second


def _names_oddity(answer_naming: Naming, head: Concept) -> bool:
    """Rule 2: return whether an answer names a thing that is odd in itself."""
    if head.kind != "odd":
        return False
    if any(head.name in with_broader(concept.name) for concept in answer_naming.concepts):
        return True
    named = {concept.name for concept in answer_naming.concepts}
    wider = {concept.name for concept in answer_naming.concepts if concept.kind == "odd"}
    return any(
        not any(name in with_broader(other) for other in named - {name})
        for name in wider & with_broader(head.name)
    )


def _names_case(answer_naming: Naming, label: Naming, head: Concept) -> bool:
    """Rules 3 and 4: return whether an answer names a thing and what makes it unusual."""
    things = _things(answer_naming)
    kinds = with_broader(head.name)
    is_narrow = any(head.name in with_broader(thing.name) for thing in things)
    if not is_narrow and not any(thing.name in kinds for thing in things):
        return False
    others = [concept for concept in label.concepts if concept != head]
    oddities = {concept.name for concept in others if concept.kind in ("odd", "state")}
    named = _widened(answer_naming.concepts)
    if oddities & named:
        return True
    circumstances = _Circumstances.of(label, others)
    if not oddities:
        return _names_circumstances(answer_naming, circumstances, head, is_narrow=is_narrow)
    is_special = (is_narrow and head.name not in GENERAL) or any(
        thing.name in kinds - GENERAL for thing in things
    )
    is_contradicted = _names_other_state(answer_naming, label)
    return is_special and not is_contradicted and bool(circumstances.concepts & named)


class _Circumstances(NamedTuple):
    """The acts, places and words of a label besides its head."""

    acts: set[str]
    """Acts, states and things, and broader words for them."""
    places: set[str]
    words: set[str]
    """Stems of the words that are no concepts."""

    @classmethod
    def of(cls, label: Naming, others: Sequence[Concept]) -> "_Circumstances":
        """Sort the concepts of a label other than its head."""
        return cls(
            _widened(concept for concept in others if concept.kind != "place") - GENERAL,
            {concept.name for concept in others if concept.kind == "place"},
            telling_words(" ".join(label.rest)),
        )

    @property
    def concepts(self) -> set[str]:
        """Acts and places."""
        return self.acts | self.places


def _names_circumstances(
    answer_naming: Naming, circumstances: _Circumstances, head: Concept, *, is_narrow: bool
) -> bool:
    """Rule 4: return whether an answer shares enough acts, places and words with a label.

    Args:
        answer_naming: The answer, which names the head or a broader word for it.
        circumstances: Everything that the label says besides its head.
        head: The thing that the label is about.
        is_narrow: Whether the answer names the head itself, or more precisely.
    """
    named = _widened(answer_naming.concepts)
    shared_words = circumstances.words & telling_words(" ".join(answer_naming.rest))
    shared = circumstances.concepts & named | shared_words
    if not is_narrow:
        return len(shared) >= ENOUGH_SHARED
    if head.name not in GENERAL:
        return bool(shared) or not (circumstances.concepts | circumstances.words)
    is_plain = any(
        concept.kind == "ordinary" and head.name in with_broader(concept.name)
        for concept in _things(answer_naming)
    )
    is_standing = {"stopped", "on the road"} <= named and "stopped" in circumstances.acts
    return is_plain and (is_standing or _singles_out(shared, circumstances, head))


def _names_other_state(answer_naming: Naming, label: Naming) -> bool:
    """Return whether an answer names states, and none of them is the label's, or broader or narrower."""
    states = [concept for concept in answer_naming.concepts if concept.kind == "state"]
    label_names = {concept.name for concept in label.concepts}
    return bool(states) and not any(
        label_names & with_broader(state.name)
        or any(state.name in with_broader(name) for name in label_names)
        for state in states
    )


def _singles_out(shared: set[str], circumstances: _Circumstances, head: Concept) -> bool:
    """Return whether the shared details distinguish this person or vehicle from any other."""
    acts, places = circumstances.acts, circumstances.places
    if not places:
        return bool(shared) or not (acts | circumstances.words)
    is_act_shared = head.name == "person" or not acts or bool(acts & shared)
    return bool(places & shared) and is_act_shared


def _things(answer_naming: Naming) -> list[Concept]:
    """Return the things named; without any, and without unknown words, the things that states imply."""
    things = [concept for concept in answer_naming.concepts if concept.kind in ("odd", "ordinary")]
    if things or telling_words(" ".join(answer_naming.rest)):
        return things
    return _implied(answer_naming.concepts)


def _widened(named: Iterable[Concept]) -> set[str]:
    """Return the names of concepts and of all their broader concepts."""
    return {name for concept in named for name in with_broader(concept.name)}


def _implied(named: Iterable[Concept]) -> list[Concept]:
    """Return the things that the named states describe."""
    return [concepts()[concept.implied] for concept in named if concept.implied]


def _names_word(aspect: str, label: str) -> bool:
    """Rule 5: return whether an answer contains the last telling word of the label's first phrase."""
    phrase = _PHRASE_END.split(label.casefold(), maxsplit=1)[0]
    head = [word for word in re.findall(r"[a-z]+", phrase) if word not in COMMON][-1:]
    affirmed = " ; ".join(part for part in _parts(aspect) if not _DENIAL.search(part))
    return bool(head) and stem(head[0]) in telling_words(affirmed)


def _parts(text: str) -> list[str]:
    parts = re.split(r"[,;.]|\b(?:and|but|or)\b", text.casefold())
    return [part for part in parts if part.strip()]


def telling_words(text: str) -> set[str]:
    """Return the stems of a text's words, without words that are common in driving texts."""
    words = re.findall(r"[a-z]+", without_possessives(text.casefold()).replace("bour", "bor"))
    return {stem(word) for word in words if word not in COMMON and len(word) > 2}

"""Common names of things, and the assets of a catalogue that each name fits."""

import re
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from oodscen._io.files import bundled
from oodscen._words.text import AMERICAN
from oodscen.data._catalogue import Asset, RoadMap
from oodscen.prompts._digest import AssetLine

_IRREGULAR = {
    "child": "children",
    "person": "people",
    "goose": "geese",
    "calf": "calves",
    "leaf": "leaves",
    "ox": "oxen",
}
_UNCHANGED = frozenset(
    {"deer", "sheep", "cattle", "people", "livestock", "debris", "moose", "elk", "doe", "aircraft"}
)
_PLURAL = frozenset({"cattle", "people", "livestock"})

AnyAsset = Asset | AssetLine
"""An asset of a catalogue or of its digest."""


@dataclass(frozen=True)
class Thing:
    """A kind of thing with all its names."""

    words: tuple[str, ...]
    """Names, in the singular; the first is the one used in claims."""
    terms: tuple[str, ...] = ()
    """Terms of which one must match an asset's words: `a&b` needs both, `!a` forbids a word."""
    map: tuple[str, ...] = ()
    """Words of a map's traits or description that show the thing without an actor."""
    group: str = ""
    """General group: `vehicle`, `person`, `animal`, `object` or `signal`."""
    many: bool = False
    """True if a single asset already shows several."""
    plural: bool = False
    """True if the singular already means several."""
    faint: bool = False
    """True if naming the thing does not imply that it is visible, as for all that are vague."""
    vague: bool = False
    """True if the name means anyone or anything. Each claim about it then needs only one actor for
    which it holds."""

    @property
    def name(self) -> str:
        """The name used in claims."""
        return self.words[0]

    def fits(self, asset: AnyAsset) -> bool:
        """Return whether an asset shows the thing."""
        words = words_of(asset)
        return any(all(_matches(part, words) for part in term.split("&")) for term in self.terms)

    def is_scenery(self, road: RoadMap | None) -> bool:
        """Return whether a map shows the thing without an actor."""
        if road is None:
            return False
        return any(word in road.traits or word in road.description for word in self.map)


def _matches(part: str, words: frozenset[str]) -> bool:
    """Return whether words have a part of a term, or lack it if it begins with `!`."""
    if part.startswith("!"):
        return part[1:] not in words
    return part in words


class Mention(NamedTuple):
    """A place in a text where a thing is named."""

    start: int
    end: int
    thing: Thing
    is_plural: bool
    word: str
    """The word in the singular."""


@cache
def things() -> tuple[Thing, ...]:
    """Return all known kinds of things; those without terms only keep their words from being read as other things."""
    table = tomllib.loads(bundled("things.toml", "oodscen.claims"))
    return tuple(map(_thing, table["thing"]))


def _thing(entry: dict[str, Any]) -> Thing:
    fields: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in entry.items()
    }
    fields["faint"] = entry.get("faint", False) or entry.get("vague", False)
    return Thing(**fields)


def mentions(text: str) -> Iterator[Mention]:
    """Yield the things that a text names, in order; the longest of overlapping names wins."""
    pattern, by_form = _index()
    for match in pattern.finditer(text):
        if verb := _verb_at_end(match):
            match = pattern.fullmatch(text, match.start(), verb) or match
        form = _form(match.group(0))
        # A pattern without case also takes letters for equal that no lower case makes equal: a dotless i.
        if form not in by_form:
            continue
        thing, is_plural, word = by_form[form]
        if thing.terms:
            yield Mention(match.start(), match.end(), thing, is_plural, word)


def _verb_at_end(match: re.Match[str]) -> int:
    """Return the end of the noun in a compound that is a noun and its verb, as in `a bus stops`; 0 if it is none."""
    noun, _, last = match.group(0).rpartition(" ")
    if not noun:
        return 0
    text, after = match.string, match.end()
    if last.casefold() == "crossing":
        is_verb = _OBJECT.match(text, after) is not None
    elif last.casefold() in _LIKE_VERBS:
        is_singular = _SINGULAR.search(text[: match.start()]) is not None
        is_verb = is_singular and not _PREDICATE.match(text, after)
    else:
        is_verb = False
    return match.start() + len(noun) if is_verb else 0


_LIKE_VERBS = frozenset("stops parks lights checks controls washes".split())
"""Plurals at the end of compound nouns, such as `bus stops`, that are verbs as well."""
_OBJECT = re.compile(r" (?:the|an?|its|our|my|your|both|two|three|ego)\b", re.IGNORECASE)
_SINGULAR = re.compile(
    r"\b(?:an?|one|another|this|that)(?: [\w-]+){0,2} $"
    r"|(?:^|[.,:;!?] |\b(?:and|but|while|when|where|as|until|because|if) )the (?:[\w-]+ ){0,2}$",
    re.IGNORECASE,
)
"""Matches text before a singular noun, and before one that opens a clause."""
_PREDICATE = re.compile(r" (?:are|were|have|had|stand|line|lie)\b", re.IGNORECASE)


@cache
def thing_named(subject: str) -> Thing | None:
    """Return the thing that a noun phrase names: its head, or what a group or heap of things is made of."""
    end = len(_with_contents(subject))
    first = next((mention for mention in mentions(subject) if mention.start < end), None)
    if first is not None and _reaches_end(first, subject):
        return first.thing
    if of_head := list(mentions(_head(subject))):
        return of_head[-1].thing
    return None if first is None else first.thing


def is_head(subject: str) -> bool:
    """Return whether the thing that a noun phrase names is its head: `car` in `old car`, not in `car carrier`."""
    head = _head(subject)
    in_head = list(mentions(head))
    return bool(in_head) and _reaches_end(in_head[-1], head)


def may_be(subject: str, asset: AnyAsset) -> bool:
    """Return whether an asset fits a noun phrase.

    The noun of an unknown thing, or of its contents, is compared with the words of the asset.
    """
    thing = thing_named(subject)
    if thing is not None:
        return thing.fits(asset)
    words = words_of(asset) | set(re.findall(r"[a-z]+", asset.description.casefold()))
    phrase = _with_contents(subject).casefold()
    nouns = [word for word in re.findall(r"[a-z]+", phrase) if len(word) > 2]
    return bool(nouns) and bool({nouns[-1], nouns[-1].removesuffix("s")} & words)


def words_of(asset: AnyAsset) -> frozenset[str]:
    """Return the words for an asset that a term may match."""
    tags = asset.tags if isinstance(asset, Asset) else None
    return _words(asset.id, asset.category, tags, asset.description)


@cache
def _words(
    asset_id: str, category: str, tags: tuple[str, ...] | None, description: str
) -> frozenset[str]:
    """Return the words for an asset: from its id, category and tags, or its description if it has no tags."""
    terms = (asset_id, *(description.split() if tags is None else tags))
    words = {category, *terms}
    for term in terms:
        words.update(re.split(r"[^a-z0-9]+", term.casefold()))
    return frozenset(words)


def _head(subject: str) -> str:
    return re.split(r"\bof\b", _with_contents(subject), maxsplit=1)[0]


def _with_contents(subject: str) -> str:
    """Return the head of a noun phrase with what it is made of: `group of cars` in `group of cars on a bridge`."""
    return re.split(r"\b(?:with|on|in|from|at|that|which|who)\b", subject, maxsplit=1)[0]


def _reaches_end(mention: Mention, phrase: str) -> bool:
    """Return whether nothing but a number follows a mention."""
    return mention.end >= len(phrase.rstrip(" 0123456789"))


@cache
def _index() -> tuple[re.Pattern[str], dict[str, tuple[Thing, bool, str]]]:
    """Return a pattern of all names, and by form the thing, whether it is a plural, and the singular."""
    by_form: dict[str, tuple[Thing, bool, str]] = {}
    named = [(thing, word, word) for thing in things() for word in thing.words]
    named += [(thing, word, other) for thing, word, _ in named for other in _also_spelt(word)]
    for thing, word, spelt in named:
        singular = _form(spelt)
        is_plural = thing.plural or singular in _PLURAL
        by_form.setdefault(singular, (thing, is_plural, word))
        by_form.setdefault(plural_of(singular), (thing, True, word))
    return re.compile(rf"(?<![\w-]){_any_of(by_form)}(?![\w-])", re.IGNORECASE), by_form


def _any_of(forms: Iterable[str]) -> str:
    """Return a pattern of forms, of which the longest is tried first.

    It branches by letters: an alternation of a thousand whole forms is tried one by one at every place.
    """
    tails: dict[str, list[str]] = {}
    for form in sorted(forms):
        tails.setdefault(form[:1], []).append(form[1:])
    is_whole = tails.pop("", None) is not None
    branches = [
        (r"[\s-]+" if letter == " " else re.escape(letter)) + _any_of(rest)
        for letter, rest in tails.items()
    ]
    if not branches:
        return ""
    return f"(?:{'|'.join(branches)}){'?' if is_whole else ''}"


def _form(name: str) -> str:
    return " ".join(re.split(r"[\s-]+", name.casefold()))


def _also_spelt(word: str) -> Iterator[str]:
    """Yield a name with an American word for a British one, and the other way round."""
    for british, american in AMERICAN.items():
        for one, other in ((british, american), (american, british)):
            if re.search(rf"\b{one}\b", word):
                yield re.sub(rf"\b{one}\b", other, word)


def plural_of(word: str) -> str:
    """Return the plural of a noun."""
    head, _, last = word.rpartition(" ")
    if phrase := re.match(r"(.+?)( (?:of|on|with) .+)", word):
        return plural_of(phrase[1]) + phrase[2]
    if last in _UNCHANGED:
        return word
    if last in _IRREGULAR:
        ending = _IRREGULAR[last]
    elif last.endswith("man") and last not in ("human", "german"):
        ending = f"{last[:-3]}men"
    elif last.endswith(("s", "x", "ch", "sh")):
        ending = f"{last}es"
    elif last.endswith("y") and last[-2:-1] not in "aeiou":
        ending = f"{last[:-1]}ies"
    else:
        ending = f"{last}s"
    return f"{head} {ending}".strip()

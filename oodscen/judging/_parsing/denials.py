"""Tells words that name an aspect from words that say that there is none.

The kinds of a clause's words tell what it says, and what the clauses say tells whether they name an aspect. What is
said neither way in plain words is open: then the model is asked again.
"""

import re
from collections.abc import Sequence
from enum import Enum
from itertools import dropwhile
from typing import NamedTuple

from oodscen._words.prose import fold, tidy

ODD = (
    r"(?:unusual|out of the ordinary|abnormal|anomalous|strange|odd|weird|out of place|out of distribution|ood"
    r"|remarkable|notable|noteworthy|of (?:note|interest)|special|suspicious|concerning|wrong(?! way)|amiss)"
)
_TOPIC = (
    r"(?:(?:any|some|every)thing|all|(?:aspect|thing|object|element|feature|event|detail|part|obstacle|obstruction|problem|issue|concern"
    r"|behaviou?r|danger|threat|hazard(?! (?:warning )?(?:light|triangle)s?\b))s?|(?:anomal|abnormalit|irregularit|activit)(?:y|ies)"
    r"|stands? out|deviat(?:ions?|es?)(?: from (?:the )?\w+)?)"
)


class Kind(Enum):
    """The kinds of words, each with what matches them; the first one that fits counts."""

    PART = (
        r"drivers?|riders?|(?:(?:head|tail|brake|traffic|street) ?)?lights|(?:traffic|street|brake) (?:light|signal)|markings?|lines"
        r"|signs?(?! of\b)|signals|wheels?|t[iy]res?|barriers?|guard ?rails?|(?:hold|secure|support|mark|protect|separate|cover)s"
    )
    """Things that should be there, a driver or what "holds" a load."""
    NOTHING = "nothing|none(?! of the)"
    NO = "no(?! one| longer)|none|without|absence of"
    NOT = r"not(?! (?:all|every)\w*)|never|neither|(?:hard|bare|scarce|rare)ly|far from|no longer|free (?:of|from)|lacks?|nobody|no one"
    ODD = rf"{ODD}|(?:abnormal|unusual|strange|odd)ly|unexpected|to (?:report|note|mention)|worth (?:noting|mentioning)"
    TOPIC = _TOPIC
    """General words for things; if they are denied, nothing is odd: "no hazards", "not anything"."""
    ORDINARY = "(?:normal|ordinary|usual|typical|routine|regular|standard|unremarkabl[ey]|uneventful)(?:ly)?|ordinarily|as expected|(?:with)?in (?:the )?distribution"
    CLEAR = rf"(?:clear|fine|dry|quiet|good|ok|okay|smooth(?:ly)?)(?! (?:(?:visible|apparent|road|traffic|vehicle) )?(?:{ODD}|{_TOPIC})\b)"
    SCENE = (
        "(?:image|picture|photo|frame|view|video|sequence|scene|scenario|situation|drive|road|street|traffic|highway|motorway|lane"
        "|intersection|junction|weather|condition|environment|setting)s?|it|this"
    )
    VEHICLE = "(?:car|vehicle)s?"
    LINK = "an?|the|than|n?or|otherwise|in|on|about|with|of|at|to|for|from|along|through|near"
    FILLER = (
        r"am|is|are|was|were|be|been|being|has|have|had|do|does|did|can|could|would|seems?|appears?|looks?|shows?|shown|showing|contains?"
        r"|depicts?|includes?|see|seen|notice[ds]?|found|(?:find|detect|spot|observe|report)(?:s|e?d)?|identif(?:y|ied)|present|visible"
        r"|apparent|happening|occurring|going on|flow(?:s|ing)?|mov(?:es?|ing)|behav(?:es?|ing)|driv(?:es|ing)|i|we|they|there|here|that"
        r"|these|those|which|both|every|any|some|other|few|several|like|as|just|only|quite|very|so|now|far|ahead|around|nearby|else|urban"
        r"|suburban|rural|city|residential|daytime|light(?= traffic)|given|considered|(?:sign|trace|indication|evidence|presence)s? of"
        r"|\w{4,}ly"
    )
    """Words that tell nothing."""
    OTHER = r"[\w']+"


class Said(Enum):
    """The things that a clause may say, with examples."""

    NOTHING_ODD = "no hazards; all is ordinary"
    NOTHING = "none; the road is clear"
    HARMLESS = "no deer; dry"
    LACK = "no driver"
    ODD = "something is odd"
    NOT_ORDINARY = "it is not normal"
    THING = "a deer"
    REMARK = "on the road"
    OPEN = "nothing for the driver"


class Clause(NamedTuple):
    """The kinds of a clause's words before and behind the first denial in it; all are before if it has none."""

    before: Sequence[Kind]
    denial: Kind | None
    behind: Sequence[Kind]


_DENIALS = {Kind.NOTHING, Kind.NO, Kind.NOT}
_JUDGED = {Kind.ODD, Kind.TOPIC}
_UNKNOWN = {Kind.OTHER, Kind.PART}
_THINGS = {*_UNKNOWN, Kind.VEHICLE}
_NONE = {Said.NOTHING_ODD, Said.NOTHING}
_WITH_NO = {*_NONE, Said.HARMLESS, Said.REMARK}
_WORD = re.compile(
    "|".join(rf"(?P<{kind.name}>(?<![\w'])(?:{kind.value})(?![\w']))" for kind in Kind)
)
_LISTED = r"(?= with\b|(?: (?!no\b|not|is\b|are\b)\w+,?){0,6} n?or\b)"
_CLAUSES = re.compile(
    rf"(?:(?!,{_LISTED})[,.;:!?()\n\u2013\u2014])+|(?<=\s)-|\b(?:and|but)\b|\bwith(?= (?:no|nothing)\b)"
)
"""Matches what stands between clauses, which the commas of "no deer, dogs or cows" and "a road, with cars" do not."""
_COUPLED = re.compile(
    r"(?:\A|(?<=[.;:\n] ))(?:(?:all|the|other|both) )*(?!(?:no|not|none|nothing)\b)\w+(?:, \w+)*,? and (?=\w)"
)
"""Matches nouns that share what follows, at the start of a sentence: "cars and pedestrians behave normally"."""
_HEADED = r"(?!(?:an?|no|not|nothing|is|are|was|were|has|have|looks?|seems?)\b)\w+"
_HEADING = re.compile(
    rf"(?<![\w'])(?<!\w )(?!in |on )({_HEADED}(?: {_HEADED}){{0,4}}) ?: ?(?:none|nothing)\b(?! of\b)"
)
"""Matches the heading of a denial, and what it denies: "hazards: none", but not "it is odd: nothing moves"."""
_PLACEHOLDER = re.compile(
    r"\A\W*(?:nil|null|false|n/?a|not applicable|unknown|undefined|nope|nah|zero|absent|empty)(?=\s*(?:[^\w\s]|\Z))"
)
"""Matches what fills the place of an aspect, as "none" does."""


def plain_words(words: str) -> str:
    """Return words folded and without contractions."""
    plain = re.sub(r"\bcan(?:not|'t)\b", "can not", fold(tidy(words)))
    plain = re.sub(r"n't\b", " not", plain).replace("i'm ", "i am ")
    return re.sub(r"\b(it|that|there|\w+thing)'s\b", r"\1 is", plain)


def says_nothing(plain: str) -> bool | None:
    """Return whether plain words say that there is no aspect; `None` if that is open."""
    said = _clauses_said(plain)
    if not said or (_WITH_NO.issuperset(said) and not _NONE.isdisjoint(said)):
        return True
    telling = [one for one in said if one not in (Said.REMARK, Said.ODD, Said.NOT_ORDINARY)]
    is_lack = telling[:1] == [Said.LACK] and _NONE.isdisjoint(telling)
    is_odd = not telling and Said.ODD in said
    return False if is_lack or is_odd or telling[:1] == [Said.THING] else None


def denies_what_is_odd(plain: str) -> bool:
    """Return whether plain words name no aspect, and a clause denies what is odd."""
    said = _clauses_said(plain)
    return Said.NOTHING_ODD in said and _WITH_NO.issuperset(said)


def calls_odd(plain: str) -> bool:
    """Return whether a clause of plain words says that something is odd, or not ordinary."""
    return not {Said.ODD, Said.NOT_ORDINARY}.isdisjoint(_clauses_said(plain))


def denies(plain: str) -> bool:
    """Return whether a word of plain words is a denial."""
    return not _DENIALS.isdisjoint(_kinds(plain))


def goes_with_no(plain: str) -> bool:
    """Return whether plain words add nothing to an answer of no."""
    return _WITH_NO.issuperset(_clauses_said(plain))


def goes_with_yes(plain: str) -> bool:
    """Return whether no clause of plain words takes an answer of yes back or leaves it open."""
    return {*_NONE, Said.OPEN}.isdisjoint(_clauses_said(plain))


def _clauses_said(plain: str) -> list[Said]:
    """Return what the clauses of plain words say, in order."""
    plain = _HEADING.sub(r"no \1", _PLACEHOLDER.sub("none", plain))
    joined = _COUPLED.sub(lambda nouns: re.sub(r",|\band ", "", nouns[0]), plain)
    return [_said(kinds) for clause in _CLAUSES.split(joined) if (kinds := _kinds(clause))]


def _kinds(plain: str) -> list[Kind]:
    return [Kind[str(word.lastgroup)] for word in _WORD.finditer(plain)]


def _said(kinds: Sequence[Kind]) -> Said:
    at = next((at for at, kind in enumerate(kinds) if kind in _DENIALS), len(kinds))
    clause = Clause(kinds[:at], next(iter(kinds[at:]), None), kinds[at + 1 :])
    if not _UNKNOWN.isdisjoint(kinds):
        return Said.OPEN if _calls_ordinary(kinds) else _said_of_a_thing(clause)
    return _said_with_denial(clause) if clause.denial else _said_in_known_words(set(kinds))


def _said_in_known_words(kinds: set[Kind]) -> Said:
    """Return what a clause of known words without a denial says."""
    is_ordinary = Kind.ORDINARY in kinds or {Kind.TOPIC, Kind.CLEAR} <= kinds
    if Kind.ODD in kinds:
        return Said.NOT_ORDINARY if is_ordinary else Said.ODD
    if is_ordinary:
        return Said.NOTHING_ODD
    if Kind.CLEAR in kinds:
        return Said.NOTHING if kinds & {Kind.SCENE, Kind.VEHICLE} else Said.HARMLESS
    return Said.THING if kinds & {Kind.TOPIC, Kind.VEHICLE} else Said.REMARK


def _said_with_denial(clause: Clause) -> Said:
    """Return what a clause of known words with a denial says."""
    before, behind = set(clause.before), set(clause.behind)
    if Kind.ODD in before or behind & {*_DENIALS, Kind.ORDINARY, Kind.CLEAR}:
        return Said.NOT_ORDINARY
    if Kind.ORDINARY in before or behind & _JUDGED:
        return Said.NOTHING_ODD
    if Kind.VEHICLE in before:
        return Said.THING
    if clause.denial is Kind.NOT:
        return Said.OPEN
    is_of_all = clause.denial is Kind.NOTHING or not (Kind.TOPIC in before or Kind.SCENE in behind)
    return Said.NOTHING if is_of_all and Kind.VEHICLE not in behind else Said.HARMLESS


def _said_of_a_thing(clause: Clause) -> Said:
    """Return what a clause with unknown words says, none of which is called ordinary."""
    before, denial, behind = clause
    if denial is None:
        return Said.THING
    if _UNKNOWN.isdisjoint(before) and _begins_with(Kind.TOPIC, behind):
        is_all = _UNKNOWN.isdisjoint(behind[behind.index(Kind.TOPIC) :])
        return Said.NOTHING_ODD if is_all and Kind.ODD not in before else Said.OPEN
    if not _JUDGED.isdisjoint(behind):
        return Said.OPEN
    if not _THINGS.isdisjoint(before):
        return Said.THING
    if denial is Kind.NO and _begins_with(Kind.PART, behind):
        return Said.LACK
    is_of_one = denial is Kind.NO and behind.count(Kind.OTHER) == 1
    is_harmless = (is_of_one or denial is Kind.NOTHING) and _JUDGED.isdisjoint(before)
    is_plain = {Kind.PART, Kind.VEHICLE, *_DENIALS}.isdisjoint(behind)
    return Said.HARMLESS if is_harmless and is_plain else Said.OPEN


def _begins_with(kind: Kind, denied: Sequence[Kind]) -> bool:
    """Return whether denied words begin with one of a kind, behind an unknown adjective at most: "erratic behaviour"."""
    if kind not in denied:
        return False
    ahead = (one for one in denied[: denied.index(kind)] if one not in (Kind.FILLER, Kind.ODD))
    attributes = list(dropwhile(lambda one: one is Kind.LINK, ahead))
    of_known = attributes[1:] if attributes[:1] == [Kind.OTHER] else attributes
    return {Kind.SCENE, Kind.VEHICLE}.issuperset(of_known)


def _calls_ordinary(kinds: Sequence[Kind]) -> bool:
    """Return whether a word calls a thing ordinary, unlike that of "a deer in the usual lane"."""
    first = next((at for at, kind in enumerate(kinds) if kind in _THINGS), len(kinds))
    return any(
        kind is Kind.ORDINARY and (at < first or kinds[at - 1] is not Kind.LINK)
        for at, kind in enumerate(kinds)
    )

"""Splitting of labels: `deer or dog on the road` is a deer on the road, or a dog on the road."""

import re
from dataclasses import dataclass

PLACING = frozenset(
    """on in at into onto over under beside behind across along ahead near by from to towards toward
    with without through between around against inside outside off out after before during amid among
    past below above beneath up down where while when that which who beyond upon""".split()
)
DETERMINERS = frozenset(
    "a an the its their his her some any no every each this that these those several many two".split()
)
_OR = re.compile(r"\s*,?\s+(?:and/)?or\s+|(?<=[^\W\d_]{3})\s*/\s*(?=[^\W\d_]{3})", re.IGNORECASE)
_AND = re.compile(r"\s*,?\s+(?:and|plus|together with|combined with)\s+|\s+&\s+", re.IGNORECASE)
_ACT = re.compile(r"(?:ing|ed)$")


@dataclass(frozen=True)
class NamedThing:
    """One of several things that a label names."""

    own: str
    """Its own words, without the ones it shares with the others."""
    readings: tuple[str, ...]
    """Possible full readings, the most likely first: `dog on the road`."""
    is_act: bool = False
    """True for an action of a thing named before: `Dog running or walking in the lane`."""


@dataclass(frozen=True)
class Split:
    """A label split into its parts."""

    shares: tuple[NamedThing, ...]
    tail: str = ""
    """The words that the parts share: `on the road`."""

    def naming(self, chosen: tuple[int, ...]) -> str:
        """Return a label that names only the chosen parts."""
        shares = [self.shares[number] for number in chosen]
        tail = f" {self.tail}" if self.tail else ""
        if all(share.readings[0] == f"{share.own}{tail}" for share in shares):
            own = [share.own for share in shares]
            text = own[-1] if len(own) == 1 else f"{', '.join(own[:-1])} or {own[-1]}"
            return _capital(f"{text}{tail}")
        first, *others = (share.readings[0] for share in shares)
        return _capital(" or ".join([first, *map(_small, others)]))


def alternatives(label: str) -> Split:
    """Split a label at `or`, at slashes, and at the commas before them."""
    text = re.sub(r"^\s*either\s+", "", label, flags=re.IGNORECASE)
    return _split(text, _OR, "or")


def conjuncts(text: str) -> Split:
    """Split a text at `and`; all of its parts apply together."""
    return _split(text, _AND, "and")


def subject(text: str) -> list[str]:
    """Return the words of a label before the part that says what happens, or where."""
    words = _words(text)
    while words and words[0].casefold() in DETERMINERS:
        words = words[1:]
    return words[: _tail_at(words)]


def _split(text: str, separator: re.Pattern[str], joint: str) -> Split:
    pieces = separator.split(text.strip())
    if len(pieces) == 1:
        return Split((NamedThing(text.strip(), (text.strip(),)),))
    chunks = [
        part for piece in pieces[:-1] for part in re.split(r"\s*,\s+", piece) if part.strip()
    ] + [pieces[-1]]
    chunks = _merged([chunk.strip(" ,") for chunk in chunks], joint)
    if len(chunks) < 2:
        return Split((NamedThing(text.strip(), (text.strip(),)),))
    last = chunks[-1].split()
    cut = _tail_at(last)
    tail = " ".join(last[cut:])
    names = [*chunks[:-1], " ".join(last[:cut])]
    is_act = [_is_act(name.split()) for name in names]
    return Split(
        tuple(
            NamedThing(name, _readings(number, names, tail, is_act[number]), is_act[number])
            for number, name in enumerate(names)
        ),
        tail,
    )


def _merged(chunks: list[str], joint: str) -> list[str]:
    """Rejoin pieces that only connect places or manners: `on or beside the road`."""
    found: list[str] = []
    for chunk in filter(None, chunks):
        words = chunk.casefold().split()
        before = found[-1].casefold().split() if found else []
        is_open = bool(before) and before[-1] in PLACING | DETERMINERS
        if found and (is_open or words[0] in PLACING):
            found[-1] = f"{found[-1]} {joint} {chunk}"
        else:
            found.append(chunk)
    return found


def _readings(number: int, names: list[str], tail: str, is_act: bool) -> tuple[str, ...]:
    name = names[number]
    words = name.split()
    end = f" {tail}" if tail else ""
    has_tail = _tail_at(words) < len(words) - _is_placing(tail)
    first, last = names[0].split(), names[-1].split()
    found = []
    if is_act and number:
        found.append(f"{' '.join(first[: _tail_at(first)])} {name}{end}")
    found.append(name if has_tail and number < len(names) - 1 else f"{name}{end}")
    if number and len(words) == 1 and len(first) > 1:
        found.append(f"{' '.join(first[: max(1, _tail_at(first) - 1)])} {name}{end}")
    if number < len(names) - 1 and len(words) == 1 and len(last) > 1:
        found.append(f"{name} {' '.join(last[1:])}{end}")
    found.append(name)
    return tuple(dict.fromkeys(found))


def _is_placing(text: str) -> bool:
    """Return whether a phrase describes a location: `on the road`."""
    return text.partition(" ")[0].casefold() in PLACING


def _is_act(words: list[str]) -> bool:
    return (
        bool(words)
        and words[0].casefold().endswith("ing")
        and len(words[0]) > 5
        and _is_followed_as_act(words, 0)
    )


def _is_followed_as_act(words: list[str], number: int) -> bool:
    """Distinguish a verb from a participle in front of its noun by the word that follows."""
    after = words[number + 1].casefold() if number + 1 < len(words) else ""
    return not after or after in PLACING | DETERMINERS or after.endswith(("ly", "wise"))


def _tail_at(words: list[str]) -> int:
    """Return the index of the first word that says what happens, or where; the number of words if none does."""
    for number, word in enumerate(words):
        if number == 0:
            continue
        if word.casefold() in PLACING:
            return number
        is_act = _ACT.search(word.casefold()) and len(word) > 4
        if is_act and _is_followed_as_act(words, number):
            return number
    return len(words)


def _words(text: str) -> list[str]:
    return re.findall(r"[^\W_]+(?:[-'\u2019][^\W_]+)*", text)


def _small(text: str) -> str:
    """Lower-case the first letter unless the word is an abbreviation."""
    return text if text[1:2].isupper() else f"{text[:1].lower()}{text[1:]}"


def _capital(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"

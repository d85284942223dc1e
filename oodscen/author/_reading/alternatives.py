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
NOUNS_LIKE_PARTICIPLES = frozenset(
    """awning bedding building ceiling cladding clothing duckling evening everything anything fencing gosling guttering
    hoarding housing lighting lightning matting morning netting nothing piping railing roofing sapling scaffolding
    seedling something tubing wedding wiring""".split()
)
"""Nouns that end as participles do: `deer or awning` names no act of a deer."""
_OR = re.compile(r"\s*,?\s+(?:and/)?or\s+|(?<=[^\W\d_]{3})\s*/\s*(?=[^\W\d_]{3})", re.IGNORECASE)
_AND = re.compile(r"\s*,?\s+(?:and|plus|together with|combined with)\s+|\s+&\s+", re.IGNORECASE)
_PARTICIPLE = re.compile(r"(?:ing|ed)$")


@dataclass(frozen=True)
class NamedThing:
    """One of several things that a label names."""

    name: str
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
        shares = [self.shares[index] for index in chosen]
        tail = f" {self.tail}" if self.tail else ""
        if all(share.readings[0] == f"{share.name}{tail}" for share in shares):
            *before, last = (share.name for share in shares)
            text = f"{', '.join(before)} or {last}" if before else last
            return _capital(f"{text}{tail}")
        first, *others = (share.readings[0] for share in shares)
        return _capital(" or ".join([first, *map(small, others)]))


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
    return words[: _tail_start(words)]


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
    start = _tail_start(last)
    tail = " ".join(last[start:])
    names = [*chunks[:-1], " ".join(last[:start])]
    shares = []
    for index, name in enumerate(names):
        is_act = _is_act(name.split())
        shares.append(NamedThing(name, _readings(index, names, tail, is_act), is_act))
    return Split(tuple(shares), tail)


def _merged(chunks: list[str], joint: str) -> list[str]:
    """Rejoin pieces that only connect places or manners: `on or beside the road`."""
    merged: list[str] = []
    for chunk in filter(None, chunks):
        first_word = chunk.casefold().split()[0]
        last_word = merged[-1].casefold().split()[-1] if merged else ""
        if merged and (last_word in PLACING | DETERMINERS or first_word in PLACING):
            merged[-1] = f"{merged[-1]} {joint} {chunk}"
        else:
            merged.append(chunk)
    return merged


def _readings(index: int, names: list[str], tail: str, is_act: bool) -> tuple[str, ...]:
    """Return the possible full readings of one of several names that end in a shared tail."""
    name = names[index]
    words = name.split()
    end = f" {tail}" if tail else ""
    has_tail = _tail_start(words) < len(words) - _is_placing(tail)
    is_last = index == len(names) - 1
    first, last = names[0].split(), names[-1].split()
    readings = []
    if is_act and index:
        readings.append(f"{' '.join(first[: _tail_start(first)])} {name}{end}")
    readings.append(name if has_tail and not is_last else f"{name}{end}")
    if index and len(words) == 1 and len(first) > 1:
        readings.append(f"{' '.join(first[: max(1, _tail_start(first) - 1)])} {name}{end}")
    if not is_last and len(words) == 1 and len(last) > 1:
        readings.append(f"{name} {' '.join(last[1:])}{end}")
    readings.append(name)
    return tuple(dict.fromkeys(readings))


def _is_placing(text: str) -> bool:
    """Return whether a phrase describes a location: `on the road`."""
    return text.partition(" ")[0].casefold() in PLACING


def _is_act(words: list[str]) -> bool:
    return (
        bool(words)
        and words[0].casefold().endswith("ing")
        and len(words[0]) > 5
        and _is_verb(words, 0)
    )


def _is_verb(words: list[str], index: int) -> bool:
    """Return whether a word is a participle, and the one after it shows that it is no adjective of a noun."""
    word = words[index].casefold()
    if word in NOUNS_LIKE_PARTICIPLES or _PARTICIPLE.search(word) is None:
        return False
    if index + 1 == len(words):
        return True
    after = words[index + 1].casefold()
    return after in PLACING | DETERMINERS or after.endswith(("ly", "wise"))


def _tail_start(words: list[str]) -> int:
    """Return the index of the first word that says what happens, or where; the number of words if none does."""
    for index, word in enumerate(words[1:], start=1):
        if word.casefold() in PLACING:
            return index
        if len(word) > 4 and _is_verb(words, index):
            return index
    return len(words)


def _words(text: str) -> list[str]:
    return re.findall(r"[^\W_]+(?:[-'\u2019][^\W_]+)*", text)


def small(text: str) -> str:
    """Return a label as it stands within a sentence; abbreviations keep their capitals."""
    return text if text[1:2].isupper() else f"{text[:1].lower()}{text[1:]}"


def _capital(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"

"""The bundled baseline of ordinary driving, from a seeded grammar and from hand-written texts.

The grammar is data (`ordinary.toml`); this module only draws from it. Its texts cover urban, suburban,
rural and motorway driving in the registers that out-of-distribution scenarios use too, so that style
alone does not make a text score as OOD. Situations beyond a grammar were written by hand
(`oodscen.baselines._handwritten`).
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from oodscen._io.files import bundled
from oodscen._seeding import stream
from oodscen._words.text import folded_words
from oodscen.baselines._baseline import Baseline
from oodscen.baselines._handwritten import handwritten_driving
from oodscen.errors import UsageError

_SIZE = 2000
"""Number of texts of the bundled baseline that are drawn."""
_STYLES = {
    "caption": ("captions", 0.34),
    "ego": ("ego", 0.24),
    "lead": ("ego", 0.08),
    "scene": ("scenes", 0.18),
    "reason": ("reasons", 0.10),
    "notes": ("notes", 0.06),
}
"""For each style: the phrases that a situation needs for it, and its share of the texts."""
_SLOT = re.compile(r"\{(?:([aA]) )?(\w+)\}")
_EGO = re.compile(r"\bego\b(?! vehicle| car)", re.IGNORECASE)
_ARTICLE = re.compile(r"\b([aA])n? (?=(\S+))")
_VOWEL = re.compile(r"(?!one-|uni|use|eu)[aeiou]|SUV|MPV", re.IGNORECASE)
_SENTENCE = re.compile(r"(?:^|(?<=\. ))[a-z]")


@cache
def ordinary_driving() -> Baseline:
    """Return the bundled baseline, which is always the same.

    It starts with 2,000 distinct texts of the grammar, followed by those of `handwritten_driving()`.
    """
    return Baseline(
        texts=draw(_SIZE) + handwritten_driving().texts,
        name="ordinary-driving",
        source="oodscen.baselines: grammar ordinary.toml, seed 0, and by hand",
        licence="Apache-2.0",
    )


def draw(size: int, *, seed: int = 0) -> tuple[str, ...]:
    """Return distinct texts of ordinary driving, drawn from the grammar's situations in turn.

    No two are equal after dropping case and punctuation.

    Raises:
        UsageError: If the grammar yields fewer than `size`.
    """
    rules = _rules()
    draws = stream(seed, "ordinary-driving")
    situations = [
        situation for situation in rules["situation"] for _ in range(situation.get("repeat", 1))
    ]
    texts: dict[str, str] = {}
    for turn in range(20 * size):
        if len(texts) == size:
            break
        text = _Text(rules, situations[turn % len(situations)], draws).write()
        texts.setdefault(folded_words(text), text)
    if len(texts) < size:
        raise UsageError(f"the grammar gave {len(texts)} distinct texts, not {size}")
    return tuple(texts.values())


class _Text:
    """One text under construction; it uses no word or phrase twice."""

    def __init__(
        self, rules: Mapping[str, Any], situation: Mapping[str, Any], draws: np.random.Generator
    ) -> None:
        self._rules = rules
        self._situation = situation
        self._draws = draws
        self._used: set[str] = set()
        self._sky = self._choose([sky for sky in rules["sky"] if _suits(situation, sky["tags"])])
        self._road, self._note = self._choose(_roads(rules, situation))
        self._subject = self._pick(rules["words"]["subject"])
        self._is_bare = bool(situation.get("bare"))

    def write(self) -> str:
        """Return a text in a randomly drawn style."""
        shares = {
            style: share for style, (needs, share) in _STYLES.items() if needs in self._situation
        }
        total = sum(shares.values())
        style = self._draws.choice(list(shares), p=[share / total for share in shares.values()])
        text = getattr(self, f"_{style}")()
        if self._draws.random() < 0.5:
            text = _translated(text, self._rules["american"])
        return _edited(text) + "."

    def _caption(self) -> str:
        return self._under_sky(self._phrase("captions"))

    def _reason(self) -> str:
        return self._under_sky(self._phrase("reasons"))

    def _ego(self) -> str:
        return f"{self._driving()} {self._pick(self._sky['with'])}, {self._phrase('ego')}"

    def _lead(self) -> str:
        return f"{self._pick(self._sky['lead'])}, {self._driving()}, {self._phrase('ego')}"

    def _scene(self) -> str:
        scene = _EGO.sub(self._subject, self._phrase("scenes"))
        if self._draws.random() < 0.4:
            return f"{scene}. {self._pick(self._sky['sentence'])}"
        return f"{self._driving()} {self._pick(self._sky['with'])}. {scene}"

    def _notes(self) -> str:
        notes = [self._phrase("notes"), self._phrase("notes"), self._pick(self._sky["note"])]
        if self._note:
            notes.insert(2, self._pick(self._note))
        return ", ".join(notes)

    def _driving(self) -> str:
        motion = self._rules["words"][self._situation.get("motion", "moving")]
        return f"{self._subject} is {self._pick(motion)} {self._road}"

    def _under_sky(self, sentence: str) -> str:
        if self._is_bare or self._draws.random() >= 0.25:
            return sentence
        return f"{self._pick(self._sky['lead'])}, {_uncapital(sentence)}"

    def _phrase(self, kind: str) -> str:
        return self._pick(self._situation[kind])

    def _pick(self, entries: Sequence[str]) -> str:
        """Return an entry that is not used yet, with its slots filled."""
        entry = self._choose([entry for entry in entries if entry not in self._used] or entries)
        self._used.add(entry)
        return _SLOT.sub(self._fill, entry)

    def _fill(self, slot: re.Match[str]) -> str:
        article, name = slot.groups()
        if name.lower() == "subject":
            return self._subject
        word = self._pick(self._rules["words"][name.lower()])
        return f"{article} {word}" if article else word

    def _choose(self, entries: Sequence[Any]) -> Any:
        return entries[int(self._draws.integers(len(entries)))]


@cache
def _rules() -> dict[str, Any]:
    return tomllib.loads(bundled("ordinary.toml", "oodscen.baselines"))


def _suits(situation: Mapping[str, Any], tags: Sequence[str]) -> bool:
    only, never = set(situation.get("only", ())), set(situation.get("never", ()))
    return only <= set(tags) and never.isdisjoint(tags)


def _roads(
    rules: Mapping[str, Any], situation: Mapping[str, Any]
) -> list[tuple[str, Sequence[str]]]:
    """Return the roads that a situation fits, each with its name in a list of key words."""
    classes = {road["class"]: road for road in rules["road"]}
    roads = [
        (phrase, classes[name]["note"])
        for name in situation.get("roads", ())
        for phrase in classes[name]["phrases"]
    ]
    return roads + [(phrase, ()) for phrase in situation.get("on", ())]


def _translated(text: str, words: Mapping[str, str]) -> str:
    longest_first = sorted(words, key=lambda word: (-len(word), word))
    pattern = re.compile(rf"\b({'|'.join(map(re.escape, longest_first))})\b", re.IGNORECASE)

    def translation(match: re.Match[str]) -> str:
        word = words.get(match[0]) or words[_uncapital(match[0])]
        return word[0].upper() + word[1:] if match[0][0].isupper() else word

    return pattern.sub(translation, text)


def _edited(text: str) -> str:
    """Return the text with the articles and capitals that suit the words filled in."""
    text = _ARTICLE.sub(lambda match: match[1] + ("n " if _VOWEL.match(match[2]) else " "), text)
    text = _SENTENCE.sub(lambda match: match[0].upper(), text)
    # Ego without an article is a name, so it is capitalised.
    return re.sub(r"(?<!the )(?<!The )\bego\b", "Ego", text)


def _uncapital(text: str) -> str:
    return text[0].lower() + text[1:]

"""The describing prompt: texts that realise one path of the tree."""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal, get_args

from pydantic import BaseModel, Field

from oodscen._display import Brief
from oodscen._words.text import CHARACTERS_PER_TOKEN, folded_words
from oodscen._words.wording import description_fault
from oodscen.errors import Issue
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest

Style = Literal["natural", "paper", "terse", "verbose", "first-person"]
"""Register of a text: varied everyday prose, two sentences as in the paper, a line of a test
catalogue, a full account, or the driver's own words."""
STYLES: tuple[Style, ...] = get_args(Style)
SHOWN_TOKENS = 400
"""Number of tokens of existing texts that a question shows."""


class Descriptions(Brief, BaseModel):
    """Answer: distinct texts."""

    texts: list[str] = Field(description="one or two sentences each")


class DescribePath(Prompt[Descriptions]):
    """Write scenarios along one path of the tree (paper, section III-B)."""

    purpose: ClassVar[str] = "describe-path"
    template: ClassVar[str] = "describe_path.md"
    answer: ClassVar[type[BaseModel]] = Descriptions

    path: tuple[str, ...]
    """Labels from the root down to the leaf."""
    count: int
    """Number of texts to write, at most."""
    avoid: tuple[str, ...] = ()
    """Existing texts that must not be repeated. The question shows the last ones, up to `SHOWN_TOKENS`."""
    style: Style = "natural"
    """Register of the texts."""
    catalogue: CatalogueDigest | None = None
    """Simulator content that the texts may ask for; `None` allows anything."""
    made: tuple[str, ...] = ()
    """Things and motions made to order for this kind, in words; the texts may ask for them too."""

    def variables(self) -> dict[str, Any]:
        """Return the fields, with the style's instructions in words and the texts to show."""
        return {
            **super().variables(),
            "register": _REGISTERS[self.style],
            "shown": _last(self.avoid, SHOWN_TOKENS * CHARACTERS_PER_TOKEN),
        }

    def check(self, answer: Descriptions) -> list[Issue]:
        """Return faults if there are too many texts, texts of unreasonable length or wording, or duplicates.

        Fewer texts than asked for say that the kind bears no more; none at all, only if some exist.
        """
        issues = []
        least = 0 if self.avoid else 1
        if not least <= len(answer.texts) <= self.count:
            issues.append(Issue("texts", f"give {least} to {self.count}, not {len(answer.texts)}"))
        repeated = self._repeated(answer.texts)
        for index, text in enumerate(answer.texts):
            issues += [Issue(f"texts[{index}]", fault) for fault in _faults(text)]
            if index in repeated:
                issues.append(Issue(f"texts[{index}]", "says the same as an earlier text"))
        return issues

    def usable(self, answer: Descriptions) -> list[str] | None:
        """Return the texts of an answer without those at fault; `None` if what is left says nothing.

        None at all say that the kind bears no more, if some exist and the answer repeats them.
        """
        repeated = self._repeated(answer.texts)
        sound = [index for index, text in enumerate(answer.texts) if not _faults(text)]
        texts = [answer.texts[index] for index in sound if index not in repeated]
        is_dry = bool(self.avoid and sound)
        return texts[: self.count] if texts or is_dry else None

    def _repeated(self, texts: Sequence[str]) -> set[int]:
        """Return the positions of texts that say the same as an earlier one."""
        seen = {folded_words(text) for text in self.avoid}
        repeated: set[int] = set()
        for index, text in enumerate(texts):
            words = folded_words(text)
            if words in seen:
                repeated.add(index)
            seen.add(words)
        return repeated


def _faults(text: str) -> list[str]:
    """Return why a text is of unreasonable length or wording."""
    faults = [] if 20 <= len(text.strip()) <= 600 else ["use 20 to 600 characters"]
    wording = description_fault(text)
    return [*faults, wording] if wording else faults


_REGISTERS: dict[Style, str] = {
    "natural": (
        "Natural prose of one or two sentences. Vary how they are built and where they begin; call the ego vehicle `the ego "
        "vehicle`, `ego` or `the ego car`, once or twice at most."
    ),
    "paper": (
        "Two plain sentences. The first says where `Ego` or `The ego vehicle` is travelling and in which weather, the second "
        "what is unusual."
    ),
    "terse": "One line as in a test catalogue: place and weather, a colon, the event. At most 25 words.",
    "verbose": "Three or four full sentences: the road, the weather, the other traffic, the event and what follows from it.",
    "first-person": "The driver's own words: `I`, `my car`, `my lane`; the ego vehicle is not called ego.",
}


def _last(texts: tuple[str, ...], most_characters: int) -> tuple[str, ...]:
    """Return the last texts that have at most so many characters together, but at least one text."""
    characters = 0
    for index in range(len(texts) - 1, -1, -1):
        characters += len(texts[index])
        if characters > most_characters:
            return texts[min(index + 1, len(texts) - 1) :]
    return texts

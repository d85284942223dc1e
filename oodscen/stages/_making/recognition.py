"""Showing things made to order to a vision model that does not know their names."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from oodscen._io.jpeg import to_jpeg
from oodscen._words.text import folded_words, one_line, stem
from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.prop import Prop
from oodscen.data._messages import Image
from oodscen.llm._ask import ask, speaker
from oodscen.prompts._scenario.recognise_prop import RecogniseProp
from oodscen.protocols import LLM
from oodscen.stages._making.looking import DISTANCES_M, ShownProp

Item = TypeVar("Item")

OPTIONS = 8
"""Number of things that a model chooses among, and "none of these"."""
NONE = "none of these"
_LITTLE_WORDS = frozenset(
    "all and are can for from has have into its like not off one onto out over that the their this two under "
    "which who whose with".split()
)
"""Words of three letters and more that name no thing."""


class PropRecogniser:
    """Asks a vision model what a thing is, among other things of the catalogue.

    Args:
        llm: A model that sees pictures, and did not design the thing.
        catalogue: The other things.
    """

    def __init__(self, llm: LLM, catalogue: Catalogue) -> None:
        self.llm = llm
        self.catalogue = catalogue

    @property
    def name(self) -> str:
        return speaker(self.llm)

    def mistake(self, prop: Prop, shown: ShownProp) -> str:
        """Return the thing for which the model takes another; empty if it names it.

        Raises:
            LLMError: When the model gives no valid answer.
        """
        labels = options(prop, self.catalogue)
        pictures = tuple(
            Image.from_bytes(to_jpeg(picture), f"assets/{prop.id}-{distance:g}m.jpg")
            for distance, picture in zip(DISTANCES_M, shown.pictures, strict=False)
        )
        answer = ask(self.llm, RecogniseProp(pictures=pictures, labels=labels))
        chosen = labels[answer.choice - 1]
        if chosen == prop.description:
            return ""
        return (one_line(answer.seen) or chosen)[:200]


def options(prop: Prop, catalogue: Catalogue) -> tuple[str, ...]:
    """Return a thing's description among those of others, most of its own category, in a random order.

    The order depends on the design alone. Things that share a word with it are left out: they could be right too.
    """
    rng = np.random.Generator(np.random.PCG64(int(prop.digest()[:12], 16)))
    words = _words(f"{prop.id} {prop.description}")
    others = _shuffled(
        [
            asset
            for asset in catalogue.assets
            if asset.description and words.isdisjoint(_words(f"{asset.id} {asset.description}"))
        ],
        rng,
    )
    others.sort(key=lambda asset: asset.category != prop.category)
    near, far = others[: OPTIONS // 2], _shuffled(others[OPTIONS // 2 :], rng)
    descriptions = [asset.description for asset in (*near, *far)][: OPTIONS - 1]
    return (*_shuffled(list(dict.fromkeys((prop.description, *descriptions))), rng), NONE)


def _shuffled(items: Sequence[Item], rng: np.random.Generator) -> list[Item]:
    return [items[index] for index in rng.permutation(len(items))]


def _words(text: str) -> set[str]:
    """Return the stems of the words of a text that may name a thing."""
    words = {word for word in folded_words(text).split() if len(word) > 2}
    return {stem(word) for word in words - _LITTLE_WORDS}

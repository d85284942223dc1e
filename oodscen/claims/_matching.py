"""Plausibility of a statement that an actor stands for a thing of the text."""

import re
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from oodscen.claims._things import Thing, is_head, may_be, thing_named, words_of
from oodscen.data._catalogue import Asset, Catalogue, RoadMap
from oodscen.data._map_state import MapState
from oodscen.encoders._check import unit_embeddings
from oodscen.metrics._detection.guard import is_calibrated
from oodscen.protocols import Encoder

OF_THE_MAP = "map"
"""Name used instead of an actor's id for things that the road itself shows."""
_LEAST_COSINE = 0.3
"""Minimum cosine between a noun phrase and an asset that it may name."""
_MARGIN = 0.12
"""Largest difference of that cosine to that of the nearest asset."""
_SURE_COSINE = 0.55
"""Cosine from which the nearest asset is taken even for a noun that other assets are known by."""
_MOST_LISTED = 6
"""Largest number of assets that a reason lists."""
_COMMON = frozenset(
    "a an and are as at by for from has have her his in into is it its of off on onto or out over the their there to "
    "who with road lane street ego vehicle person people way right left ahead front".split()
)


class Likeness:
    """Nearness in meaning between noun phrases and the assets of a catalogue.

    Args:
        encoder: An encoder whose cosines follow meaning.
        catalogue: The assets.
    """

    def __init__(self, encoder: Encoder, catalogue: Catalogue) -> None:
        self.encoder = encoder
        self.catalogue = catalogue

    @cached_property
    def _embeddings(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Unit vectors of the names and of the descriptions of the assets."""
        names = [asset.id.replace("_", " ") for asset in self.catalogue.assets]
        descriptions = [
            asset.description or name
            for asset, name in zip(self.catalogue.assets, names, strict=True)
        ]
        return unit_embeddings(self.encoder, names), unit_embeddings(self.encoder, descriptions)

    def of(self, phrase: str) -> dict[str, float]:
        """Return the cosine of a phrase with every asset, by id: with its name or its description."""
        names, descriptions = self._embeddings
        vector = unit_embeddings(self.encoder, [phrase])[0]
        cosines = np.maximum(names @ vector, descriptions @ vector)
        return {
            asset.id: float(cosine)
            for asset, cosine in zip(self.catalogue.assets, cosines, strict=True)
        }


def likeness_of(encoder: Encoder | None, catalogue: Catalogue) -> Likeness | None:
    """Return the nearness in meaning by an encoder; `None` if its cosines are not known to follow meaning."""
    if encoder is None or not is_calibrated(encoder.name):
        return None
    return Likeness(encoder, catalogue)


def doubt(
    subject: str,
    quotes: Sequence[str],
    asset: Asset,
    catalogue: Catalogue,
    likeness: Likeness | None,
) -> str:
    """Return the reason why an asset does not fit a noun phrase such as `uprooted maple`; empty if it fits.

    Args:
        subject: The noun phrase.
        quotes: The words of the text about it.
        asset: The asset that is said to be it.
        catalogue: All assets.
        likeness: Nearness in meaning; without it, a noun that no asset is known by may be any of them.
    """
    if may_be(subject, asset):
        return ""
    thing = thing_named(subject)
    is_human = thing is not None and _is_human(thing)
    if is_human and (_resembles_person(subject, quotes, asset) or _is_ridden(subject, asset)):
        return ""
    noun = _without_number(subject)
    misfit = f"{asset.id!r} is {asset.description}, and {noun!r} names something else"
    cosines = likeness.of(noun) if likeness else {}
    nearest = sorted(cosines, key=lambda asset_id: (-cosines[asset_id], asset_id))
    if fitting := _known_assets(subject, thing, catalogue):
        if nearest and nearest[0] == asset.id and cosines[asset.id] >= _SURE_COSINE:
            return ""
        return f"{misfit}: here that is {_listed(fitting)}"
    if not cosines:
        return ""
    if cosines[asset.id] >= max(_LEAST_COSINE, cosines[nearest[0]] - _MARGIN):
        return ""
    return (
        f"{misfit}: in meaning it is {cosines[asset.id]:.2f} from it, and the nearest are "
        f"{', '.join(f'{name} ({cosines[name]:.2f})' for name in nearest[:3])}"
    )


def is_of_map(subject: str, road: RoadMap | None) -> bool:
    """Return whether a road may show a thing by itself, by the words of its description."""
    thing = thing_named(subject)
    if thing is not None:
        return thing.is_scenery(road)
    if road is None:
        return True
    words = re.findall(r"[a-z]+", f"{road.description} {' '.join(road.traits)}".casefold())
    return bool({_stem(word) for word in words} & _stems(_without_number(subject)))


def fault_of_map(subject: str, state: MapState | None) -> str:
    """Return what is wrong with the map's own things of a name, such as its street lamps; empty if nothing is."""
    if state is None:
        return ""
    faults = {str(part): fault for part, fault in state.faults()}
    words = subject.casefold()
    thing = thing_named(subject)
    if re.search(r"\b(?:street ?-?(?:lamp|light)|lamp ?post|streetlamp|streetlight)", words):
        return faults.get("street_lamps", "")
    if thing is not None and "signalised" in thing.map:
        return faults.get("signals", "")
    return faults.get("signs", "") if re.search(r"\bsigns?\b", words) else ""


def _known_assets(subject: str, thing: Thing | None, catalogue: Catalogue) -> list[str]:
    """Return the ids of the assets that a noun is known to mean."""
    if thing is None or thing.vague or not is_head(subject):
        return []
    return [asset.id for asset in catalogue.assets if thing.fits(asset)]


def _is_human(thing: Thing) -> bool:
    return thing.group == "person" or any(term.startswith("cyclist") for term in thing.terms)


def _resembles_person(subject: str, quotes: Sequence[str], asset: Asset) -> bool:
    """Return whether a person's asset and the words about a person have more in common than being people."""
    if asset.category != "pedestrian":
        return False
    asset_stems = {_stem(word) for word in words_of(asset)} | _stems(asset.description)
    return bool((_stems(" ".join((subject, *quotes))) & asset_stems) - _COMMON)


def _is_ridden(subject: str, asset: Asset) -> bool:
    """Return whether a person of the text sits on what the asset is: a person on a cargo bike."""
    match = re.search(r"\b(?:on|riding|astride)\s+(.+)", subject.casefold())
    return match is not None and asset.category in ("cyclist", "animal") and may_be(match[1], asset)


def _stems(text: str) -> set[str]:
    return {_stem(word) for word in re.findall(r"[a-z]+", text.casefold()) if word not in _COMMON}


def _stem(word: str) -> str:
    if word in ("lying", "lies", "lay"):
        return "lie"
    return re.sub(r"(ing|ed|es|s)$", "", word)


def _without_number(subject: str) -> str:
    """Return a noun phrase without the number that tells it from others of its name."""
    return subject.rstrip(" 0123456789") or subject


def _listed(names: Sequence[str]) -> str:
    more = " ..." if len(names) > _MOST_LISTED else ""
    return ", ".join(names[:_MOST_LISTED]) + more

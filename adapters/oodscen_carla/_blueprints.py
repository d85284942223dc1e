"""The choice of a blueprint for an asset, and of an asset for a blueprint."""

from collections.abc import Collection, Iterable

from oodscen.data import Asset

_PREFIXES = {
    "vehicle": "vehicle.oodscen",
    "cyclist": "vehicle.oodscen",
    "pedestrian": "walker.oodscen",
}
"""Beginnings of ids by the asset's category; others are props."""
_SAME, _OTHER_CATEGORY, _COMMON_WORD = -9.0, 4.0, 1.5
"""Distance of the same thing, and weights of another category and of a common word; sizes differ by 3 at most."""
_COMMON_PARTS = frozenset({"", "vehicle", "prop", "pedestrian", "walker", "static", "oodscen"})
"""Parts of ids that tell nothing about what they are."""


def own_id(asset: Asset) -> str:
    """Return the id of the blueprint by which this library's own server offers an asset."""
    return f"{_prefix(asset)}.{asset.id}"


def blueprint_of(asset: Asset, offered: Collection[str], blueprints: Iterable[Asset]) -> str | None:
    """Return the id of the blueprint that shows an asset, or `None` if there is none of its kind.

    It is the asset's own, or else that of the same thing in CARLA's catalogue, or else the one of
    the nearest size.

    Args:
        asset: The asset to show.
        offered: Ids of the blueprints that the server has.
        blueprints: CARLA's catalogue of blueprints with their sizes.
    """
    for name in (asset.id, own_id(asset)):
        if name in offered:
            return name
    candidates = [other for other in blueprints if other.id in offered and _is_alike(other, asset)]
    return nearest(asset, candidates).id if candidates else None


def nearest(wanted: Asset, assets: Iterable[Asset]) -> Asset:
    """Return the asset that is the same thing, or most alike in category, words and size."""
    words = _words(wanted)

    def distance(asset: Asset) -> tuple[float, str]:
        if asset.id in wanted.names or wanted.id in asset.names:
            return _SAME, asset.id
        sizes = zip(_size(wanted), _size(asset), strict=True)
        size_difference = sum(abs(a - b) / (a + b + 0.1) for a, b in sizes)
        category_difference = 0.0 if asset.category == wanted.category else _OTHER_CATEGORY
        likeness = _COMMON_WORD if words & _words(asset) else 0.0
        return category_difference + size_difference - likeness, asset.id

    return min(assets, key=distance)


def _is_alike(asset: Asset, other: Asset) -> bool:
    """Return whether two assets are both vehicles, both people or both things."""
    return _prefix(asset) == _prefix(other)


def _prefix(asset: Asset) -> str:
    return _PREFIXES.get(asset.category, "static.prop")


def _size(asset: Asset) -> tuple[float, float, float]:
    return asset.length, asset.width, asset.height


def _words(asset: Asset) -> set[str]:
    parts = asset.id.replace("_", ".").split(".")[-2:]
    joined = asset.id.replace("_", "").split(".")[-1:]
    return {part.rstrip("0123456789") for part in [*parts, *joined]} - _COMMON_PARTS

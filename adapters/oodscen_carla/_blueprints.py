"""The choice of a blueprint for an asset, and of an asset for a blueprint."""

from collections.abc import Collection, Iterable

from oodscen.data import Asset

_PREFIXES = {
    "vehicle": "vehicle.oodscen",
    "cyclist": "vehicle.oodscen",
    "pedestrian": "walker.oodscen",
}


def own_id(asset: Asset) -> str:
    """Return the id of the blueprint by which this library's own server offers an asset."""
    return f"{_PREFIXES.get(asset.category, 'static.prop')}.{asset.id}"


def blueprint_of(asset: Asset, offered: Collection[str], known: Iterable[Asset]) -> str | None:
    """Return the id of the blueprint that shows an asset, or `None` if there is none of its kind.

    It is the asset's own, or else that of the same thing in CARLA's catalogue, or else the one of
    the nearest size.

    Args:
        asset: The asset to show.
        offered: Ids of the blueprints that the server has.
        known: CARLA's catalogue of blueprints with their sizes.
    """
    for name in (asset.id, own_id(asset)):
        if name in offered:
            return name
    candidates = [one for one in known if one.id in offered and _is_alike(one, asset)]
    return nearest(asset, candidates).id if candidates else None


def nearest(wanted: Asset, assets: Iterable[Asset]) -> Asset:
    """Return the asset that is the same thing, or most alike in category, words and size."""
    words = _words(wanted)

    def distance(asset: Asset) -> tuple[float, str]:
        if asset.id in wanted.names or wanted.id in asset.names:
            return -9.0, asset.id
        sizes = zip(_size(wanted), _size(asset), strict=True)
        apart = sum(abs(a - b) / (a + b + 0.1) for a, b in sizes)
        strange = 0.0 if asset.category == wanted.category else 4.0
        return strange + apart - 1.5 * bool(words & _words(asset)), asset.id

    return min(assets, key=distance)


def _is_alike(one: Asset, other: Asset) -> bool:
    """Return whether two assets are both vehicles, both people or both things."""
    kinds = [_PREFIXES.get(asset.category, "static.prop") for asset in (one, other)]
    return kinds[0] == kinds[1]


def _size(asset: Asset) -> tuple[float, float, float]:
    return asset.length, asset.width, asset.height


def _words(asset: Asset) -> set[str]:
    parts = asset.id.replace("_", ".").split(".")[-2:]
    joined = asset.id.replace("_", "").split(".")[-1:]
    return {part.rstrip("0123456789") for part in [*parts, *joined]} - {
        *("", "vehicle", "prop", "pedestrian", "walker", "static", "oodscen"),
    }

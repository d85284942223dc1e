"""Measures the sizes of assets with details, and writes them into the catalogue of the PyBullet adapter.

Usage: python -m tools.detail_sizes

The catalogue lists which poses and parts an asset has; this script fills in length, width and height of each,
and the place of the hands.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from oodscen_pybullet._meshes import asset_mesh
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.people import load_people
from oodscen_pybullet._meshes.living.poses import load_poses
from oodscen_pybullet._meshes.living.posing import hands
from oodscen_pybullet._meshes.look import BEATS, Appearance, beating
from oodscen_pybullet._types import Array

from oodscen.data._details import Details

CATALOGUE = Path(__file__).parents[1] / "adapters" / "oodscen_pybullet" / "catalogue.json"


def bounds_of(asset: str, details: Details) -> tuple[Array, Array]:
    """Return the lowest and the highest corner of an asset at rest, over all beats of its pose."""
    pose = load_poses().get(details.pose)
    frames = [beating(0, beat) for beat in range(BEATS)] if pose and pose.second else [0]
    found = [asset_mesh(asset, frame=frame, details=details).bounds for frame in frames]
    lows, highs = zip(*found, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def size_of(asset: str, details: Details) -> list[float]:
    """Return length, width and height of the least box about the origin around an asset with details, m."""
    low, high = bounds_of(asset, details)
    half = np.maximum(-low[:2], high[:2]).tolist()
    return [round(value, 2) for value in (2 * half[0], 2 * half[1], float(high[2]))]


def grip_of(pose: str) -> list[float]:
    """Return the middle of an adult's hands about the middle of its pose's box, m; of the right one at the side."""
    right, left = hands(load_poses()[pose])
    x = _figure_middle(pose)
    if pose == "carry_at_side":
        left = right
    middle = [(a + b) / 2 for a, b in zip(right, left, strict=True)]
    return [round(middle[0] - x, 2), round(middle[1], 2), round(middle[2], 2)]


def _figure_middle(pose: str) -> float:
    """Return x of the middle of an adult's pose, m."""
    mesh = MeshBuilder()
    load_people()["adult"].add(mesh, Appearance(details=Details(pose=pose)))
    low, high = mesh.bounds
    return float(low[0] + high[0]) / 2


def measured(asset: dict[str, Any]) -> dict[str, Any]:
    """Return an asset's entry with the sizes of its poses and parts."""
    offers = asset.get("offers")
    if offers is None:
        return asset
    name = asset["id"]
    poses = {one: size_of(name, Details(pose=one)) for one in offers.get("poses", ())}
    parts = {one: size_of(name, Details(parts=(one,))) for one in offers.get("parts", ())}
    sizes = {"poses": poses, "parts": parts}
    return {**asset, "offers": {**offers, **{key: one for key, one in sizes.items() if one}}}


def main() -> None:
    """Rewrite the lines of the catalogue that have sizes."""
    lines = CATALOGUE.read_text(encoding="utf-8").split("\n")
    for number, line in enumerate(lines):
        bare = line.strip().removesuffix(",")
        if not (bare.startswith('{"id"') and bare.endswith("}")):
            continue
        entry = json.loads(bare)
        if "grip" in entry:
            entry["grip"]["at"] = grip_of(entry["id"])
        text = json.dumps(measured(entry) if "category" in entry else entry)
        indent = line[: len(line) - len(line.lstrip())]
        lines[number] = indent + text + ("," if line.rstrip().endswith(",") else "")
    CATALOGUE.write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()

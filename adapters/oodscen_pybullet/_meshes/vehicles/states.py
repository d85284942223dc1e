"""Vehicles that are dirty or crushed, or have words on their sides."""

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.look import Appearance


def altered(asset: str, mesh: MeshBuilder, shown: Appearance) -> None:
    """Change the finished mesh of a vehicle as its details say."""

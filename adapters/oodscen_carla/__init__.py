"""CARLA: a catalogue to prune trees with, a simulator for its servers, and a server that takes its place.

The catalogue needs no CARLA. The simulator needs the `carla` package and a running server.
`oodscen_carla.server` speaks CARLA's protocol without CARLA.
"""

from typing import TYPE_CHECKING, Any

from oodscen_carla._catalogue import load_catalogue

if TYPE_CHECKING:
    from oodscen_carla._simulator import CarlaSimulator

__all__ = ["CarlaSimulator", "load_catalogue"]


def __getattr__(name: str) -> Any:
    if name != "CarlaSimulator":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from oodscen_carla._simulator import CarlaSimulator

    return CarlaSimulator

"""What CARLA 0.9.16 can show, as a catalogue: data to prune with, no simulator."""

from oodscen_carla._catalogue import load_catalogue

__all__ = ["load_catalogue"]

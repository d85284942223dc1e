"""The catalogue of CARLA 0.9.16: data to prune trees with, without a simulator."""

from oodscen_carla._catalogue import load_catalogue

__all__ = ["load_catalogue"]

"""The adapter for highway-env: its bicycles, drivers and obstacles on the shipped roads."""

from oodscen_highway._simulator import HighwaySimulator

__all__ = ["HighwaySimulator"]

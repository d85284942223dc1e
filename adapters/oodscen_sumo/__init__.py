"""The adapter for Eclipse SUMO: its drivers in traffic on the shipped roads."""

from oodscen_sumo._simulator import SumoSimulator

__all__ = ["SumoSimulator"]

"""Checks of a scene before it runs: places, sight, and what its moments show."""

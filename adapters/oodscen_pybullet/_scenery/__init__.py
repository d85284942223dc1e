"""Scenery beside the roads."""

"""Vectors of texts: similarities, distances, axes."""

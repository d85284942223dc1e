"""Comparison of an open answer with the aspect that a path is about."""

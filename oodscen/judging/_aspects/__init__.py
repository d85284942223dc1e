"""Scores open answers against the aspect that a path is about."""

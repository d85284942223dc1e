"""Traces of OSI ground truth, out and in."""

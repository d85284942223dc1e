"""Pruning, the additions that would restore branches, and comparisons of simulators."""

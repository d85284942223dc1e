"""Intervals and tests, for texts, verdicts and drives alike."""

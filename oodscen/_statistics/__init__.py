"""Confidence intervals and significance tests for texts, verdicts and drives."""

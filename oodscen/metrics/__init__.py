"""Metrics of sets of texts: OOD-ness against a baseline, and diversity.

`oodscen.Metrics(encoder, baseline)` computes both by two definitions: the one that the paper prints, and the one
that fits its table. `docs/metrics.md` compares them.
"""

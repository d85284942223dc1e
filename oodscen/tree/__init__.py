"""The scenario tree as an artefact: its log of edits, labels, comparison, merging, coverage, provenance, export."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

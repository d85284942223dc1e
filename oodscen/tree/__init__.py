"""The scenario tree: its edit log, labels, comparison, merging, coverage, provenance and export."""

"""Faults of CSV files in plain words."""

import csv


def csv_fault(error: csv.Error) -> str:
    """Return what is wrong with a CSV file; the module's own words name a limit of its code and an end of data."""
    words = str(error)
    if "field limit" in words:
        return f"a field has more than {csv.field_size_limit():,} characters"
    return "a quote is not closed" if "end of data" in words else words

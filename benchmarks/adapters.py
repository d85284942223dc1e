"""Plant defects in a simulator, one at a time, and count those that the conformance check finds.

Usage: python benchmarks/adapters.py [--json] [NAME ...]

Forty-one defects (`_adapter_defects.py`), as authors of adapters make them; at least 38 must be found, and the flat
simulator without a defect must pass. The parts `process` and `leaks` are left out.
"""

import argparse
import json
import sys
import time

from _adapter_defects import DEFECTS

from oodscen.testing import FlatSimulator
from oodscen.testing._check import PARTS, examine_parts

FIRST = ("measures", "controls", "motion", "pictures", "turning", "snapshot", "frames")
"""The parts that find most."""
ORDER = (*FIRST, *(one for one in PARTS if one not in (*FIRST, "process", "leaks")))
LEAST = 38


def first_finding(make: type[FlatSimulator]) -> str:
    """Return the first finding, from the part that tells it; empty if all parts hold."""
    for part in ORDER:
        lines = [line for result in examine_parts(make, parts=(part,)) for line in result.lines()]
        if lines:
            return lines[0]
    return ""


def main() -> None:
    """Print a line per defect, and exit with 1 if too few are found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, last line")
    parser.add_argument("names", nargs="*", help="the defects to plant; all by default")
    options = parser.parse_args()
    wanted = [one for one in DEFECTS if not options.names or one.__name__ in options.names]
    clean = first_finding(FlatSimulator)
    print(f"{'(no defect)':28s} {clean or 'keeps the protocol'}")
    rows = []
    for make in wanted:
        began = time.perf_counter()
        finding = first_finding(make)
        spent = time.perf_counter() - began
        rows.append({"defect": make.__name__, "finding": finding, "seconds": round(spent, 1)})
        print(f"{make.__name__:28s} {spent:5.1f} s  {finding[:150] or 'NOT FOUND'}", flush=True)
    found = sum(bool(row["finding"]) for row in rows)
    print(f"{found} of {len(wanted)} defects found")
    if options.json:
        print(json.dumps(rows))
    if clean or (len(wanted) == len(DEFECTS) and found < LEAST):
        sys.exit(1)


if __name__ == "__main__":
    main()

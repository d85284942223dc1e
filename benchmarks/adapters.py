"""Plant defects in a simulator, one at a time, and count those that the conformance check finds.

Usage: python benchmarks/adapters.py [--json] [NAME ...]

The defects (`_adapter_defects.py`) are such as authors of adapters make; all must be found, and the flat and the
tutorial's simulator without a defect must pass. The parts `process` and `leaks` are left out.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable

from _adapter_defects import DEFECTS

from oodscen.protocols import Simulator
from oodscen.testing._check import PARTS, examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._new.adapter import MySimulator

FIRST = ("measures", "controls", "motion", "pictures", "turning", "snapshot", "frames")
"""The parts that find most."""
ORDER = (*FIRST, *(one for one in PARTS if one not in (*FIRST, "process", "leaks")))


def first_finding(make: Callable[[], Simulator]) -> str:
    """Return the first finding, from the part that tells it; empty if all parts hold."""
    for part in ORDER:
        lines = [line for result in examine_parts(make, parts=(part,)) for line in result.lines()]
        if lines:
            return lines[0]
    return ""


def main() -> None:
    """Print a line per defect, and exit with 1 if one is not found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, last line")
    parser.add_argument("names", nargs="*", help="the defects to plant; all by default")
    options = parser.parse_args()
    wanted = [defect for defect in DEFECTS if not options.names or defect.__name__ in options.names]
    faults = {make.name: first_finding(make) for make in (FlatSimulator, MySimulator)}
    for name, finding in faults.items():
        print(f"{f'{name} (no defect)':28s} {finding or 'keeps the protocol'}")
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
    if any(faults.values()) or found < len(wanted):
        sys.exit(1)


if __name__ == "__main__":
    main()

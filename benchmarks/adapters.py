"""Plant defects in a simulator, one at a time, and count those that the conformance check finds.

    python benchmarks/adapters.py [NAME ...]

Forty defects (`_adapter_defects.py`), as authors of adapters make them; at least 38 must be found, and the flat
simulator without a defect must pass. The parts `process` and `leaks` are left out.
"""

import sys
import time

from _adapter_defects import DEFECTS

from oodscen.testing import FlatSimulator
from oodscen.testing._check import PARTS, examine_parts

ORDER = (
    "measures", "controls", "motion", "pictures", "snapshot", "frames", "behaviours", "weather",
    "determinism", "maps", "appearance", "assets", "catalogue", "refusals",
)  # fmt: skip
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
    assert set(ORDER) == set(PARTS) - {"process", "leaks"}
    wanted = [one for one in DEFECTS if not sys.argv[1:] or one.__name__ in sys.argv[1:]]
    clean = first_finding(FlatSimulator)
    print(f"{'(no defect)':28s} {clean or 'keeps the protocol'}")
    found = 0
    for make in wanted:
        began = time.perf_counter()
        finding = first_finding(make)
        found += bool(finding)
        spent = time.perf_counter() - began
        print(f"{make.__name__:28s} {spent:5.1f} s  {finding[:150] or 'NOT FOUND'}", flush=True)
    print(f"{found} of {len(wanted)} defects found")
    if clean or (len(wanted) == len(DEFECTS) and found < LEAST):
        sys.exit(1)


if __name__ == "__main__":
    main()

"""Kills studies at random moments and continues them: what survives, and do they end the same?

Usage: python benchmarks/kills.py [--json] [--count N] [--seed N]

Quick studies with two workers, every eighth on PyBullet, are ended by SIGTERM, SIGINT or SIGKILL, sent to the
command alone or to its whole process group, sometimes twice. The same command then continues them and is killed
up to six times in all. No process may be left 5 s after a signal, SIGTERM and SIGINT may not leave the status
`running`, and all files of a finished study must have the bytes of an undisturbed run. Exempt are
`calls.jsonl`, where a question in flight appears twice, the calls and times in `study.json` and the report,
and the lock file.
"""

import argparse
import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import uuid
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from tqdm import tqdm

ROOT = Path(__file__).parent.parent
ORDINARY = ROOT / "tests" / "pipeline" / "ordinary.txt"
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL)
LEFT_S = 5.0
"""Time after a signal by which every process must be gone, s."""
MOST_KILLS = 6
"""Largest number of kills of one study."""
TWICE = 0.2
"""Fraction of the signals that are followed by a second one."""
PYBULLET_EVERY = 8
TIMES = (
    r"The run took [^,]+,",
    r"<dt>time</dt><dd>.*?</dd>",
    r'(?<="row">)seconds\.\w+</th>.*',
    r'(?s)<h3 id="calls">.*?</table>',
)
"""Patterns of times and calls in the report."""
MARK = "OODSCEN_KILLS"
"""Environment variable that identifies the processes of a command, wherever they went."""

Row = dict[str, object]


@dataclass
class Tally:
    """The counts of all outcomes."""

    sent: Counter[str] = field(default_factory=Counter)
    studies: int = 0
    differences: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    running: list[str] = field(default_factory=list)
    tracebacks: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    slowest_s: float = 0.0

    @property
    def kills(self) -> int:
        """Number of signals sent to commands that were still running."""
        return self.sent.total()


class Command:
    """`oodscen run` in its own process session."""

    def __init__(self, out: Path, simulator: str) -> None:
        self.mark = uuid.uuid4().hex
        options = f"--quick --simulator {simulator} --encoder hash --workers 2 --seed 3"
        self.log = out.with_suffix(".log")
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    "oodscen",
                    "run",
                    out,
                    *options.split(),
                    "--baseline",
                    ORDINARY,
                ],
                env=os.environ | {MARK: self.mark, "OODSCEN_OFFLINE": "1"},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    def is_over(self, seconds: float) -> bool:
        """Wait up to `seconds` and return whether the command has ended."""
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def send(self, number: signal.Signals, to_all: bool) -> None:
        """Send a signal to the command, or to its whole process group."""
        with suppress(ProcessLookupError):
            (os.killpg if to_all else os.kill)(self.process.pid, number)

    def alive(self) -> list[str]:
        """Return the surviving processes that the command started, including itself."""
        self.process.poll()
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if f"{MARK}={self.mark}".encode() in (folder / "environ").read_bytes():
                    words = (folder / "cmdline").read_bytes().replace(b"\0", b" ")
                    found.append(f"{folder.name} {words.decode(errors='replace')[:90]}")
            except OSError:
                continue
        return found


def killed(out: Path, simulator: str, span_s: float, draw: random.Random, tally: Tally) -> bool:
    """Run the command and end it at a random moment; return whether it had ended before."""
    number, to_all = draw.choice(SIGNALS), draw.random() < 0.5
    moment, again = draw.uniform(0.0, span_s), draw.random() < TWICE
    what = (
        f"{number.name}{' to all' if to_all else ''}{' twice' if again else ''} at {moment:.2f} s"
    )
    before = status(out)
    command = Command(out, simulator)
    if command.is_over(moment):
        if command.process.returncode:
            tally.failed.append(f"exit code {command.process.returncode}: {tail(command.log)}")
        return True
    began = time.monotonic()
    command.send(number, to_all)
    if again and not command.is_over(draw.uniform(0.0, 0.5)):
        command.send(number, to_all)
    while (alive := command.alive()) and time.monotonic() - began < LEFT_S:
        time.sleep(0.02)
    tally.slowest_s = max(tally.slowest_s, time.monotonic() - began)
    tally.left += [f"{what}: {one}" for one in alive]
    for one in alive:
        with suppress(ProcessLookupError):
            os.kill(int(one.split()[0]), signal.SIGKILL)
    code = command.process.wait()
    tally.sent[number.name] += 1
    # A signal before the command listens, or a second one, ends it like SIGKILL.
    if code == 128 + number and before != "running" and status(out) == "running":
        tally.running.append(what)
    shown = command.log.read_text(errors="replace")
    # While Python is still importing the command, Ctrl-C prints a traceback.
    is_importing = "<frozen runpy>" in shown and "main(prog_name=" not in shown
    if "Traceback" in shown and not is_importing:
        tally.tracebacks.append(f"{what}: {tail(command.log)}")
    return code == 0


def status(out: Path) -> str:
    path = out / "study.json"
    return json.loads(path.read_text())["status"] if path.is_file() else ""


def tail(log: Path) -> str:
    return log.read_text(errors="replace")[-1500:]


def contents(out: Path) -> dict[str, object]:
    """Return the contents that must be identical, by file."""
    found: dict[str, object] = {}
    for path in out.rglob("*"):
        if path.is_file() and path.name not in ("calls.jsonl", ".oodscen.lock"):
            found[str(path.relative_to(out))] = path.read_bytes()
    info = json.loads((out / "study.json").read_text())
    found["study.json"] = {k: v for k, v in info.items() if k not in ("seconds", "usage")}
    page = (out / "report.html").read_text("utf-8")
    for pattern in TIMES:
        page = re.sub(pattern, "", page)
    found["report.html"] = page
    return found


def finish(out: Path, simulator: str) -> float:
    """Run the command to its end and return the elapsed seconds."""
    began = time.monotonic()
    command = Command(out, simulator)
    if command.process.wait() != 0:
        raise RuntimeError(tail(command.log))
    return time.monotonic() - began


def measure(count: int, seed: int) -> tuple[list[Row], Tally]:
    draw = random.Random(seed)
    tally = Tally()
    simulators = ["flat", "pybullet"] if find_spec("pybullet") else ["flat"]
    wanted: dict[str, dict[str, object]] = {}
    spans: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder, tqdm(total=count, disable=None) as bar:
        for simulator in simulators:
            whole = Path(folder, simulator)
            finish(whole, simulator)
            spans[simulator] = finish(Path(folder, f"{simulator} again"), simulator)
            wanted[simulator] = contents(whole)
        while tally.kills < count:
            tally.studies += 1
            simulator = simulators[-1 if tally.studies % PYBULLET_EVERY == 0 else 0]
            out = Path(folder, f"study-{tally.studies}")
            for _ in range(draw.randint(1, MOST_KILLS)):
                if tally.kills == count or killed(out, simulator, spans[simulator], draw, tally):
                    break
                bar.update()
            finish(out, simulator)
            found, right = contents(out), wanted[simulator]
            for name in sorted(found.keys() | right.keys()):
                if found.get(name) != right.get(name):
                    tally.differences.append(f"study {tally.studies} ({simulator}): {name}")
    return rows(tally, count), tally


def rows(tally: Tally, count: int) -> list[Row]:
    sent = ", ".join(f"{number} {name}" for name, number in sorted(tally.sent.items()))
    figures: list[tuple[str, float, str, str, bool]] = [
        (f"kills ({sent})", tally.kills, "", f"{count}", tally.kills == count),
        ("studies continued to their end", tally.studies, "", "(none)", True),
        (
            "longest time until nobody is left",
            tally.slowest_s,
            "s",
            f"< {LEFT_S:g}",
            not tally.left,
        ),
    ]
    for name, found in (
        ("files unlike those of an undisturbed run", tally.differences),
        (f"processes left {LEFT_S:g} s after a signal", tally.left),
        ("studies left as `running` by SIGTERM or SIGINT", tally.running),
        ("commands that showed a traceback", tally.tracebacks),
        ("commands that failed without a signal", tally.failed),
    ):
        figures.append((name, len(found), "", "0", not found))
    names = ("name", "value", "unit", "target", "holds")
    return [dict(zip(names, (n, round(v, 2), u, t, h), strict=True)) for n, v, u, t, h in figures]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--count", type=int, default=200, help="how many kills")
    parser.add_argument("--seed", type=int, default=0, help="of signals and moments")
    options = parser.parse_args()
    # The commands would inherit signals that this process was started to ignore.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    found, tally = measure(options.count, options.seed)
    for fault in (
        *tally.differences,
        *tally.left,
        *tally.running,
        *tally.tracebacks,
        *tally.failed,
    ):
        print(fault)
    for item in found:
        mark = "ok  " if item["holds"] else "MISS"
        print(f"{mark} {item['name']}: {item['value']} {item['unit']} ({item['target']})")
    if options.json:
        print(json.dumps(found))
    return 0 if all(item["holds"] for item in found) else 1


if __name__ == "__main__":
    sys.exit(main())

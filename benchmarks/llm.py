"""Measures the throughput, limits and fault tolerance of runs through the real litellm client.

Usage: python benchmarks/llm.py [--json] [--only PART ...]

Parts: throughput, caps, dead, faults, kills. All servers are on 127.0.0.1. Throughput is a ratio within one run.
"""

import argparse
import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path

from tqdm import tqdm

KEY = "sk-test-planted-0123456789abcdef"
os.environ.update(OPENAI_API_KEY=KEY, OODSCEN_OFFLINE="1")

from oodscen import Scene, Study, make_simulator  # noqa: E402
from oodscen._parallel.threads import as_finished  # noqa: E402
from oodscen.driving._sight.placement import check_scene  # noqa: E402
from oodscen.errors import BudgetExceeded, EndpointDown, LLMError  # noqa: E402
from oodscen.llm._ask import ask  # noqa: E402
from oodscen.llm._remote.limits import Limits  # noqa: E402
from oodscen.llm._remote.litellm import LiteLLM  # noqa: E402
from oodscen.llm._remote.sdk import load_litellm  # noqa: E402
from oodscen.llm._remote.wire import wire_message  # noqa: E402
from oodscen.prompts._tree.imagine_scenario import ImagineScenario  # noqa: E402
from oodscen.testing import AnsweringServer, ScriptedLLM  # noqa: E402

PARTS = ("throughput", "caps", "dead", "faults", "kills")
SERVED = Path(__file__).with_name("_served.py")
THREADS, TEXTS, DELAY_S = 32, 1_000, 0.3
KILLS = 25
PROMPT = ImagineScenario(shown=("A deer crosses.",))
CHANGING = ("study.json", "calls.jsonl", "answers.jsonl", "report.html")
"""Files that hold times, or the order in which answers arrived."""

Row = dict[str, object]


def row(name: str, value: object, unit: str, target: str, holds: bool) -> Row:
    shown = round(value, 4) if isinstance(value, float) else value
    return {"name": name, "value": shown, "unit": unit, "target": target, "holds": holds}


@contextmanager
def slow_server():
    process = subprocess.Popen(
        [sys.executable, str(SERVED), "slow", str(DELAY_S)], stdout=subprocess.PIPE, text=True
    )
    try:
        yield f"http://127.0.0.1:{process.stdout.readline().strip()}/v1"
    finally:
        process.kill()
        process.wait()


def resident_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def throughput() -> list[Row]:
    """Ask for texts from a server with 0.3 s latency, and compare with bare litellm calls in as many threads."""
    sdk = load_litellm()
    messages = [wire_message(message) for message in PROMPT.messages()]
    with slow_server() as address:
        llm = LiteLLM("m", api_base=address, limits=Limits(concurrency=THREADS))

        def bare(sample: int) -> None:
            sdk.completion(
                model="openai/m", messages=messages, api_base=address, seed=sample, max_retries=0
            )

        def ours(count: int) -> None:
            work = lambda sample: ask(llm, PROMPT, sample)  # noqa: E731
            for _ in as_finished(work, range(count), threads=THREADS):
                pass

        ours(THREADS)
        with ThreadPoolExecutor(THREADS) as pool:
            list(pool.map(bare, range(THREADS)))
            began = time.perf_counter()
            list(pool.map(bare, range(TEXTS)))
            plain = time.perf_counter() - began
        ours(200)
        before = resident_mb()
        began = time.perf_counter()
        ours(TEXTS)
        taken = time.perf_counter() - began
        grown = resident_mb() - before
    return [
        row(
            f"{TEXTS} texts in {THREADS} threads, against bare litellm",
            taken / plain,
            "x",
            "<= 1.15",
            taken <= 1.15 * plain,
        ),
        row("texts per second", TEXTS / taken, "1/s", "(none)", True),
        row("memory grown over them", grown, "MB", "<= 20 (flat)", grown <= 20.0),
    ]


def caps() -> list[Row]:
    """Count at the server how many requests a cap lets through."""
    worst = 0
    for limit in (1, 33, 100):
        limits = Limits(requests=limit, concurrency=THREADS, patience_s=None)
        author = ScriptedLLM(lambda asked: {"text": f"A sofa. ({asked.sample})"})
        faults = lambda index, asked: "http500" if index % 4 == 0 else None  # noqa: E731
        with AnsweringServer(author, faults=faults) as server:
            llm = server.client("m", limits=limits)

            def work(sample: int, llm=llm) -> None:
                with suppress(BudgetExceeded, LLMError):
                    ask(llm, PROMPT, sample)

            for _ in as_finished(work, range(2 * limit + THREADS), threads=THREADS):
                pass
            worst = max(worst, len(server.received) - limit)
    return [row(f"requests beyond a cap, {THREADS} at once", worst, "", "<= 0", worst <= 0)]


def dead() -> list[Row]:
    """Measure how long a run keeps asking a dead server."""

    def until_stopped(address: str) -> float:
        llm = LiteLLM("m", api_base=address, limits=Limits(concurrency=4))
        began = time.monotonic()
        for sample in range(1_000):
            try:
                ask(llm, PROMPT, sample)
            except EndpointDown:
                break
            except LLMError:
                continue
        return time.monotonic() - began

    with socket.create_server(("127.0.0.1", 0)) as server:
        silent = until_stopped(f"http://127.0.0.1:{server.getsockname()[1]}/v1")
        gone = f"http://127.0.0.1:{server.getsockname()[1]}/v1"
    refused = until_stopped(gone)
    return [
        row(f"a server that {what} ends the run after", seconds, "s", "<= 60", seconds <= 60.0)
        for what, seconds in (("says nothing", silent), ("refuses connections", refused))
    ]


def child(out: Path, log: Path, *, faults: float = 0.0, kill_after: int = 0) -> str:
    """Run a study in another process and return its output."""
    command = [sys.executable, str(SERVED), "study", out, log, str(faults), str(kill_after)]
    done = subprocess.run(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode not in (0, -9):
        raise RuntimeError(done.stdout)
    return done.stdout


def contents(out: Path) -> dict[str, bytes]:
    files = (path for path in out.rglob("*") if path.is_file())
    return {str(p.relative_to(out)): p.read_bytes() for p in files if p.name not in CHANGING}


def faults() -> list[Row]:
    """Run the text pipeline while 30 % of the requests fail, and compare with an undisturbed run."""
    with tempfile.TemporaryDirectory() as folder:
        quiet, hurt = Path(folder, "quiet"), Path(folder, "hurt")
        child(quiet, Path(folder, "quiet.log"))
        printed = child(hurt, Path(folder, "hurt.log"), faults=0.3)
        wrong = failed = right = mended = 0
        for table in ("redteam", "pruned", "scenarios", "scenes"):
            wanted = {
                str(line.get("id", line.get("round"))): line for line in rows_of(quiet, table)
            }
            for line in rows_of(hurt, table):
                if line.get("status") == "failed" and line.get("error"):
                    failed += 1
                elif line == wanted.get(str(line.get("id", line.get("round")))):
                    right += 1
                elif table == "scenes" and runs(line):
                    mended += 1
                else:
                    wrong += 1
        usage = Study.open(hurt).info["usage"]
        repairs = sum(item["retries"] + item["repairs"] for item in usage)
        found = [p.name for p in Path(folder).rglob("*") if p.is_file() and holds_key(p)]
    return [
        row("items neither right nor a typed failure, 30 % faults", wrong, "", "0", wrong == 0),
        row("items as in a run left alone", right, "", "> 0", right > 0),
        row("scenes of a mended answer, drawn anew and checked", mended, "", "(none)", True),
        row("items that failed, with their error", failed, "", "(none)", True),
        row("retries and repairs on the way", repairs, "", "> 0", repairs > 0),
        row(
            "files and output with the planted key",
            len(found) + (KEY in printed),
            "",
            "0",
            not found and KEY not in printed,
        ),
    ]


def runs(line: dict[str, object]) -> bool:
    """Return whether a scene passes every check of the augmenter."""
    scene, catalogue = Scene.parse(line), make_simulator("flat").catalogue()
    return not catalogue.lacks(scene) and not check_scene(scene, catalogue)


def rows_of(out: Path, table: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in (out / f"{table}.jsonl").read_text().splitlines()]


def holds_key(path: Path) -> bool:
    return KEY.encode() in path.read_bytes()


def kills() -> list[Row]:
    """Kill a run at random moments and continue it until it ends."""
    draw = random.Random(7)
    with tempfile.TemporaryDirectory() as folder:
        quiet, hurt = Path(folder, "quiet"), Path(folder, "hurt")
        child(quiet, Path(folder, "quiet.log"))
        total = len(Path(folder, "quiet.log").read_text().splitlines())
        seen: set[str] = set()
        again = killed = 0
        for number in tqdm(range(KILLS + 1), desc="kills", disable=None):
            log = Path(folder, f"{number}.log")
            # On average each kill leaves the run a little further, and not finished before the last one.
            after = draw.randint(1, 2 * total // (KILLS + 5)) if number < KILLS else 0
            child(hurt, log, kill_after=after)
            killed += not Path(hurt, "report.html").exists()
            asked = log.read_text().splitlines() if log.exists() else []
            again = max(again, sum(one in seen for one in asked))
            seen.update(asked)
        same = contents(quiet) == contents(hurt)
    return [
        row(f"kill -9 before the end, of {KILLS}", killed, "", f">= {KILLS}", killed >= KILLS),
        row("files as those of a run left alone", same, "", "true", same),
        row("questions asked again after one kill", again, "", "<= 16 (in flight)", again <= 16),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print rows as JSON in the last line")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS)
    arguments = parser.parse_args()
    found: list[Row] = []
    for part in arguments.only:
        for item in globals()[part]():
            found.append(item)
            print(f"{item['name']:60} {item['value']!s:>10} {item['unit']:4} {item['target']}")
    if arguments.json:
        print(json.dumps(found))
    sys.exit(not all(item["holds"] for item in found))


if __name__ == "__main__":
    main()

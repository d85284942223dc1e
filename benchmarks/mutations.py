"""Breaks files of studies: every command and every reader must report the fault in one line.

Usage: python benchmarks/mutations.py [--json] [--count N] [--seed N] [--most N]

The benchmark makes a small study with judged models, drives and recordings. N times (default 1,000) it breaks
one of its files at random: a value replaced, a key duplicated, a line truncated, bytes that are not text, a
folder in its place, ... Every reader and command then reads each broken study, and one of the writing commands
writes to it. An error other than the library's own counts as a traceback; a file that differs, or is new, after
a command that only reads or was refused counts as a changed input. A refusal must exit with code 2.
"""

import argparse
import copy
import json
import random
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from click.testing import CliRunner
from tqdm import tqdm

from oodscen import Study, StudyConfig
from oodscen._cli import main as cli
from oodscen._io.study_files import TABLES, TREES
from oodscen._pipeline import run_study
from oodscen.errors import OodscenError
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.protocols import Request
from oodscen.testing import ScriptedLLM

ORDINARY = "A car waits at a red light.\nA bus stops at its stop.\nThe road is dry and clear.\n"
OPTIONS = (
    "--quick --simulator flat --encoder hash --max-paths 1 --iterations 2 --workers 1 --protocol paper "
    "--width 160 --height 120"
)

Row = dict[str, object]
Files = dict[str, tuple[bytes, int]]


class Answerer(ScriptedLLM):
    """A model that always stops and, as a judge, takes every aspect for another, recorded like a third-party model."""

    def __init__(self) -> None:
        super().__init__(_answer)
        self.name = "answerer"


def _answer(asked: Request) -> str:
    if asked.prompt.purpose == "judge-aspect":
        return '{"reasoning": "", "is_same_thing": false, "is_same_fault": false}'
    return ConstantAnswerer("stop").complete(asked).text


class Outcome(NamedTuple):
    """The effect of a broken study on one command or reader."""

    file: str
    mutation: str
    reader: str
    fault: str
    """The fault; empty if there is none."""


def make_study(folder: Path) -> Path:
    """Make the study to break, with every kind of file."""
    (folder / "ordinary.txt").write_text(ORDINARY)
    out = folder / "study"
    config = StudyConfig.quick(
        simulator="flat",
        encoder="hash",
        baseline=str(folder / "ordinary.txt"),
        max_paths=1,
        iterations=2,
        width=160,
        height=120,
        vlms=(f"{__name__}:Answerer",),
        judge=f"{__name__}:Answerer",
        protocols=("ours", "paper"),
    )
    run_study(out, config)
    assert call("drive", out, "--limit", "1").exit_code == 0
    return out


def call(*order: object) -> Any:
    return CliRunner().invoke(cli, [str(word) for word in order])


def api(out: Path) -> None:
    """Use every reader of a study; an error in one does not stop the others."""
    errors = []
    study = Study(out)
    readers: list[Callable[[], object]] = [
        lambda: Study.open(out),
        lambda: study.info,
        lambda: study.config,
        lambda: study.metrics,
        lambda: study.rounds,
        lambda: study.decisions,
        lambda: study.restoration,
        lambda: study.comparison,
        lambda: study.scenarios,
        lambda: study.scenes,
        lambda: study.episodes,
        lambda: study.verdicts,
        lambda: study.drives,
        lambda: study.texts(10),
        study.check,
        *(lambda name=name: study.tree(name) for name in TREES),
        *(lambda name=name: study.table(name) for name in TABLES),
        *(lambda name=name: study.failures(name) for name in TABLES),
    ]
    for read in readers:
        try:
            read()
        except OodscenError as error:
            errors.append(error)
    if errors:
        raise errors[0]


READERS: dict[str, tuple[str, ...]] = {
    "tree show": ("tree", "show", "OUT"),
    "tree show --json": ("tree", "show", "OUT", "--which", "simulatable", "--json"),
    "tree show FILE": ("tree", "show", "OUT/tree.initial.json"),
    "tree diff": ("tree", "diff", "OUT", "OUT/tree.initial.json"),
    "tree coverage": ("tree", "coverage", "OUT"),
    "tree export": ("tree", "export", "OUT", "--format", "html"),
    "tree replay": ("tree", "replay", "OUT"),
    "score": ("score", "OUT/scenarios.jsonl", "--encoder", "hash", "--baseline", "ORDINARY"),
    "check-claims": (
        *("check-claims", "OUT/scenes.jsonl", "--scenarios", "OUT/scenarios.jsonl"),
        *("--simulator", "flat"),
    ),
    "run --dry-run": ("run", "OUT", *OPTIONS.split(), "--baseline", "ORDINARY", "--dry-run"),
    "simulate into it": ("simulate", "OUT/scenes.jsonl", "OUT", "--simulator", "flat"),
    "augment": ("augment", "OUT/scenarios.jsonl", "--simulator", "flat"),
}
WRITERS: dict[str, tuple[str, ...]] = {
    "report": ("report", "OUT"),
    "evaluate --drop": ("evaluate", "OUT", "--drop", "answerer"),
    "evaluate --vlm": ("evaluate", "OUT", "--vlm", "constant:stop"),
    "drive": ("drive", "OUT", "--limit", "1"),
    "run": ("run", "OUT", *OPTIONS.split(), "--baseline", "ORDINARY"),
}


# ------------------------------------------------------------------ breaking

ODD: tuple[object, ...] = (
    *(None, True, False, 0, -1, 3.5, 1e308, -1e308, 10**90, 10**400, "", " ", "x" * 300, "\0"),
    *("../../etc/passwd", "/etc/passwd", "nan", "\u2028", [], {}, [[]], [None], {"a": {}}, {"": 1}),
    *("@NaN@", "@Infinity@", "@-Infinity@", "@1e999@", "@deep@", "@lone@"),
)
"""Replacement values; those in @ are written as no JSON writer would."""

RAW = {
    "NaN": "NaN",
    "Infinity": "Infinity",
    "-Infinity": "-Infinity",
    "1e999": "1e999",
    "deep": "[" * 100_000 + "]" * 100_000,
    "lone": '"\\ud800"',
}


def broken(content: bytes, draw: random.Random) -> tuple[str, bytes | None]:
    """Return the name of the fault, and the file's new content; `None` is a folder in its place."""
    name = draw.choice([*BYTES, *("value",) * len(BYTES)])
    return (name, BYTES[name](content, draw)) if name in BYTES else changed(content, draw)


def _is_json(line: bytes) -> bool:
    """Return whether a line holds a JSON object; a line of a picture may only begin like one."""
    try:
        return isinstance(json.loads(line), dict)
    except ValueError:
        return False


def changed(content: bytes, draw: random.Random) -> tuple[str, bytes]:
    """Change something in one JSON document of a file: one line or the whole file."""
    lines = content.split(b"\n")
    numbers = [number for number, line in enumerate(lines) if _is_json(line)]
    if not numbers:
        return "nothing", content
    number = draw.choice(numbers)
    document = json.loads(lines[number])
    holder, key = draw.choice(list(places(document)) or [([document], 0)])
    how = draw.choice(("odd", "odd", "odd", "gone", "more", "twice", "line"))
    text = ""
    if how == "odd":
        holder[key] = copy.deepcopy(draw.choice(ODD))
    elif how == "gone":
        del holder[key]
    elif how == "more":
        document["unknown"] = 1
    elif how == "twice":
        first = next(iter(document))
        text = json.dumps({first: None})[:-1] + "," + json.dumps(document)[1:]
    else:
        text = json.dumps(draw.choice([[], None, 1, "text", [document]]))
    text = text or json.dumps(document, ensure_ascii=False)
    for mark, raw in RAW.items():
        text = text.replace(f'"@{mark}@"', raw)
    lines[number] = text.encode()
    return f"{how} at {key!r}", b"\n".join(lines)


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield every position in nested data: its container, and its key or index."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in list(items):
        yield value, key
        if isinstance(item, dict | list):
            yield from places(item)


def flipped(content: bytes, draw: random.Random) -> bytes:
    changed = bytearray(content or b" ")
    for _ in range(draw.choice((1, 1, 5))):
        changed[draw.randrange(len(changed))] = draw.randrange(256)
    return bytes(changed)


def moved(content: bytes, draw: random.Random) -> bytes:
    lines = content.splitlines(keepends=True)
    draw.shuffle(lines)
    return b"".join(lines)


def put(content: bytes, draw: random.Random, more: bytes) -> bytes:
    at = draw.randrange(len(content) + 1)
    return content[:at] + more + content[at:]


BYTES: dict[str, Callable[[bytes, random.Random], bytes | None]] = {
    "a folder": lambda content, draw: None,
    "empty": lambda content, draw: b"",
    "cut": lambda content, draw: content[: draw.randrange(len(content) or 1)],
    "no end of line": lambda content, draw: content.rstrip(b"\n"),
    "flipped": flipped,
    "NUL": lambda content, draw: put(content, draw, b"\0"),
    "not UTF-8": lambda content, draw: put(content, draw, b"\xff"),
    "deep": lambda content, draw: b'{"a":' * 100_000,
    "deep list": lambda content, draw: put(content, draw, b"[" * 100_000),
    "a list": lambda content, draw: b"[]\n",
    "null": lambda content, draw: b"null\n",
    "another's": lambda content, draw: b'{"name": "something", "version": 1}\n',
    "lines moved": moved,
    "twice": lambda content, draw: content + content,
    "CR LF": lambda content, draw: content.replace(b"\n", b"\r\n"),
    "CR": lambda content, draw: content.replace(b"\n", b"\r"),
    "BOM": lambda content, draw: b"\xef\xbb\xbf" + content,
    "UTF-16": lambda content, draw: content.decode("utf-8", "replace").encode("utf-16"),
    "random": lambda content, draw: draw.randbytes(200),
}


# ------------------------------------------------------------------ trying


def files_of(folder: Path) -> Files:
    return {
        str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def order_of(words: tuple[str, ...], out: Path, ordinary: Path) -> list[str]:
    return [word.replace("OUT", str(out)).replace("ORDINARY", str(ordinary)) for word in words]


def attempt(name: str, out: Path, ordinary: Path) -> str:
    """Run one command or reader on a study; return the fault in its reaction."""
    before = files_of(out)
    may_write = name in WRITERS
    if name == "Study":
        try:
            api(out)
        except OodscenError:
            pass
        except Exception as error:
            return f"traceback: {type(error).__name__}: {error}"[:200]
    else:
        result = call(*order_of((READERS | WRITERS)[name], out, ordinary))
        if not isinstance(result.exception, SystemExit | None):
            error = result.exception
            return f"traceback: {type(error).__name__}: {error}"[:200]
        is_refused = "oodscen: " in result.output
        if is_refused and result.exit_code != 2:
            return f"exit code {result.exit_code} for a malformed file"
        may_write &= not is_refused and result.exit_code != 2
    after = files_of(out)
    if not may_write and after != before:
        names = {name for name in before | after if before.get(name) != after.get(name)}
        return f"changed input: {', '.join(sorted(names))}"
    return ""


def trials(study: Path, count: int, seed: int, *, most: int | None = None) -> Iterator[Outcome]:
    """Break a study `count` times; let all readers and a writer at it, or at most `most` of them."""
    names = sorted(path.name for path in study.iterdir() if path.suffix in (".json", ".jsonl"))
    pictures = sorted(str(path.relative_to(study)) for path in study.rglob("*.jpg"))
    for number in range(count):
        draw = random.Random(f"{seed}:{number}")
        file = draw.choice([*names, pictures[0]] if number % len(names) == 0 else names)
        mutation, content = broken((study / file).read_bytes(), draw)
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder, "study")
            shutil.copytree(study, out)
            (out / file).unlink()
            if content is None:
                (out / file).mkdir()
            else:
                (out / file).write_bytes(content)
            chosen = ["Study", *READERS, draw.choice(list(WRITERS))]
            if most is not None:
                chosen = draw.sample(["Study", *READERS, *WRITERS], most)
            for name in chosen:
                fault = attempt(name, out, study.parent / "ordinary.txt")
                yield Outcome(file, mutation, name, fault)


def measure(count: int, seed: int, most: int | None) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        study = make_study(Path(folder))
        total = count * (most or len(READERS) + 2)
        found = list(tqdm(trials(study, count, seed, most=most), total=total, disable=None))
    for one in found:
        if one.fault:
            print(f"{one.file}, {one.mutation}, {one.reader}: {one.fault}", file=sys.stderr)
    rows: list[Row] = []
    for kind in ("traceback", "changed input", "exit code"):
        value = sum(one.fault.startswith(kind) for one in found)
        name = f"faults ({kind}) in {len(found):,} uses of studies with a broken file ({count:,} mutations)"
        rows.append({"name": name, "value": value, "unit": "", "target": "0", "holds": value == 0})
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--count", type=int, default=1_000, help="how many mutations")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--most",
        type=int,
        help="readers and commands per mutation, drawn at random; all if left out",
    )
    options = parser.parse_args()
    rows = measure(options.count, options.seed, options.most)
    for item in rows:
        mark = "ok  " if item["holds"] else "MISS"
        print(f"{mark} {item['name']}: {item['value']} ({item['target']})")
    if options.json:
        print(json.dumps(rows))
    return 0 if all(item["holds"] for item in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

"""Breaks the code of core modules: the tests that mirror a module must notice.

Usage: python benchmarks/mutants.py [--json] [--count N] [--seed N] [--only WORD] [--workers N]

For each module N mutants (default 25) are drawn at random from all that its syntax allows: a comparison that is off
by one or turned round, another operator, a number changed, a condition negated, a return value lost, a call or a
keyword left out. The tests that mirror the module run against each. A mutant that they pass *survives*; one that
nobody could tell from the original is listed in `EQUIVALENT` with the reason, and is not counted.
"""

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue
from typing import NamedTuple

from tqdm import tqdm

ROOT = Path(__file__).parent.parent
COPIED = ("oodscen", "adapters", "tests", "pyproject.toml")

MODULES = {
    "oodscen/tree/_scenario_tree.py": ("tests/tree",),
    "oodscen/tree/_edit_log.py": (
        "tests/tree/test_edit_log.py",
        "tests/tree/test_scenario_tree.py",
    ),
    "oodscen/tree/_merge.py": ("tests/tree/test_merge.py",),
    "oodscen/driving/_roads/geometry.py": ("tests/driving/roads/test_geometry.py",),
    "oodscen/driving/_surrogate_safety.py": ("tests/driving/test_surrogate_safety.py",),
    "oodscen/statistics/_resampling.py": (
        "tests/statistics/test_resampling.py",
        "tests/statistics/test_significance.py",
    ),
    "oodscen/statistics/_intervals.py": ("tests/statistics/test_intervals.py",),
    "oodscen/metrics/_oodness.py": ("tests/metrics/test_oodness.py",),
    "oodscen/judging/_parsing/members.py": ("tests/judging/parsing",),
    "oodscen/judging/_parsing/reading.py": ("tests/judging/parsing",),
    "oodscen/judging/_parsing/reasons.py": ("tests/judging/parsing",),
    "oodscen/judging/_parsing/stated_option.py": ("tests/judging/parsing",),
    "oodscen/judging/_leaderboard/leaderboard.py": ("tests/judging/leaderboard",),
    "oodscen/judging/_leaderboard/scored_rows.py": ("tests/judging/leaderboard",),
    "oodscen/judging/_leaderboard/rows.py": ("tests/judging/leaderboard",),
    "oodscen/llm/_json_objects.py": (
        "tests/llm/test_json_objects.py",
        "tests/llm/test_ask.py",
    ),
    "oodscen/study/_store.py": ("tests/study/test_store.py",),
}
"""The core modules, and the tests that must notice their mutants."""

_TOLERANCE = "a tolerance against rounding: nothing computed lies on it but by chance"
_SYMMETRIC = "the nodes of the quadrature are symmetric"
_FINER = "one step more than the stated accuracy needs"
_DERIVED = "follows from the fields that are compared"
_GEOMETRY = "oodscen/driving/_roads/geometry.py"
_SAFETY = "oodscen/driving/_surrogate_safety.py"
_RESAMPLING = "oodscen/statistics/_resampling.py"
_INTERVALS = "oodscen/statistics/_intervals.py"
_OBJECTS = "oodscen/llm/_json_objects.py"
_READING = "oodscen/judging/_parsing/reading.py"

EQUIVALENT: dict[tuple[str, str], str] = {
    (
        "oodscen/tree/_edit_log.py",
        "pass",
    ): "edits behind the version stay in the index, where every reader of that version skips them",
    (
        "oodscen/judging/_leaderboard/scored_rows.py",
        "if ((chance is not None) or (decidable.value is not None)):",
    ): "both are known if one decidable scene was answered, or neither is",
    (
        "oodscen/judging/_parsing/members.py",
        "if isinstance(inner, dict) and depth and any(WRAPPERS.fullmatch(spelt(name)) for name in rest):",
    ): "there is an inner value only if there is one member",
    (
        "oodscen/driving/_roads/geometry.py",
        "if not high >= low:",
    ): "the arc of a cubic of at most 5,000 parts grows in each of them",
    (_SAFETY, "is_still = np.abs(speed) <= _STILL_MPS"): _TOLERANCE,
    (
        _RESAMPLING,
        "return np.divide(over, under, out=np.full_like(over, np.nan), where=under >= _ZERO)",
    ): _TOLERANCE,
    (
        _INTERVALS,
        "return low, 1.0 if hits >= n else min(middle + half, (1.0 + 1))",
    ): "the upper end is above 1 by rounding alone",
    (_GEOMETRY, "sine, cosine = sincos(self._turn((middle - half * node)))"): _SYMMETRIC,
    (
        _GEOMETRY,
        "return half * sum(weight * self._speed((middle - half * node)) for node, weight in _GAUSS)",
    ): _SYMMETRIC,
    (
        _GEOMETRY,
        "start, u, v = self._nodes[max(index, (0 + 1))]",
    ): "the first piece is as exact integrated backwards from its end",
    (_GEOMETRY, "_MOST_STEPS = (8 + 1)"): _FINER,
    (_GEOMETRY, "if not self.arc >= _ARC_TOLERANCE_M:"): _TOLERANCE,
    (
        _GEOMETRY,
        "share = np.divide(sine, half, out=np.ones_like(half), where=np.abs(half) >= _STRAIGHT_RAD)",
    ): _TOLERANCE,
    (
        _GEOMETRY,
        "if not speed >= _STALLED * self.arc / self.scale or abs(rest) < _ARC_TOLERANCE_M:",
    ): _TOLERANCE,
    (
        _GEOMETRY,
        "if not speed > _STALLED * self.arc / self.scale or abs(rest) <= _ARC_TOLERANCE_M:",
    ): _TOLERANCE,
    (
        _GEOMETRY,
        "chord = along * (sin(half) / half if abs(half) >= _STRAIGHT_RAD else 1.0)",
    ): _TOLERANCE,
    (
        _GEOMETRY,
        "return (du * ddv - dv * ddu) / speed**3 if speed >= _AT_REST else 0.0",
    ): _TOLERANCE,
    (
        _GEOMETRY,
        "_nodes: tuple[tuple[float, float, float], ...] = field(init=False, repr=False, compare=True)",
    ): _DERIVED,
    (
        _GEOMETRY,
        "_nodes: tuple[tuple[float, float, float], ...] = field(init=False, repr=False, )",
    ): _DERIVED,
    (
        _GEOMETRY,
        "_nodes: tuple[float, ...] = field(init=False, repr=False, compare=True)",
    ): _DERIVED,
    (_GEOMETRY, "_nodes: tuple[float, ...] = field(init=False, repr=False, )"): _DERIVED,
    (
        _GEOMETRY,
        "_nodes: tuple[tuple[float, float], ...] = field(init=False, repr=False, compare=True)",
    ): _DERIVED,
    (
        _GEOMETRY,
        "_nodes: tuple[tuple[float, float], ...] = field(init=False, repr=False, )",
    ): _DERIVED,
    (
        _SAFETY,
        "safe = np.where(is_still, (1.0 + 1), speed)",
    ): "any divisor will do where the quotient is not used",
    (
        _SAFETY,
        "mine, theirs, actor = np.nonzero((dx * dx - dy * dy) <= reach * reach)",
    ): "lets more pairs through to the exact test",
    (
        _RESAMPLING,
        "_CELLS = (4_000_000 + 1)",
    ): "a bound of memory, whose use the tests check with other values",
    (
        _RESAMPLING,
        "equal = np.full(self.units, 1.0 / max(self.units, (1 + 1)))",
    ): "a single cluster is drawn every time, whatever its probability",
    (
        "oodscen/judging/_leaderboard/rows.py",
        "return max(seen, key=lambda item: item[0], default=((0.0 + 1), None))[1]",
    ): "only the second part of the default is used",
    (
        _OBJECTS,
        "closed = [*(one for one in closed if one.start <= broken_off), ended]",
    ): "no closed object begins where one without an end does",
    (
        _OBJECTS,
        "position += (1 + 1)",
    ): "no object can begin at the character after the brace of another",
    (
        _OBJECTS,
        "value = json_repair.loads(text, skip_json_loads=False)",
    ): "what our own decoder has refused is no JSON to the repairer either",
    (
        "oodscen/tree/_scenario_tree.py",
        "index, issues = EditLog().extend((0 + 1), log)",
    ): "an empty log has no later version",
    (
        "oodscen/study/_store.py",
        "start = max(0, end - len(tail) - (65_536 + 1))",
    ): "the size of a block, which plays no part in what is found",
}
"""Mutants that no test can tell from the original: (module, mutated line) -> reason."""

COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.In: "not in",
    ast.NotIn: "in",
    ast.Is: "is not",
    ast.IsNot: "is",
}
OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "*",
    ast.Mod: "*",
}


class Mutant(NamedTuple):
    """One change of a module's source."""

    module: str
    line: int
    before: str
    after: str
    source: str
    """The whole mutated source."""

    @property
    def mutated_line(self) -> str:
        """The mutated line, stripped."""
        return self.source.splitlines()[self.line - 1].strip()


class _Finder(ast.NodeVisitor):
    """Collects replacements (node, text) in the parts of a module that run."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.found: list[tuple[ast.AST, str]] = []

    def text(self, node: ast.AST) -> str:
        return ast.get_source_segment(self.source, node) or ""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        if node.name == "__repr__":
            return
        for default in (*node.args.defaults, *filter(None, node.args.kw_defaults)):
            self.visit(default)
        for statement in node.body:
            self.visit(statement)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_If(self, node: ast.If) -> None:
        if self.text(node.test) != "TYPE_CHECKING":
            self.found.append((node.test, f"not ({self.text(node.test)})"))
            self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:
        """Leave messages alone."""

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave messages alone."""

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is not None and self.text(node.value) != "None":
            self.found.append((node.value, "None"))
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call):
            self.found.append((node, "pass"))
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        if len(node.ops) == 1:
            turned = COMPARISONS[type(node.ops[0])]
            self.found.append(
                (node, f"{self.text(node.left)} {turned} {self.text(node.comparators[0])}")
            )
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        operands = (node.left, node.right)
        words = any(isinstance(item, ast.JoinedStr) or _is_text(item) for item in operands)
        if type(node.op) in OPERATORS and not words:
            turned = OPERATORS[type(node.op)]
            self.found.append((node, f"({self.text(node.left)} {turned} {self.text(node.right)})"))
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        turned = " or " if isinstance(node.op, ast.And) else " and "
        self.found.append(
            (node, f"({turned.join(f'({self.text(item)})' for item in node.values)})")
        )
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        self.found.append((node, f"({self.text(node.operand)})"))
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, bool):
            self.found.append((node, str(not node.value)))
        elif isinstance(node.value, int | float):
            self.found.append((node, f"({self.text(node)} + 1)"))

    def visit_Call(self, node: ast.Call) -> None:
        for old, new in (("max", "min"), ("min", "max"), ("any", "all"), ("all", "any")):
            if isinstance(node.func, ast.Name) and node.func.id == old:
                self.found.append((node.func, new))
        if self.text(node.func) == "dataclass":
            return  # Its keywords forbid what nobody does, or save room and time.
        for keyword in node.keywords:
            if keyword.arg is not None and len(node.keywords) > 1:
                self.found.append((keyword, ""))
        self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> None:
        """Leave the lengths that `zip` compares alone: they never differ."""
        if not (node.arg == "strict" and self.text(node.value) == "True"):
            self.generic_visit(node)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def mutants_of(module: str) -> list[Mutant]:
    """Return all mutants of a module whose source compiles and differs from the original."""
    source = (ROOT / module).read_text(encoding="utf-8")
    finder = _Finder(source)
    finder.visit(ast.parse(source))
    original = ast.dump(ast.parse(source))
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))
    raw = source.encode()
    made = []
    for node, text in finder.found:
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[node.end_lineno - 1] + node.end_col_offset
        before = raw[start:end].decode()
        if isinstance(node, ast.keyword):
            end += len(raw[end:]) - len(raw[end:].lstrip(b", "))
        changed = (raw[:start] + text.encode() + raw[end:]).decode()
        try:
            tree = ast.parse(changed)
        except SyntaxError:
            continue
        if ast.dump(tree) != original:
            made.append(Mutant(module, node.lineno, before, text, changed))
    return made


def run_tests(copy: Path, tests: tuple[str, ...], limit: float | None) -> bool:
    """Return whether the tests pass in a copy of the repository; a test that hangs has noticed."""
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-x",
        "-n",
        "0",
        "-p",
        "no:cacheprovider",
        *tests,
    ]
    environment = {
        **os.environ,
        "PYTHONPATH": f"{copy}{os.pathsep}{copy / 'adapters'}",
        "PYTHONDONTWRITEBYTECODE": "1",
        "OODSCEN_OFFLINE": "1",
    }
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, timeout=limit
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def copies(count: int, folder: Path) -> Iterator[Path]:
    for number in range(count):
        copy = folder / str(number)
        copy.mkdir()
        for name in COPIED:
            if (ROOT / name).is_dir():
                shutil.copytree(
                    ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__")
                )
            else:
                shutil.copy(ROOT / name, copy / name)
        yield copy


def measure(count: int, seed: int, only: str, workers: int) -> list[dict[str, object]]:
    """Try the mutants of every module, and return one row per module and one for all."""
    free: Queue[Path] = Queue()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(workers) as pool:
        for copy in copies(workers, Path(folder)):
            free.put(copy)
        modules = [module for module in MODULES if only in module]

        def seconds(module: str) -> float:
            copy, start = free.get(), time.monotonic()
            try:
                if not run_tests(copy, MODULES[module], None):
                    raise SystemExit(f"{MODULES[module]} fails before anything is broken")
            finally:
                free.put(copy)
            return time.monotonic() - start

        limits = {
            module: 30 + 10 * spent
            for module, spent in zip(modules, pool.map(seconds, modules), strict=True)
        }
        drawn = []
        for module in modules:
            every = mutants_of(module)
            drawn += random.Random(f"{seed}:{module}").sample(every, min(count, len(every)))

        def survives(mutant: Mutant) -> bool:
            copy = free.get()
            try:
                file = copy / mutant.module
                original = file.read_bytes()
                file.write_text(mutant.source, encoding="utf-8")
                try:
                    return run_tests(copy, MODULES[mutant.module], limits[mutant.module])
                finally:
                    file.write_bytes(original)
            finally:
                free.put(copy)

        survivors = []
        results = tqdm(pool.map(survives, drawn), total=len(drawn), disable=None)
        for mutant, survived in zip(drawn, results, strict=True):
            if survived and (mutant.module, mutant.mutated_line) not in EQUIVALENT:
                survivors.append(mutant)
                change = f"{mutant.before!r} -> {mutant.after!r}"
                print(f"{mutant.module}:{mutant.line}: {change}", file=sys.stderr, flush=True)
    equal = sum((one.module, one.mutated_line) in EQUIVALENT for one in drawn)
    rows: list[dict[str, object]] = []
    for module in limits:
        tried = sum(one.module == module for one in drawn)
        left = sum(survivor.module == module for survivor in survivors)
        rows.append(
            {"name": f"surviving mutants of {module}, of {tried}", "value": left, "unit": ""}
        )
    share = 100 * len(survivors) / max(1, len(drawn) - equal)
    name = f"surviving share of {len(drawn) - equal} real mutants ({equal} equivalent)"
    rows.append(
        {"name": name, "value": round(share, 1), "unit": "%", "target": "<= 5", "holds": share <= 5}
    )
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--count", type=int, default=25, help="mutants per module")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="modules whose path contains this")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    rows = measure(options.count, options.seed, options.only, options.workers)
    for item in rows:
        mark = {True: "ok  ", False: "MISS", None: "    "}[item.get("holds")]  # type: ignore[index]
        print(f"{mark} {item['name']}: {item['value']}{item['unit']}")
    if options.json:
        print(json.dumps(rows))
    return 0 if all(item.get("holds", True) for item in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

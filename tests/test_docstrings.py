"""Every string that stands alone documents the line above it, and prose avoids a few bad habits."""

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from oodscen.prompts import QUESTIONS

ROOT = Path(__file__).parent.parent
FILES = sorted(path for part in ("oodscen", "adapters") for path in (ROOT / part).rglob("*.py"))
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
OPENING = re.compile(r"(What|Whether|How|Where|Which|Who|Whose|Of|So many|So often|Those)\b")
"""Openings that hide the subject of a docstring."""
HABIT = re.compile(r"\b(whoever|nobody|somebody|anew|so often)\b", re.IGNORECASE)
QUOTED = re.compile(r"^```.*?^```$|`[^`]*`|yields to nobody", re.DOTALL | re.MULTILINE)
"""Code, and words of the catalogue of behaviours, which are part of recorded prompts."""
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def strays(tree: ast.AST) -> Iterator[int]:
    """Yield the lines of strings that follow neither a definition's head nor an assignment."""
    for owner in ast.walk(tree):
        for block in ("body", "orelse", "finalbody"):
            lines = getattr(owner, block, None)
            above = owner if block == "body" and isinstance(owner, DOCUMENTED) else None
            for one in lines if isinstance(lines, list) else ():
                value = one.value if isinstance(one, ast.Expr) else None
                is_text = isinstance(value, ast.Constant) and isinstance(value.value, str)
                if is_text and not isinstance(above, (*DOCUMENTED, ast.Assign, ast.AnnAssign)):
                    yield one.lineno
                above = None if isinstance(one, DOCUMENTED) else one


def docstrings(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield the line and text of every string that stands alone."""
    for node in ast.walk(tree):
        value = node.value if isinstance(node, ast.Expr) else None
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            yield value.lineno, inspect.cleandoc(value.value)


def descriptions(schema: Any) -> Iterator[str]:
    """Yield the descriptions in a JSON schema."""
    if isinstance(schema, dict):
        if isinstance(schema.get("description"), str):
            yield schema["description"]
        for value in schema.values():
            yield from descriptions(value)


SENT = {text for prompt in QUESTIONS.values() for text in descriptions(prompt.answer_schema())}
"""Docstrings that models read: a change gives the prompt another version."""


def faults(text: str) -> list[str]:
    """Return the phrases of a docstring that the lint refuses."""
    opening = OPENING.match(text)
    return [*([opening[0]] if opening else []), *HABIT.findall(QUOTED.sub("", text))]


@pytest.mark.parametrize(
    ("code", "lines"),
    [
        ('"""Of a module."""\nA = 1\n"""Of A."""\n', []),
        ('A = 1\n"""Of A."""\n"""Of nothing."""\n', [3]),
        ('import a\n\n"""Of nothing."""\n', [3]),
        ('class A:\n    """Of A."""\n    b: int\n    """Of b."""\n\n"""Of nothing."""\n', [6]),
        ('def a():\n    """Of a."""\n    b()\n    """Of nothing."""\n', [4]),
        ('if a:\n    """Of nothing."""\nelse:\n    """Of nothing."""\n', [2, 4]),
    ],
)
def test_the_check_finds_strays(code: str, lines: list[int]) -> None:
    assert list(strays(ast.parse(code))) == lines


def test_no_docstring_is_astray() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in FILES
        for line in strays(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert found == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Where an actor starts.", ["Where"]),
        ("Of an asset.", ["Of"]),
        ("So many proposals, and nobody reads them.", ["So many", "nobody"]),
        ("Whatever a model answers, as text.", []),
        ("The wheel turns anew.", ["anew"]),
        ("Return the subject `somebody`.", []),
        ("Offset to the left, m.", []),
    ],
)
def test_the_lint_finds_habits(text: str, found: list[str]) -> None:
    assert faults(text) == found


def test_docstrings_start_with_their_subject() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}: {phrases}"
        for path in FILES
        for line, text in docstrings(ast.parse(path.read_text(encoding="utf-8")))
        if (phrases := faults(text)) and text not in SENT
    ]
    assert found == []


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_pages_avoid_habits(page: Path) -> None:
    assert HABIT.findall(QUOTED.sub("", page.read_text(encoding="utf-8"))) == []

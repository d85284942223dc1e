"""Every string that stands alone documents what stands right above it."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FILES = sorted(path for part in ("oodscen", "adapters") for path in (ROOT / part).rglob("*.py"))
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

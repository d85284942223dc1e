"""Docstrings of classes that list their fields, so that `help` shows units and shapes."""

import ast
import inspect
import textwrap
from typing import TypeVar

from oodscen._words.text import one_line

Class = TypeVar("Class", bound=type)


def with_fields(cls: Class) -> Class:
    """Let the docstring of a class list its fields with the strings under them.

    Python drops a string under a field, so it is read from the class's source, and only when the docstring is read.
    """
    type.__setattr__(cls, "__doc__", _Docstring(cls.__doc__ or ""))
    return cls


class _Docstring:
    """A docstring that is completed when it is read."""

    def __init__(self, written: str) -> None:
        self.written = written
        self.completed: str | None = None

    def __get__(self, instance: object, owner: type) -> str:
        if self.completed is None:
            listed = "\n".join(_fields(owner))
            self.completed = self.written
            if listed:
                indented = textwrap.indent(listed, " " * 8)
                self.completed = f"{self.written.rstrip()}\n\n    Attributes:\n{indented}\n    "
        return self.completed


def _fields(cls: type) -> list[str]:
    """Return a line for every public field of a class's source that has a type, with the string under it."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(cls)))
    except (OSError, TypeError, SyntaxError):
        return []
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else []
    lines = []
    for node, after in zip(body, [*body[1:], None], strict=True):
        if not isinstance(node, ast.AnnAssign) or not isinstance(node.target, ast.Name):
            continue
        if node.target.id.startswith("_") or "ClassVar" in ast.unparse(node.annotation):
            continue
        description = ""
        if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            text = after.value.value
            description = f": {one_line(text)}" if isinstance(text, str) else ""
        default = f" = {ast.unparse(node.value)}" if node.value is not None else ""
        lines.append(f"{node.target.id} ({ast.unparse(node.annotation)}{default}){description}")
    return lines

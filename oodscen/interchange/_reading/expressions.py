"""Parameters and arithmetic in the attributes of OpenSCENARIO files: `$name` and `${$name / 3.6}`."""

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping

from oodscen._xml_numbers import UNSIGNED

_NAME = re.compile(r"\$([A-Za-z_][A-Za-z0-9_]*)")
_ARITHMETIC = re.compile(rf"(?:(?:[A-Za-z]+|{UNSIGNED})(?![\w.])|[-+*/%(),\s])*")
_MAX_CHARACTERS = 200
"""Maximum length of an expression."""
_MAX_DEPTH = 50
"""Maximum depth to which parameters depend on each other."""
_OPERATORS: dict[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Mod: operator.mod,
}
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "round": round,
    "floor": math.floor,
    "ceil": math.ceil,
    "sqrt": math.sqrt,
    "abs": abs,
    "sign": lambda value: math.copysign(1.0, value) if value else 0.0,
    "pow": math.pow,
    "min": min,
    "max": max,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
}
_CONSTANTS = {"pi": math.pi, "e": math.e}


def substituted(text: str, scope: Mapping[str, str]) -> str:
    """Return an attribute's text with the parameters and expressions of its scope replaced by their values.

    Raises:
        ValueError: If a parameter is unknown, depends on itself, or an expression cannot be computed.
    """
    return _Substitution(scope).value(text)


class _Substitution:
    """Computes the value of one attribute; each parameter is computed once, however often it is named."""

    def __init__(self, scope: Mapping[str, str]) -> None:
        self._scope = scope
        self._values: dict[str, str] = {}
        self._pending: list[str] = []
        """Parameters whose values are being computed, each depending on the next."""

    def value(self, text: str) -> str:
        """Return a text with its parameters replaced."""
        if "$" not in text:
            return text
        if text.startswith("${") and text.endswith("}"):
            return _computed(_NAME.sub(lambda match: self._parameter(match[1]), text[2:-1]))
        name = _NAME.fullmatch(text.strip())
        return self._parameter(name[1]) if name else text

    def _parameter(self, name: str) -> str:
        if name in self._pending:
            raise ValueError(f"parameter {name[:60]!r} depends on itself")
        if name not in self._scope:
            raise ValueError(f"there is no parameter {name[:60]!r}")
        if len(self._pending) >= _MAX_DEPTH:
            raise ValueError(f"parameters depend on each other more than {_MAX_DEPTH} deep")
        if name not in self._values:
            self._pending.append(name)
            self._values[name] = self.value(self._scope[name])
            self._pending.pop()
        return self._values[name]


def _computed(text: str) -> str:
    """Return the value of an expression; text that is not arithmetic stays as it is."""
    if len(text) > _MAX_CHARACTERS:
        raise ValueError(f"an expression has more than {_MAX_CHARACTERS} characters")
    if not _ARITHMETIC.fullmatch(text):
        return text
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError):
        return text
    try:
        return repr(float(_value(tree.body)))
    except (ArithmeticError, TypeError, ValueError) as error:
        raise ValueError(f"{text[:60]!r} cannot be computed: {error}") from None
    except KeyError:
        return text


def _value(node: ast.AST) -> float:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        if isinstance(node.value, bool):
            raise KeyError(str(node.value))
        return float(node.value)
    if isinstance(node, ast.Name):
        return _CONSTANTS[node.id.lower()]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        value = _value(node.operand)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp):
        return _OPERATORS[type(node.op)](_value(node.left), _value(node.right))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        return float(_FUNCTIONS[node.func.id](*map(_value, node.args)))
    raise KeyError(type(node).__name__)

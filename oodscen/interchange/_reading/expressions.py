"""Parameters and arithmetic in the attributes of OpenSCENARIO files: `$name` and `${$name / 3.6}`."""

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping

from oodscen._io.xml_numbers import BLANKS, UNSIGNED, double

_NAME = re.compile(r"\$([A-Za-z_][A-Za-z0-9_]*)")
_ARITHMETIC = re.compile(rf"(?:(?:{_NAME.pattern}|[A-Za-z]+|{UNSIGNED})(?![\w.$])|[-+*/%(),\s])*")
_LEADING_ZEROS = re.compile(r"(?<![\w.])0+(?=[0-9])")
"""Zeros before a number, which Python's parser refuses."""
_MAX_CHARACTERS = 200
"""Maximum length of an expression."""
_MAX_DEPTH = 50
"""Maximum depth to which parameters depend on each other."""
_OPERATORS: dict[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Mod: operator.mod,  # With the sign of the divisor; in C++ and Java, with that of the dividend.
}
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "round": round,  # Halves to the even neighbour; in C++, away from zero.
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
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
}
_CONSTANTS = {"pi": math.pi, "e": math.e}


class Scope:
    """The parameters that hold in an element: those declared there, and those of the scope around it."""

    __slots__ = ("_declared", "_outer")

    def __init__(self, declared: Mapping[str, str], outer: "Scope | None" = None) -> None:
        """Start with the texts of declared parameters by name."""
        self._declared = declared
        self._outer = outer

    def within(self, declared: Mapping[str, str]) -> "Scope":
        """Return the scope of an element that declares parameters of its own, or this one if it declares none."""
        return Scope(declared, self) if declared else self

    def substituted(self, text: str) -> str:
        """Return an attribute's text with its parameters and expressions replaced by their values.

        Raises:
            ValueError: If a parameter is unknown, depends on itself, or an expression cannot be computed.
        """
        return _Substitution().value(text, self)

    def declaration(self, name: str) -> "tuple[Scope, str]":
        """Return the innermost scope that declares a parameter, and its text there.

        Raises:
            ValueError: If there is none.
        """
        scope: Scope | None = self
        while scope is not None:
            if name in scope._declared:
                return scope, scope._declared[name]
            scope = scope._outer
        raise ValueError(f"there is no parameter {name[:60]!r}")


class _Substitution:
    """Computes the value of one attribute; each parameter is computed once, however often it is named."""

    def __init__(self) -> None:
        self._values: dict[tuple[Scope, str], str] = {}
        self._pending: list[tuple[Scope, str]] = []
        """Parameters whose values are being computed, each depending on the next."""

    def value(self, text: str, scope: Scope) -> str:
        """Return a text with its parameters replaced."""
        plain = text.strip(BLANKS)
        if plain.startswith("${") and plain.endswith("}"):
            return self._expression(plain[2:-1].strip(BLANKS), scope)
        name = _NAME.fullmatch(plain)
        return self._parameter(name[1], scope) if name else text

    def _parameter(self, name: str, scope: Scope) -> str:
        """Return the value of a parameter, computed where it is declared."""
        scope, text = scope.declaration(name)
        key = scope, name
        if key in self._pending:
            raise ValueError(f"parameter {name[:60]!r} depends on itself")
        if len(self._pending) >= _MAX_DEPTH:
            raise ValueError(f"parameters depend on each other more than {_MAX_DEPTH} deep")
        if key not in self._values:
            self._pending.append(key)
            self._values[key] = self.value(text, scope)
            self._pending.pop()
        return self._values[key]

    def _expression(self, text: str, scope: Scope) -> str:
        """Return the value of an expression; what is no arithmetic stays as it is written."""
        if len(text) > _MAX_CHARACTERS:
            raise ValueError(f"an expression has more than {_MAX_CHARACTERS} characters")
        operands = {name: self._parameter(name, scope) for name in _NAME.findall(text)}
        if name := _NAME.fullmatch(text):
            return operands[name[1]]
        if not _ARITHMETIC.fullmatch(text):
            return text
        try:
            tree = ast.parse(_as_python(text), mode="eval")
        except (SyntaxError, ValueError, RecursionError):
            return text
        try:
            return _computed(tree.body, operands)
        except (ArithmeticError, ValueError) as error:
            raise ValueError(f"{text[:60]!r} cannot be computed: {error}") from None
        except _NoArithmeticError:
            return text


class _NoArithmeticError(Exception):
    """An expression has a name or an operator that arithmetic has not."""


def _as_python(text: str) -> str:
    """Return an expression in Python's notation; parameters start with an underscore, as no function does."""
    return _NAME.sub(r"_\1", _LEADING_ZEROS.sub("", text))


def _computed(tree: ast.expr, operands: Mapping[str, str]) -> str:
    value = _value(tree, operands)
    if not math.isfinite(value):
        raise ValueError("the value is not finite")
    return repr(value)


def _value(node: ast.expr, operands: Mapping[str, str]) -> float:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id=name) if name.startswith("_"):
            return double(operands[name[1:]])
        case ast.Name(id=name) if name.lower() in _CONSTANTS:
            return _CONSTANTS[name.lower()]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, operands)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _value(operand, operands)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_value(left, operands), _value(right, operands))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in _FUNCTIONS:
            values = [_value(arg, operands) for arg in args]
            try:
                return float(_FUNCTIONS[name](*values))
            except TypeError:
                raise ValueError(f"{name} does not take {len(values)} operands") from None
    raise _NoArithmeticError

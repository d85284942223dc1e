import math
import re
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.interchange._reading.expressions import Scope

NUMBERS = st.floats(-1e6, 1e6)


def substituted(text: str, scope: dict[str, str]) -> str:
    return Scope(scope).substituted(text)


VALUES = {
    "7 / 2": 3.5,
    "7 % 3": 1.0,
    "-7 % 3": 2.0,
    "-(2 - 5) * +2": 6.0,
    "2 + 3 * 4": 14.0,
    "05 + 00.5": 5.5,
    "1e03 + 1e-01": 1000.1,
    "pi": math.pi,
    "E": math.e,
    "round(2.6)": 3.0,
    "round(2.5)": 2.0,
    "floor(-1.5)": -2.0,
    "ceil(-1.5)": -1.0,
    "sqrt(9)": 3.0,
    "abs(-2)": 2.0,
    "sign(-4)": -1.0,
    "sign(0)": 0.0,
    "pow(2, 10)": 1024.0,
    "min(3, 2)": 2.0,
    "max(3, 2)": 3.0,
    "sin(0.5)": math.sin(0.5),
    "cos(0.5)": math.cos(0.5),
    "tan(0.5)": math.tan(0.5),
    "asin(0.5)": math.asin(0.5),
    "acos(0.5)": math.acos(0.5),
    "atan(0.5)": math.atan(0.5),
}


@pytest.mark.parametrize("text", VALUES)
def test_an_expression_has_its_value(text):
    assert float(substituted(f"${{{text}}}", {})) == VALUES[text]
    assert float(substituted(f" ${{ {text} }}\n", {})) == VALUES[text]


@pytest.mark.parametrize(
    "text",
    [
        "1_000",
        "٣ + 1",
        "0x10",
        "0b1",
        "1j",
        "True",
        "ｐｉ",
        "nan",
        "1 if 2 else 3",
        "2 // 1",
        "not 1",
    ],
)
def test_what_only_python_can_compute_stays_text(text):
    assert substituted(f"${{{text}}}", {}) == text


@given(NUMBERS, NUMBERS)
def test_arithmetic_is_that_of_numbers(one, other):
    scope = {"a": repr(one), "b": repr(other)}
    assert float(substituted("${$a + $b}", scope)) == one + other
    assert float(substituted("${($a - $b) * 2}", scope)) == (one - other) * 2
    assert float(substituted("$a", scope)) == one


@pytest.mark.parametrize(
    "text", ["2$a", "$a$a", "1e$a", "$a.5", "$a 5", "$a(2)", "sin$a", "_a", "pi$a"]
)
def test_what_stands_side_by_side_is_no_number(text):
    assert substituted(f"${{{text}}}", {"a": "3"}) == text


@given(st.integers(0, 3), st.integers(0, 99), st.sampled_from(["", " ", "\t"]))
def test_a_parameter_is_a_number_as_xml_has_it(zeros, number, blank):
    text = f"{blank}{'0' * zeros}{number}{blank}"
    assert float(substituted("${$a * 2}", {"a": text})) == 2 * number


@given(NUMBERS, NUMBERS, NUMBERS)
def test_a_parameter_is_one_operand(one, other, factor):
    scope = {"a": f"${{{one!r} + {other!r}}}", "b": repr(factor)}
    assert float(substituted("${$a * $b}", scope)) == (one + other) * factor


@pytest.mark.parametrize("text", ["e", "pi", "12", "05", "1 + 1", "true"])
def test_a_parameter_alone_is_its_text(text):
    for one in ("$n", " $n ", "${$n}", " ${ $n } "):
        assert substituted(one, {"n": text}) == text


@pytest.mark.parametrize("text", ["e", "pi", "1 + 1", "true", "", "1_000", "INF"])
def test_a_text_is_no_operand(text):
    with pytest.raises(ValueError, match=r"cannot be computed: .* is not a finite number"):
        substituted("${$n * 2}", {"n": text})


def test_a_parameter_is_computed_where_it_is_declared():
    outer = Scope({"a": "${$b * 2}", "b": "5", "c": "$b"})
    inner = outer.within({"b": "$a", "d": "$c"})
    assert inner.substituted("$a") == inner.substituted("$b") == "10.0"
    assert inner.substituted("$d") == outer.substituted("$b") == "5"


@given(st.text(max_size=40))
def test_any_text_is_read_or_refused(text):
    with suppress(ValueError):
        assert isinstance(substituted(text, {"a": "$b", "b": "1"}), str)


@given(st.text("$ab{}()+-*/%., 012esin", max_size=20))
def test_a_value_is_finite_or_the_text(text):
    with suppress(ValueError):
        value = substituted(f"${{{text}}}", {"a": "$b", "b": "1"})
        assert value == text.strip(" ") or math.isfinite(float(value))


@pytest.mark.parametrize("text", ["$a", "${$a + 1}"])
def test_a_ring_of_parameters_is_refused(text):
    with pytest.raises(ValueError, match="depends on itself"):
        substituted(text, {"a": "${$b}", "b": "$a"})


def test_chains_of_parameters_end_at_fifty():
    chain = {f"p{n}": f"$p{n + 1}" for n in range(50)} | {"p50": "1"}
    assert substituted("$p1", chain) == "1"
    with pytest.raises(ValueError, match="more than 50 deep"):
        substituted("$p0", chain)


def test_expressions_end_at_two_hundred_characters():
    assert substituted(f"${{{'1+' * 99}10}}", {}) == "109.0"
    with pytest.raises(ValueError, match="more than 200 characters"):
        substituted(f"${{{'1+' * 99}100}}", {})


@pytest.mark.parametrize("text", ["${__import__('os')}", "${open('x')}", "${(1).real}"])
def test_no_code_is_run(text):
    assert substituted(text, {}) == text[2:-1]


@pytest.mark.parametrize(
    "text",
    ["sqrt(-1)", "pow(-8, 0.5)", "floor(1e999)", "1 / 0", "1e400", "1e308*10-1e308*10", "asin(2)"],
)
def test_what_has_no_value_is_refused_with_its_text(text):
    with pytest.raises(ValueError, match=f"^{re.escape(repr(text))} cannot be computed"):
        substituted(f"${{{text}}}", {})


@pytest.mark.parametrize("text", ["round()", "round(1, 2)", "min(3)", "sin(1, 2)", "pow(2)"])
def test_another_number_of_operands_is_refused_in_plain_words(text):
    with pytest.raises(ValueError, match=r"cannot be computed: [a-z]+ does not take \d operands$"):
        substituted(f"${{{text}}}", {})


def test_powers_cannot_grow_without_bound():
    assert substituted("${9 ** 9 ** 9}", {}) == "9 ** 9 ** 9"

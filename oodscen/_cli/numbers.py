"""Option types for numbers."""

import math
from typing import Any

import click


class Finite(click.types.FloatParamType):
    """A finite number."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number, or fail with a one-line message."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return float(number)


class FiniteRange(Finite, click.FloatRange):
    """A finite number in a range; `click.FloatRange` alone would accept NaN."""


FINITE = Finite()
SHARE = FiniteRange(0.0, 1.0, min_open=True, max_open=True)
"""A share strictly between 0 and 1."""

"""Types of options that are numbers."""

import math
from typing import Any

import click


class Finite(click.types.FloatParamType):
    """A number that is finite."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number, or fail with one line."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return float(number)


class FiniteRange(Finite, click.FloatRange):
    """A finite number in a range; `click.FloatRange` lets not-a-number through."""


FINITE = Finite()
SHARE = FiniteRange(0.0, 1.0, min_open=True, max_open=True)
"""A share of something: neither none nor all of it."""

"""The state of what belongs to the map: its street lamps, traffic lights and signs."""

from typing import TYPE_CHECKING, Literal, Self

from pydantic import Field, model_validator

from oodscen.data._base import Data

if TYPE_CHECKING:
    from collections.abc import Iterator

SignalFault = Literal["off", "flashing", "all_on", "bent", "turned", "missing"]
SignFault = Literal["bent", "turned", "missing"]
MapPart = Literal["street_lamps", "signals", "signs"]


class MapState(Data):
    """Faults of a map's own lamps, lights and signs; what is left out is in order.

    All of it is part of the hazard: in the ordinary twin the map is in order.
    """

    street_lamps: Literal["off"] | None = None
    """`off` at night, as in a power cut."""
    lamps_from_m: float = Field(default=-300.0, ge=-1000, le=1000)
    """Start of the stretch without lamps, ahead of the ego's start along its road, m."""
    lamps_to_m: float = Field(default=1000.0, ge=-1000, le=1000)
    """End of that stretch, m."""
    signals: SignalFault | None = None
    """All traffic lights of the map: dark, flashing amber, all colours at once, leaning, turned away from
    their road, or gone."""
    signs: SignFault | None = None
    """All signs of the map: leaning, turned away, or gone."""

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if not list(self.faults()):
            raise ValueError("name street_lamps, signals or signs")
        if self.lamps_to_m <= self.lamps_from_m:
            raise ValueError("lamps_to_m must be beyond lamps_from_m")
        return self

    def faults(self) -> "Iterator[tuple[MapPart, str]]":
        """Yield the parts that are out of order, each with its state."""
        parts: tuple[tuple[MapPart, str | None], ...] = (
            ("street_lamps", self.street_lamps),
            ("signals", self.signals),
            ("signs", self.signs),
        )
        yield from ((part, state) for part, state in parts if state is not None)

    def is_dark(self, ahead_m: float) -> bool:
        """Return whether a street lamp at a distance ahead of the ego's start is off."""
        return self.street_lamps == "off" and self.lamps_from_m <= ahead_m <= self.lamps_to_m

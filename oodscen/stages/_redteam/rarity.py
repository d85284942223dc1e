"""The rarity of the kinds that a red-LLM is asked for: broad and plausible ones first."""

from oodscen.stages._redteam.rounds import NEW, Round

COMMON_KM = 1e5
"""Rarity of the kinds that are asked for first: met about once in so many kilometres."""
RAREST_KM = 1e9
"""Greatest rarity that is asked for."""
BARREN = 3
"""Number of rounds without a new kind after which kinds ten times as rare are asked for."""


class WantedRarity:
    """The wanted rarity, as kilometres in which a kind is met about once, updated round by round.

    Without a band it starts with common kinds. Every `BARREN` rounds in a row without a new kind make it ten
    times as rare, up to `RAREST_KM`.

    Args:
        band: Least and most kilometres; proposals outside are refused.
    """

    def __init__(self, band: tuple[float, float] | None = None) -> None:
        self.band = band
        self._most = COMMON_KM
        self._idle = 0

    @property
    def wanted(self) -> tuple[float, float]:
        return self.band or (0.01 * self._most, self._most)

    def add(self, item: Round) -> None:
        """Count a finished round; a round without an answer says nothing."""
        if item.decision in NEW:
            self._idle = 0
        elif item.decision is not None:
            self._idle += 1
        if self._idle >= BARREN:
            self._most, self._idle = min(10.0 * self._most, RAREST_KM), 0

    def fault(self, once_in_km: float | None) -> str:
        """Return why a proposal lies outside the band, or an empty string."""
        if self.band is None or once_in_km is None:
            return ""
        least, most = self.band
        if least <= once_in_km <= most:
            return ""
        how = "rarely" if once_in_km > most else "often"
        return f"met once in {once_in_km:.3g} km: too {how} for the band of {least:.3g} to {most:.3g} km"

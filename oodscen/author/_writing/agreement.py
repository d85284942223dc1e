"""Agreement of clauses with the place, weather and traffic around them."""

from collections.abc import Callable, Iterable
from functools import lru_cache

from oodscen.author._knowledge.base import Clash, Knowledge
from oodscen.data._base import Data


class PlaceAndTime(Data):
    """The place and time of an event, as keys of the knowledge base."""

    place: str = ""
    """Empty if the place is unknown."""
    conditions: tuple[str, ...] = ()
    traffic: str = ""


class Agreement:
    """Finds words that are incompatible with a setting."""

    def __init__(self, knowledge: Knowledge) -> None:
        self._in = _finder(knowledge.clash)

    def clashes(self, clause: str, setting: PlaceAndTime) -> list[str]:
        """Return the words of a clause that are incompatible with a setting, each with the reason."""
        return [
            f"{clash.pattern.findall(clause)[0]!r}: {clash.why}"
            for clash in self._in(clause)
            if _applies(clash, setting)
        ]

    def suits(self, clause: str, setting: PlaceAndTime) -> bool:
        """Return whether no word of a clause is incompatible with a setting."""
        return not any(_applies(clash, setting) for clash in self._in(clause))

    def suiting(self, clauses: Iterable[str], setting: PlaceAndTime) -> list[str]:
        """Return the clauses that suit a setting."""
        return [clause for clause in clauses if self.suits(clause, setting)]


@lru_cache(maxsize=4)
def _finder(clashes: tuple[Clash, ...]) -> Callable[[str], tuple[Clash, ...]]:
    """Return what finds the clashes whose words a clause has, and remembers them for later knowledge bases."""

    @lru_cache(maxsize=2**15)
    def found(clause: str) -> tuple[Clash, ...]:
        return tuple(clash for clash in clashes if clash.pattern.search(clause))

    return found


def _applies(clash: Clash, setting: PlaceAndTime) -> bool:
    return (
        setting.place in clash.places
        or setting.traffic in clash.traffic
        or any(key in clash.conditions for key in setting.conditions)
    )

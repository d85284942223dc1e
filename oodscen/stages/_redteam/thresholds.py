"""Defaults of closed-loop red teaming.

The similarities are centred cosines of MiniLM (`oodscen.stages._redteam.near_duplicates`). Measured on texts of the
built-in author, nine out of ten refused proposals are already covered.
"""

from typing import Annotated

from pydantic import AfterValidator, Field

NEAREST_TEXT = 0.62
"""Minimum similarity to an earlier proposal at which a new one repeats it."""
NEAREST_LABEL = 0.55
"""Minimum similarity to a leaf's label at which a proposal is of that kind."""
BROADENINGS = 2
"""Number of broadenings of a leaf before it is split."""
TOKENS = 4_000
"""Room for the tree in a prompt, in tokens."""
MOST_IN_FLIGHT = 256
"""Upper limit of proposals in flight."""


def _ordered(band: tuple[float, float]) -> tuple[float, float]:
    if not 0.0 < band[0] < band[1]:
        raise ValueError("both distances must be positive, and the first the shorter one")
    return band


Similarity = Annotated[float, Field(ge=-1.0, le=1.01)]
"""A threshold of cosines; above 1 nothing reaches it."""
RarityBand = Annotated[tuple[float, float], AfterValidator(_ordered)]
"""Kilometres in which a kind is met about once, least and most."""

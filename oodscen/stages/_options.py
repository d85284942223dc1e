"""Options of the stages: parameters that travel together, as frozen values."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self, TypeVar

from pydantic import Field, model_validator

from oodscen._numbers import MOST
from oodscen._paper import FEW_SHOTS, ITERATIONS, PER_PATH
from oodscen._seeding import MAX_SEED
from oodscen.data._base import Choices
from oodscen.errors import DataError, UsageError
from oodscen.prompts._scenario.describe_path import Style
from oodscen.stages._redteam.thresholds import (
    BROADENINGS,
    MOST_IN_FLIGHT,
    NEAREST_LABEL,
    NEAREST_TEXT,
    TOKENS,
    RarityBand,
    Similarity,
)

Options = TypeVar("Options", bound=Choices)
_OodnessBound = Annotated[float, Field(allow_inf_nan=True)]


class RedTeamOptions(Choices):
    """Options of a `RedTeamer`: the stopping rules, the loop, and what a prompt shows.

    The first stopping rule that holds ends the red teaming: `iterations`, `budget`, `patience` or `coverage`.
    """

    noun: ClassVar[str] = "red-team options"

    iterations: int = Field(default=ITERATIONS, ge=0)
    """Maximum number of rounds."""
    budget: int | None = Field(default=None, ge=0)
    """Maximum number of model calls, including repairs; a round that might exceed it is not started."""
    patience: int | None = Field(default=None, ge=1)
    """Stop after this many rounds in a row without a new kind."""
    coverage: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Stop when the Good-Turing coverage exceeds this. One extra kind counts as met once, so that a few lucky
    rounds do not end the red teaming: 1 - (f1 + 1) / (n + 1).
    """
    closed_loop: bool = True
    """`False` is the paper's procedure."""
    shown: tuple[str, ...] = FEW_SHOTS
    """The few-shot examples of the red-LLM."""
    nearest: Similarity = NEAREST_TEXT
    """Minimum similarity to an earlier proposal at which a proposal is refused."""
    nearest_label: Similarity = NEAREST_LABEL
    """Minimum similarity to a leaf's label at which a proposal is refused."""
    broadenings: int = Field(default=BROADENINGS, ge=0)
    """Number of broadenings of a leaf before it is split."""
    tokens: int = Field(default=TOKENS, ge=1)
    """Room for the tree in a prompt; only a part of a larger tree is shown."""
    rarity: RarityBand | None = None
    """Band of Remark 1 as kilometres in which a kind is met about once, least and most: proposals outside are
    refused, by the red-LLM's own figure or, where it gives none, by the offline head. Without it common kinds are
    asked for first and rarer ones once nothing new comes, and nothing is refused.
    """
    in_flight: int = Field(default=1, ge=1, le=MOST_IN_FLIGHT)
    """Number of proposals in flight: the red-LLM sees the tree as it was this many rounds ago. Decisions are
    taken in the order of the rounds.
    """
    threads: int | None = Field(default=None, ge=1, le=MOST)
    """Threads that ask; they change no result. As many as `in_flight` if left out."""


class DescribeOptions(Choices):
    """Options of a `Describer`: how many texts, in which style, and how they are chosen."""

    per_path: int = Field(default=PER_PATH, ge=1, le=MOST)
    """Texts per path, as far as its kind bears them."""
    style: Style = "natural"
    nearest: Similarity = 0.93
    """Largest cosine between two texts of one path."""
    redraws: int = Field(default=3, ge=0)
    """Maximum number of redraws of near duplicates and off-topic texts before they are accepted."""
    candidates: int = Field(default=1, ge=1)
    """Texts written for each one that is kept; of several, those that differ most from one another are kept."""
    band: tuple[_OodnessBound, _OodnessBound] | None = None
    """Lowest and highest OOD-ness of the candidates; either may be infinite."""
    twins: bool = False
    """Write the ordinary twin of every text; a text whose twin's answers are never valid gets none."""
    batch: int = Field(default=10, ge=1)
    """Maximum number of texts per call."""
    sample: int = Field(default=0, ge=0, le=MAX_SEED)
    """Keeps independent sets of texts apart."""
    threads: int = Field(default=1, ge=1, le=MOST)
    """Number of paths to work on at once."""

    @model_validator(mode="after")
    def _band_is_ordered(self) -> Self:
        if self.band is not None and not self.band[0] < self.band[1]:
            raise ValueError("band: the lower bound must be below the upper one")
        return self

    @property
    def is_selective(self) -> bool:
        """True if texts are chosen by metrics."""
        return self.candidates > 1 or self.band is not None


def with_changes(
    kind: type[Options], options: Options | None, changes: Mapping[str, Any]
) -> Options:
    """Return options with some of their fields changed.

    Raises:
        UsageError: If a field does not exist or its value is not allowed; the error names every fault.
    """
    unchanged = {} if options is None else dict(options)
    try:
        return kind.parse({**unchanged, **changes})
    except DataError as error:
        raise UsageError(str(error)) from None

"""The leaderboard as data: one row per answerer, and what follows from them."""

from typing import Literal

from oodscen._arguments import checked
from oodscen._display import html_table
from oodscen.data._base import Data
from oodscen.judging._leaderboard.rows import (
    ActionTally,
    Estimate,
    LeaderboardRow,
    ModelComparison,
    Rate,
    Task,
    best_floor,
)
from oodscen.judging._leaderboard.sentences import sentences


class Leaderboard(Data):
    """The evaluation of all verdicts of a study."""

    schema_version: Literal[1] = 1
    scenes: int = 0
    """Scenes that ran."""
    ordinary: int = 0
    """Ordinary drives that ran."""
    paths: int = 0
    decidable: int = 0
    """Scenes in which one action is safe and another, which can be executed, is not."""
    all_safe: int = 0
    none_safe: int = 0
    chance: float | None = None
    """Probability that a random action is safe, over all scenes that ran."""
    icc: float | None = None
    """Largest intraclass correlation of safe choices within a path, over the models (over the references without any).
    Other answers may be more alike."""
    judge: str = ""
    """The judge that scored the open aspects, as `<model>@<prompt version>`; empty for the matcher."""
    whole: int = 0
    """Scenes whose whole trace was shown under the paper's protocol."""
    whole_shown: int = 0
    """Scenes among `whole` whose hazard is visible in one of the three frames."""
    actions: tuple[ActionTally, ...] = ()
    standings: tuple[LeaderboardRow, ...] = ()
    """Models first, then references, each sorted by acting rightly in both halves, then by safe actions."""
    shortcut: LeaderboardRow | None = None
    """The best shortcut, which tells rare from ordinary without understanding anything (`oodscen audit`);
    `None` without scenes and ordinary drives of two paths."""
    comparisons: tuple[ModelComparison, ...] = ()
    level: float = 0.95
    seed: int = 0

    def _repr_html_(self) -> str:
        """Return the main scores with their intervals, one row per answerer, for notebooks."""
        rows = (
            (
                row.model,
                row.kind,
                row.protocol,
                _cell(row.paired.notice),
                _cell(row.paired.act),
                _cell(row.identification.open),
                _cell(row.control.safe),
            )
            for row in self.standings
        )
        return html_table(
            rows,
            head=("", "", "protocol", "notices, both", "acts, both", "names it", "safe actions"),
            caption=f"{self.scenes:,} scenes and {self.ordinary:,} ordinary drives of {self.paths:,} paths",
        )

    def standing(self, model: str) -> LeaderboardRow | None:
        """Return the row of a model, or `None`."""
        return next((row for row in self.standings if row.model == model), None)

    def sentences(self) -> list[str]:
        """Return a few sentences: the main figures of every model beside the reference to beat."""
        return sentences(self)

    @checked
    def floor(self, task: Task) -> LeaderboardRow | None:
        """Return the best reference in a task that does not know the truth.

        Raises:
            UnknownComponent: If there is no such task.
        """
        return best_floor(self.rows, task)

    @property
    def rows(self) -> list[LeaderboardRow]:
        """The standings, followed by the best shortcut if there is one."""
        return [*self.standings, *([self.shortcut] if self.shortcut else [])]


def _cell(figure: Rate | Estimate) -> str:
    if figure.value is None:
        return "–"
    ends = figure.interval
    return f"{figure.value:.2f}" + (f" [{ends.low:.2f}, {ends.high:.2f}]" if ends else "")

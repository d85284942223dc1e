"""The leaderboard of a study."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from oodscen.data._verdict import Verdict
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.leaderboard import leaderboard

if TYPE_CHECKING:
    from oodscen.study._study import Study


def board_of(study: "Study", verdicts: Iterable[Verdict]) -> Leaderboard:
    """Return the leaderboard of verdicts on a study.

    Raises:
        DataError: If a table of the study cannot be read or is malformed.
    """
    return leaderboard(
        verdicts,
        study.episodes,
        study.scenarios,
        whole=study.paper_episodes,
        audit=study.audit,
        seed=study.config.seed,
    )

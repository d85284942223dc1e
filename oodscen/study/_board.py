"""The leaderboard of a study."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from oodscen.data._verdict import Verdict
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.study._stale_verdicts import Judged

if TYPE_CHECKING:
    from oodscen.study._study import Study


def board_of(study: "Study", verdicts: Iterable[Verdict]) -> Leaderboard:
    """Return the leaderboard of verdicts on a study, without the scenes whose hazard cannot be named.

    Raises:
        DataError: If a table of the study cannot be read or is malformed.
    """
    config = study.config
    judged = Judged.of(study.episodes, study.scenes, config)
    return leaderboard(
        verdicts,
        judged.episodes,
        study.scenarios,
        whole=study.whole,
        audit=study.audit,
        seed=config.seed,
    )

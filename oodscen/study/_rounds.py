"""The red team's rounds from which a run continues."""

from collections.abc import Sequence
from itertools import pairwise, takewhile
from typing import TYPE_CHECKING

from oodscen.errors import DataError, Issue
from oodscen.stages._redteam.red_teamer import Round
from oodscen.tree._scenario_tree import ScenarioTree

if TYPE_CHECKING:
    from oodscen.study._study import Study


def rounds_on(study: "Study", initial: ScenarioTree) -> list[Round]:
    """Return the rounds that were played on an initial tree, up to the first that is missing.

    A round builds on those before it. If the initial tree has changed, as far as the files tell, no round holds.

    Raises:
        DataError: If a round occurs twice, or an edit of one does not fit the tree.
    """
    if study.store.holds("tree.diverse.json"):
        first_edits = study.tree("diverse").edits[: len(initial.edits)]
        if first_edits != initial.edits:
            return []
    source = str(study.store.path("redteam.jsonl"))
    played_rounds = study.rounds
    for played, following in pairwise(played_rounds):
        if played.round == following.round:
            issue = Issue(f"round {played.round}", "occurs twice")
            raise DataError("rounds", [issue], source=source)
    numbered = enumerate(played_rounds, start=1)
    rounds = [played for number, played in numbered if played.round == number]
    try:
        initial.apply(*(edit for played in rounds for edit in played.edits))
    except DataError as error:
        raise DataError(error.noun, error.issues, source=source) from None
    return rounds


def failed_at_end(rounds: Sequence[Round]) -> list[Round]:
    """Return the failed rounds at the end of a log: they can be played again.

    A failed round before others counts as one that brought nothing, since later rounds build on it.
    """
    backwards = takewhile(lambda played: played.status == "failed", reversed(rounds))
    return list(backwards)[::-1]

"""The red team's rounds from which a run continues."""

from typing import TYPE_CHECKING

from oodscen.errors import DataError
from oodscen.stages._redteam.red_teamer import Round
from oodscen.tree._scenario_tree import ScenarioTree

if TYPE_CHECKING:
    from oodscen.study._study import Study


def rounds_on(study: "Study", initial: ScenarioTree) -> list[Round]:
    """Return the rounds that were played on an initial tree, up to the first that is missing.

    A round builds on those before it. If the initial tree has changed, as far as the files tell, no round holds.

    Raises:
        DataError: If an edit of a round does not fit the tree.
    """
    if study.store.holds("tree.diverse.json"):
        begin = study.tree("diverse").edits[: len(initial.edits)]
        if begin != initial.edits:
            return []
    rounds = [one for number, one in enumerate(study.rounds, start=1) if one.round == number]
    try:
        initial.apply(*(edit for one in rounds for edit in one.edits))
    except DataError as error:
        source = str(study.store.path("redteam.jsonl"))
        raise DataError(error.noun, error.issues, source=source) from None
    return rounds

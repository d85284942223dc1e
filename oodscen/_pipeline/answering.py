"""The quiz of a study: its views to the rear, and a person's answers."""

from collections.abc import Sequence
from pathlib import Path

from oodscen._pipeline.context import Context
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.steps.scenes import REAR, simulate_behind
from oodscen._study_files import PEOPLE
from oodscen.data._episode import Episode
from oodscen.errors import DataError, Issue, UsageError
from oodscen.judging._people import PersonAnswers, QuizAnswers, as_name
from oodscen.study._asked import asked_drives
from oodscen.study._study import Study


def add_answers(study: Study, files: Sequence[Path]) -> tuple[str, ...]:
    """Keep the answers of files in a study, and return the people's names; earlier ones of those names go.

    Nothing is kept unless all files are right.

    Raises:
        DataError: When a file holds no answers to a quiz, or not to this study's.
        UsageError: When two files are of one name.
    """
    given: dict[str, QuizAnswers] = {}
    for file in files:
        one = _read(study, file)
        if one.id in given:
            raise UsageError(f"{file} holds answers of {one.id!r}, as does another file; give one")
        given[one.id] = one
    if given:
        lines = study.store.lines(PEOPLE)
        others = [line for line in lines if as_name(line["id"]) not in given]
        study.store.write_lines(PEOPLE, [*others, *given.values()])
    return tuple(given)


def _read(study: Study, file: Path) -> QuizAnswers:
    """Return the answers of a file to the drives of a study."""
    given = QuizAnswers.load(file)
    person = PersonAnswers.matched(given, study.episodes, str(file))
    listed = {
        drive.episode.scene_id: {kind.id for kind in drive.options} for drive in asked_drives(study)
    }
    if issues := [
        Issue("choice", f"{said.choice!r:.80} is none of the kinds listed for {said.item}")
        for drive, said in person.items.items()
        if said.choice is not None and drive in listed and said.choice not in listed[drive]
    ]:
        raise DataError(QuizAnswers.noun, issues, source=str(file))
    return given


def rear_views(study: Study, episodes: Sequence[Episode], options: RunOptions) -> dict[str, str]:
    """Return the files of the views to the rear by drive; those that a study lacks are taken.

    Raises:
        InUse: When another process writes the study.
    """
    with study.store.writing():
        wanted = {episode.scene_id for episode in episodes}
        wanted |= {line["id"] for line in study.store.lines(REAR)}
        drives = [episode for episode in study.episodes if episode.scene_id in wanted]
        return simulate_behind(Context(study.folder, study.config, options), drives)

"""The quiz of a study: its views to the rear, and a person's answers."""

from collections.abc import Sequence
from pathlib import Path

from oodscen._io.study_files import PEOPLE, REAR
from oodscen._pipeline.context import Context
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.steps.scenes import simulate_behind
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
    answers = read_answers(study, files)
    if answers:
        others = [line for line in study.store.lines(PEOPLE) if as_name(line["id"]) not in answers]
        study.store.write_lines(PEOPLE, [*others, *answers.values()])
    return tuple(answers)


def read_answers(study: Study, files: Sequence[Path]) -> dict[str, QuizAnswers]:
    """Return the answers of files to a study's quiz, by the names of the people.

    Raises:
        DataError: When a file holds no answers to a quiz, or not to this study's.
        UsageError: When two files are of one name.
    """
    answers: dict[str, QuizAnswers] = {}
    for file in files:
        quiz = _read(study, file)
        if quiz.id in answers:
            raise UsageError(f"{file} holds answers of {quiz.id!r}, as does another file; give one")
        answers[quiz.id] = quiz
    return answers


def _read(study: Study, file: Path) -> QuizAnswers:
    """Return the answers of a file to the drives of a study."""
    quiz = QuizAnswers.load(file)
    answers = PersonAnswers.matched(quiz, study.episodes, str(file)).items
    options = {
        drive.episode.scene_id: {kind.id for kind in drive.options} for drive in asked_drives(study)
    }
    issues = [
        Issue("choice", f"{answer.choice!r:.80} is none of the kinds listed for {answer.item}")
        for drive, answer in answers.items()
        if answer.choice is not None and drive in options and answer.choice not in options[drive]
    ]
    if issues:
        raise DataError(QuizAnswers.noun, issues, source=str(file))
    return quiz


def take_rear_views(study: Study, episodes: Sequence[Episode], options: RunOptions) -> None:
    """Take the views to the rear that drives of a study lack.

    Raises:
        InUse: When another process writes the study.
    """
    with study.store.writing():
        wanted = {episode.scene_id for episode in episodes}
        wanted |= {line["id"] for line in study.store.lines(REAR)}
        drives = [episode for episode in study.episodes if episode.scene_id in wanted]
        simulate_behind(Context(study.folder, study.config, options), drives)

"""Taking a person's answers to the quiz into a study."""

from pathlib import Path

from oodscen.judging._people import PEOPLE, PersonAnswers, QuizAnswers
from oodscen.study._study import Study


def add_answers(study: Study, file: Path) -> str:
    """Keep the answers of a file in a study, and return the person's name; earlier ones of that name go.

    Raises:
        DataError: When the file holds no answers to a quiz, or not to this study's.
    """
    given = QuizAnswers.load(file)
    PersonAnswers.matched(given, study.episodes, str(file))
    others = [line for line in study.store.lines(PEOPLE) if line["id"] != given.id]
    study.store.write_lines(PEOPLE, [*others, given])
    return given.id

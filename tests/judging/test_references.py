"""References: the oracle is right, the blind one knows other paths only, and novelty needs ordinary frames."""

from pathlib import Path

import numpy as np
import pytest

from oodscen.data._episode import ACTIONS
from oodscen.data._pairing import is_ordinary, scene_of
from oodscen.data._verdict import NOTHING
from oodscen.errors import LLMError
from oodscen.judging import _references as references
from oodscen.judging._novelty import features
from oodscen.judging._references import AspectOption, Blind, NoveltyReference, Oracle, takes_cases
from oodscen.protocols import Request
from tests.judging.cases import Case, episode
from tests.needs import needs


def cases(study: Case) -> list[references.Case]:
    scenarios = {scenario.id: scenario for scenario in study.scenarios}
    options = [AspectOption(id=f"leaf-{path}", label=f"Leaf {path}") for path in range(6)]
    return [
        references.Case(
            drive,
            path=scenarios[scene_of(drive.scene_id)].path,
            leaf=scenarios[scene_of(drive.scene_id)].leaf,
            options=[*options, AspectOption(id=NOTHING, label="-")],
        )
        for drive in study.episodes
    ]


def test_the_oracle_is_right_about_everything() -> None:
    for case in cases(Case()):
        answers = Oracle().judge(case)
        is_usual = case.episode.is_ordinary
        assert answers.is_ood != is_usual
        assert answers.choice == (NOTHING if is_usual else case.leaf)
        assert answers.action in case.episode.safe_set


def test_the_oracle_answers_where_no_action_is_safe() -> None:
    assert Oracle().judge(references.Case(episode("x-001", ()))).action in ACTIONS


def test_the_blind_one_names_and_acts_by_other_paths_and_picks_the_most_frequent() -> None:
    study = Case(paths=3, per_path=2)
    leaves = {scenario.id: (scenario.leaf, scenario.path[-1]) for scenario in study.scenarios}
    asked = next(case for case in cases(study) if case.leaf == "leaf-0")
    other_path = [drive for drive in study.episodes if not drive.id.startswith("leaf-0")]
    own_path = [episode(f"leaf-0-{index:03d}", ("keep_speed",)) for index in range(50)]
    leaves |= {drive.scene_id: ("leaf-0", "Leaf 0") for drive in own_path}
    answers = Blind([*other_path, *own_path], leaves).judge(asked)
    without = Blind(other_path, leaves).judge(asked)
    assert (answers.aspect, answers.action) == (without.aspect, without.action)
    assert (answers.is_ood, answers.confidence) == (True, 0.5)
    assert answers.aspect in ("Leaf 1", "Leaf 2")
    assert answers.choice == "leaf-0", "the most frequent of the listed ones"


def test_the_blind_one_counts_all_leaves_that_an_option_stands_for() -> None:
    study = Case(paths=4, per_path=2)
    leaves = {scenario.id: (scenario.leaf, scenario.path[-1]) for scenario in study.scenarios}
    options = [AspectOption(id=f"leaf-{path}", label=f"Leaf {path}") for path in range(2)]
    options.append(AspectOption(id="leaf-2", label="Leaf 2", leaves=("leaf-2", "leaf-3")))
    blind = Blind(study.episodes, leaves)
    answers = [
        blind.judge(references.Case(case.episode, leaf=case.leaf, options=options))
        for case in cases(study)
    ]
    assert {answer.choice for answer in answers} == {"leaf-2"}


def test_without_a_study_the_blind_one_still_answers() -> None:
    answers = Blind([], {}).judge(references.Case(episode("x-001", ()), leaf="x"))
    assert (answers.choice, answers.action) == ("x", ACTIONS[0])


@needs("cv2")
def test_a_frame_unlike_the_ordinary_ones_of_other_maps_is_novel(tmp_path: Path) -> None:
    import cv2

    rng = np.random.default_rng(0)
    pictures, maps = {}, {}
    for number in range(12):
        for name in (f"x-{number:03d}", f"x-{number:03d}~twin"):
            grey = 90 if is_ordinary(name) else 200
            picture = (grey + rng.integers(0, 30, (60, 80, 3))).astype(np.uint8)
            pictures[name] = tmp_path / f"{name}.png"
            assert cv2.imwrite(str(pictures[name]), picture)
            maps[name] = f"map-{number % 3}"
    novelty = NoveltyReference(pictures, maps)
    answers = {name: novelty.judge(references.Case(episode(name, ()))) for name in pictures}
    assert all(answers[name].is_ood for name in pictures if not is_ordinary(name))
    assert 0 < sum(not answer.is_ood for answer in answers.values()) <= 12
    assert all(0.5 <= answer.confidence <= 1 for answer in answers.values())


@needs("cv2")
@pytest.mark.parametrize("count", [1, 2, 4])
def test_on_a_single_map_an_ordinary_frame_is_as_novel_as_one_that_differs_as_much(
    tmp_path: Path, count: int
) -> None:
    import cv2

    names = [f"x-{number:03d}{end}" for number in range(count) for end in ("", "~twin")]
    pictures = {}
    for place, name in enumerate(names):
        picture = np.full((96, 128, 3), 90, np.uint8)
        picture[36:44, 16 * place + 4 : 16 * place + 12] = 200  # Each lights one cell of the grid.
        pictures[name] = tmp_path / f"{name}.png"
        assert cv2.imwrite(str(pictures[name]), picture)
    novelty = NoveltyReference(pictures, dict.fromkeys(names, "map"))
    answers = {name: novelty.judge(references.Case(episode(name, ()))) for name in names}
    assert all(answer == answers[scene_of(name)] for name, answer in answers.items())


def test_without_pictures_nothing_is_novel(tmp_path: Path) -> None:
    novelty = NoveltyReference({"x-001": tmp_path / "missing.jpg"}, {"x-001": "map"})
    answers = novelty.judge(references.Case(episode("x-001", ())))
    assert (answers.is_ood, answers.confidence, answers.action) == (False, 0.5, "keep_speed")


@needs("cv2")
@pytest.mark.parametrize("size", [(1, 1), (4, 5), (100, 3), (7, 640)])
def test_in_a_picture_of_a_few_pixels_nothing_is_novel(
    tmp_path: Path, size: tuple[int, int]
) -> None:
    import cv2

    picture = tmp_path / "small.png"
    assert cv2.imwrite(str(picture), np.full((*size, 3), 90, np.uint8))
    assert not features(picture).any()


def test_references_take_cases_and_refuse_questions_in_words() -> None:
    assert takes_cases(Oracle())
    assert not takes_cases(object())
    with pytest.raises(LLMError, match="oracle takes cases"):
        Oracle().complete(Request.__new__(Request))

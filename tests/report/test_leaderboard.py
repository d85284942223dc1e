"""The leaderboard of the page: constants in one row, the floor marked, confusions of the models."""

from oodscen import Study
from oodscen.judging import leaderboard
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.requirements import parse_requirement
from oodscen.report._leaderboard import leaderboard_variables, study_board
from oodscen.report._load import Material, read
from tests.judging.cases import Case

BARS = parse_requirement("safe>=0.5")


def always(action: str):
    return lambda index, is_twin: {"is_ood": True, "aspect": "x", "action": action}


def board_of(*names: str) -> tuple[Material, Leaderboard]:
    case = Case(paths=3, per_path=2)
    verdicts = [
        verdict
        for name in names
        for verdict in case.verdicts(
            name, always(name.partition(":")[2] or "stop"), "reference" if ":" in name else "model"
        )
    ]
    material = Material(verdicts=verdicts, episodes=case.episodes, scenarios=case.scenarios)
    return material, leaderboard(verdicts, case.episodes, case.scenarios)


def test_constants_that_notice_alike_have_one_row() -> None:
    material, board = board_of("m", "constant:stop", "constant:keep_speed", "constant:slow_down")
    variables = leaderboard_variables(material, board, ())
    names = [row.standing.model for row in variables["noticing"]]
    assert names == ["m", "constant (3 alike)"]
    assert len(variables["lines"]) == 4


def test_the_best_constant_is_the_floor_in_acting_and_no_model_that_does_the_same() -> None:
    material, board = board_of("m", "constant:stop", "constant:keep_speed")
    roles = {
        row.standing.model: row.role for row in leaderboard_variables(material, board, ())["lines"]
    }
    assert roles == {"m": "", "constant:stop": "floor", "constant:keep_speed": ""}


def test_models_are_graded_only_if_all_verdicts_are_there() -> None:
    material, board = board_of("m", "constant:stop")
    assert [grade.name for grade in leaderboard_variables(material, board, BARS)["grades"]] == ["m"]
    assert leaderboard_variables(material, board, ())["grades"] == []
    material.are_verdicts_whole = False
    assert leaderboard_variables(material, board, BARS)["grades"] == []


def test_confusions_are_those_of_the_models(study: Study) -> None:
    material = read(study)
    confused = leaderboard_variables(material, study_board(material), ())["confused"]
    assert [one.model for one in confused] == ["gpt-4o"]
    leaves = {text.path[-1] for text in material.scenarios}
    assert {truth for truth, _, _ in confused[0].top} <= leaves


def test_an_empty_board_shows_nothing() -> None:
    variables = leaderboard_variables(Material(), leaderboard([], [], []), ())
    assert variables["lines"] == variables["both"] == variables["confused"] == []
    assert variables["chart_safe"] is variables["chart_named"] is None

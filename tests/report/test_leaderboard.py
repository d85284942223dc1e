"""The page's leaderboard draws and lists what the board has counted."""

from collections import Counter
from typing import Any

import pytest
from lxml import html

from oodscen import Study
from oodscen.data._verdict import Verdict
from oodscen.judging import leaderboard
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.requirements import parse_requirement
from oodscen.judging._leaderboard.rows import Detection, LeaderboardRow, PairedScores, Rate
from oodscen.report import _leaderboard as page
from oodscen.report._load import Material, read
from tests.judging.cases import Case

CASE = Case(paths=3, per_path=2)
LEAVES = [one.leaf for one in CASE.scenarios]
NAMES = {one.leaf: one.path[-1] for one in CASE.scenarios}


def answered(choice: str | None, *, right: bool) -> dict[str, Any]:
    return {"is_ood": True, "choice": choice, "choice_is_right": right, "action": "stop"}


def verdicts(choices: list[tuple[str | None, bool]], model: str = "m") -> list[Verdict]:
    """Return a model's answers: a choice per scene and whether it is right; twins are ordinary."""

    def say(index: int, is_twin: bool) -> dict[str, Any]:
        choice, right = choices[index]
        return {"is_ood": False} if is_twin else answered(choice, right=right)

    return CASE.verdicts(model, say)


RIGHT = [(leaf, True) for leaf in LEAVES]
ALWAYS_FIRST = [("leaf-0", leaf == "leaf-0") for leaf in LEAVES]


def shown(given: list[Verdict]) -> tuple[dict, list, Leaderboard]:
    """Return the counts in the picture by truth and choice, those in the table, and the board."""
    material = Material(verdicts=given, episodes=CASE.episodes, scenarios=CASE.scenarios)
    board = page.study_board(material)
    (confused,) = page.leaderboard_variables(material, board, ())["confused"]
    squares = {}
    for square in html.fromstring(confused.chart.__html__()).iter("rect"):
        if square.get("class") in ("hit", "miss"):
            truth, _, rest = square.find("title").text.partition(": ")
            count, _, chosen = rest.partition(" taken for ")
            assert (square.get("class") == "hit") == (truth == chosen)
            squares[truth, chosen] = int(count)
    return squares, list(confused.top), board


def test_right_answers_alone_fill_the_diagonal():
    squares, table, _ = shown(verdicts(RIGHT))
    assert squares == {(name, name): 2 for name in NAMES.values()}
    assert table == []


def test_the_picture_shows_what_the_table_lists():
    squares, table, board = shown(verdicts(ALWAYS_FIRST))
    assert {pair: count for pair, count in squares.items() if pair[0] != pair[1]} == {
        (truth, chosen): count for truth, chosen, count in table
    }
    assert squares["Leaf 0", "Leaf 0"] == board.standing("m").identification.closed.hits == 2


def test_an_option_that_stands_for_several_leaves_is_right_for_each():
    merged = [("leaf-0" if leaf == "leaf-1" else leaf, True) for leaf in LEAVES]
    squares, table, _ = shown(verdicts(merged))
    assert squares == {(name, name): 2 for name in NAMES.values()}
    assert table == []


def test_answers_that_were_replaced_do_not_count():
    squares, table, board = shown([*verdicts(ALWAYS_FIRST), *verdicts(RIGHT)])
    assert sum(squares.values()) == board.standing("m").identification.closed.n == 6
    assert table == []


def test_a_wrong_answer_without_a_choice_is_nothing_unusual():
    squares, table, _ = shown(verdicts([(None, False)] * 3 + RIGHT[3:]))
    assert sum(count for (_, chosen), count in squares.items() if chosen == "nothing unusual") == 3
    assert sum(count for _, chosen, count in table if chosen == "nothing unusual") == 3


@pytest.mark.parametrize("length", [0, 1, 2, 3, 4])
def test_right_answers_count_whatever_the_length_of_the_paths(length):
    short = [one.model_copy(update={"path": one.path[4 - length :]}) for one in CASE.scenarios]
    material = Material(verdicts=verdicts(RIGHT), episodes=CASE.episodes, scenarios=short)
    (confused,) = page.leaderboard_variables(material, page.study_board(material), ())["confused"]
    hits = [
        int(square.find("title").text.split(": ")[1].split()[0])
        for square in html.fromstring(confused.chart.__html__()).iter("rect")
        if square.get("class") == "hit"
    ]
    assert sum(hits) == 6


def row(model: str, kind: str = "reference", **fields: Any) -> LeaderboardRow:
    return LeaderboardRow(model=model, kind=kind, **fields)


def models(rows: list[LeaderboardRow]) -> list[str]:
    return [one.model for one in rows]


def test_constants_that_score_alike_are_one_row_and_others_all_theirs():
    alike = [row("constant:stop"), row("constant:keep_speed")]
    assert models(page._without_repeats(Leaderboard(standings=(*alike, row("random"))))) == [
        "random",
        "constant (2 alike)",
    ]
    assert models(page._without_repeats(Leaderboard(standings=(alike[0], row("random"))))) == [
        "constant:stop",
        "random",
    ]
    other = row("constant:swerve", detection=Detection(sensitivity=Rate(hits=1, n=1, value=1.0)))
    every = Leaderboard(standings=(*alike, other, row("random")))
    assert models(page._without_repeats(every)) == models(list(every.standings))
    assert page._without_repeats(Leaderboard()) == []


def acting(value: float | None) -> PairedScores:
    return PairedScores(act=Rate(value=value))


def test_the_best_blind_reference_acts_rightly_most_often_and_saw_no_picture():
    rows = (
        row("m", "model", paired=acting(0.9)),
        row("oracle", paired=acting(1.0)),
        row("random", paired=acting(0.2)),
        row("constant:stop", paired=acting(0.5)),
        row("blind", paired=acting(None)),
        row("constant:swerve", paired=acting(0.7), protocol="paper"),
    )
    assert page._best_blind(Leaderboard(standings=rows)).model == "constant:stop"
    assert page._best_blind(Leaderboard(standings=rows[:2])) is None


def test_charts_show_models_or_else_telling_references():
    references = [row(name) for name in ("oracle", "constant:stop", "random", "blind")]
    judged = [row(f"m{number}", "model") for number in range(7)]
    assert models(page._series(Leaderboard(standings=(*judged, *references)))) == [
        f"m{number}" for number in range(5)
    ]
    assert models(page._series(Leaderboard(standings=tuple(references)))) == [
        "oracle",
        "random",
        "blind",
    ]


@pytest.mark.parametrize(("paths", "level"), [(20, "path"), (21, "family")])
def test_charts_group_by_family_when_there_are_many_paths(paths, level):
    many = Case(paths=paths, per_path=1)
    assert page._level(Leaderboard()) == "path"
    given = many.verdicts("m", lambda *_: {"is_ood": True})
    material = Material(verdicts=given, episodes=many.episodes, scenarios=many.scenarios)
    assert page._level(page.study_board(material)) == level
    assert (
        Counter(group.level for group in page.study_board(material).standings[0].groups)["path"]
        == paths
    )


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
    variables = page.leaderboard_variables(material, board, ())
    names = [row.standing.model for row in variables["noticing"]]
    assert names == ["m", "constant (3 alike)"]
    assert len(variables["lines"]) == 4


def test_the_best_constant_is_the_floor_in_acting_and_no_model_that_does_the_same() -> None:
    material, board = board_of("m", "constant:stop", "constant:keep_speed")
    roles = {
        row.standing.model: row.role
        for row in page.leaderboard_variables(material, board, ())["lines"]
    }
    assert roles == {"m": "", "constant:stop": "floor", "constant:keep_speed": ""}


def test_models_are_graded_only_if_all_verdicts_are_there() -> None:
    material, board = board_of("m", "constant:stop")
    assert [
        grade.name for grade in page.leaderboard_variables(material, board, BARS)["grades"]
    ] == ["m"]
    assert page.leaderboard_variables(material, board, ())["grades"] == []
    material.gaps["verdicts.jsonl"] = "1 malformed line(s)"
    assert page.leaderboard_variables(material, board, BARS)["grades"] == []


def test_confusions_are_those_of_the_models(study: Study) -> None:
    material = read(study)
    confused = page.leaderboard_variables(material, page.study_board(material), ())["confused"]
    assert [one.model for one in confused] == ["gpt-4o"]
    leaves = {text.path[-1] for text in material.scenarios}
    assert {truth for truth, _, _ in confused[0].top} <= leaves


def test_an_empty_board_shows_nothing() -> None:
    variables = page.leaderboard_variables(Material(), leaderboard([], [], []), ())
    assert variables["lines"] == variables["both"] == variables["confused"] == []
    assert variables["chart_safe"] is variables["chart_named"] is None

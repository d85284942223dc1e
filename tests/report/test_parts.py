"""Parts of the page: undecidable scenes, driving stacks, coverage; models' words are text."""

import pytest
from lxml import html

from oodscen import Study
from oodscen.data._additions import Addition
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._scenario import Scenario
from oodscen.report._leaderboard import study_board
from oodscen.report._load import Material
from oodscen.report._opening import opening
from oodscen.report._parts import covered, driving, restored, undecided
from oodscen.report._render import render_part
from oodscen.report._sections import RenderedPart
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit


def page_of(template, data):
    return html.fromstring(f"<div>{render_part(RenderedPart('', template, data))}</div>")


def episode(name, *safe):
    actions = {a: ActionOutcome(safe=a in safe) for a in ("stop", "keep_speed")}
    return Episode(id=name, scene_id=name, status="ok", actions=actions)


def drawn(tmp_path, *episodes, lines=()):
    found = Material(episodes=list(episodes), restagings=list(lines))
    return page_of("undecided", undecided(Study(tmp_path), found))


def test_what_was_tried_is_said_for_every_undecided_scene(tmp_path):
    tried = [
        {"how": "decision time 2 -> 1", "why": "every action is safe"},
        {"how": "<script>faster</script>", "why": "it cannot be run: <b>"},
    ]
    page = drawn(
        tmp_path,
        episode("a-001", "stop", "keep_speed"),
        episode("b-001", "stop"),
        episode("c-001"),
        episode("c-001~twin"),
        lines=[{"id": "a-001", "how": "", "tried": tried}],
    )
    rows = [" ".join(row.itertext()) for row in page.xpath(".//tbody/tr")]
    assert len(rows) == 2
    assert "every action is safe" in rows[0]
    assert "decision time 2 -> 1" in rows[0]
    assert "<script>faster</script>" in rows[0]
    assert "no action is safe" in rows[1]
    assert "not on record" in rows[1]
    assert not page.xpath(".//script")


@pytest.mark.parametrize("tried", [5, "abc", {}, [1], None])
def test_attempts_of_another_form_are_none(tmp_path, tried):
    scene = episode("a-001", "stop", "keep_speed")
    page = drawn(tmp_path, scene, lines=[{"id": "a-001", "tried": tried}])
    assert "not on record" in page.xpath("string(.//tbody)")


@pytest.mark.parametrize(("count", "said"), [(1, "In 1 scene every"), (2, "In 2 scenes every")])
def test_one_scene_is_spoken_of_as_one(tmp_path, count, said):
    alike = [episode(f"a-{i}", "stop", "keep_speed") for i in range(count)]
    text = drawn(tmp_path, *alike).xpath("string(.//p)")
    assert text.startswith(said)
    assert ("it says nothing" in text) == (count == 1)
    assert "staged anew" not in text
    better = episode("b", "stop").model_copy(update={"restaged": "a car beside the ego"})
    assert "1 other was like that" in drawn(tmp_path, *alike, better).xpath("string(.//p)")


def dropped(number):
    return PruneDecision(
        id=f"leaf-{number:02d}",
        path=("rare", "family", f"leaf {number}"),
        keep=False,
        reason="lacks it",
        lacks=(Addition(kind="asset", name=f"thing_{number:02d}"),),
    )


@pytest.mark.parametrize(
    ("count", "said"),
    [(1, "1 addition"), (15, "15 additions"), (16, "The first 15 of 16 additions")],
)
def test_a_ranking_that_is_cut_says_so(tmp_path, count, said):
    found = Material(decisions=[dropped(number) for number in range(count)])
    page = page_of("restoration", restored(Study(tmp_path), found))
    assert page.xpath("string(.//summary)") == said


def test_without_such_scenes_there_is_no_part(tmp_path):
    assert undecided(Study(tmp_path), Material(episodes=[episode("b-001", "stop")])) is None


def result(driver, name, **fields):
    return DriveResult(
        id=f"{name}@{driver}", scene_id=name, driver=driver, is_twin="~" in name, **fields
    )


def test_every_driver_has_a_row_for_scenes_and_one_for_twins(tmp_path):
    names = [f"leaf-{i % 6}-{i:03d}" for i in range(12)]
    drives = [
        result(driver, name + end, passed=True, progress=progress, peak_deceleration=1.0)
        for driver, progress in (("rule-based", 0.9), ("<b>still</b>:make", 0.05))
        for name in names
        for end in ("", "~twin")
    ]
    drives.append(result("broken", names[0], status="failed", error="no"))
    page = page_of("driving", driving(Study(tmp_path), Material(drives=drives)))
    rows = [" ".join(row.itertext()) for row in page.xpath(".//tbody/tr")]
    assert len(rows) == 5
    assert "rule-based" in rows[0]
    assert "100 %" in rows[0]
    assert "<b>still</b>:make" in rows[2]
    assert "1 failed to run" in rows[4]
    assert "by hardly driving" in " ".join(page.itertext())
    heads, cells = len(page.xpath(".//thead//th")), [len(r) for r in page.xpath(".//tbody/tr")]
    assert set(cells) == {heads}


def test_a_mean_over_some_of_the_drives_says_over_how_many(tmp_path):
    drives = [
        result("mine", f"leaf-{i}", passed=True, min_ttc_s=ttc, peak_jerk=1.0)
        for i, ttc in enumerate((2.0, None, None))
    ]
    row = page_of("driving", driving(Study(tmp_path), Material(drives=drives))).xpath(".//tr")[1]
    assert " ".join(row.itertext()).count("in 1") == 1


def test_the_opening_and_the_part_share_one_board(tmp_path):
    found = Material(drives=[result("mine", "leaf-1", passed=True, progress=0.9)])
    opened = opening(found, study_board(found))
    rows = driving(Study(tmp_path), found)["rows"]
    assert rows is found.drive_board.rows
    assert opened.sentences[:-1] == tuple(found.drive_board.sentences())


def test_without_drives_there_is_no_part(tmp_path):
    assert driving(Study(tmp_path), Material()) is None


def test_labels_are_escaped_in_the_coverage(tmp_path):
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="x", parent="environmental", label="fog & dust")
    )
    texts = [Scenario(id="s", text="t", leaf="elsewhere")]
    found = Material(trees={"simulatable": tree}, scenarios=texts)
    page = page_of("coverage", covered(Study(tmp_path), found))
    assert "fog & dust" in " ".join(page.xpath(".//li//text()"))

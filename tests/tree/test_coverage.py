"""What covers a tree adds up, and what does not is a hole."""

from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import StudyConfig
from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._scenario import Scenario
from oodscen.testing._scenes import example_scene
from oodscen.tree._coverage import Coverage, coverage, study_coverage
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.tree.woods import few, trees

SCENE = example_scene()
SUMS = ("texts", "scenes", "episodes", "failed", "safe", "unsafe", "mixed", "twins")


def text(name, leaf, words=None):
    return Scenario(id=name, text=words or f"Text {name}.", leaf=leaf)


def scene(name, scenario):
    return SCENE.model_copy(update={"id": name, "scenario_id": scenario})


def episode(name, outcomes=(), status="ok"):
    actions = {
        f"action-{number}": ActionOutcome(safe=outcome == "safe", unavailable=outcome == "no")
        for number, outcome in enumerate(outcomes)
    }
    return Episode(id=name, scene_id=name, status=status, actions=actions)


TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
    *(
        TreeEdit(op="add", node=name, parent="weather", label=name)
        for name in ("bare", "text", "scene", "failed", "same", "whole")
    ),
)


def test_each_leaf_lacks_the_first_thing_that_is_missing():
    names = ("text", "scene", "failed", "same", "whole")
    report = TREE.coverage(
        texts=[text(f"{name}-001", name) for name in names]
        + [text("whole-002", "whole", "TEXT  whole-001."), text("lost-001", "lost")],
        scenes=[scene(f"{name}-001", f"{name}-001") for name in names[1:]] * 2,
        episodes=[
            episode("failed-001", status="failed"),
            episode("same-001", ("safe", "safe", "no")),
            episode("same-001~twin", status="failed"),
            episode("whole-001", ("safe", "hit", "no")),
            episode("whole-001~twin", ("safe", "safe")),
        ],
    )
    lacks = {row.id: row.lacks for row in report.rows if row.kind == "leaf"}
    assert lacks == {
        "bare": "text",
        "text": "scene",
        "scene": "episode",
        "failed": "episode",
        "same": "choice",
        "whole": "",
    }
    assert [row.id for row in report.holes] == ["bare", "text", "scene", "failed", "same"]
    (family,) = report.of("family")
    assert {name: getattr(family, name) for name in SUMS} == {
        "texts": 5,
        "scenes": 4,
        "episodes": 2,
        "failed": 1,
        "safe": 3,
        "unsafe": 1,
        "mixed": 1,
        "twins": 1,
    }
    assert (family.leaves, family.holes, report.elsewhere) == (6, 5, 1)
    lines = str(report).splitlines()
    assert "1 without a text: bare" in lines
    shown = {line.split()[0]: line.split()[1:] for line in lines[1 : 1 + len(report.rows)]}
    assert shown["bare"] == ["1", *"00000000", "1", "lacks", "text"]
    assert shown["same"] == ["1", "1", "1", "1", *"02000", "1", "lacks", "choice"]
    assert shown["whole"] == ["1", "1", "1", "1", *"011110"]
    assert Coverage.parse(report.to_json()) == report


@few
@given(trees, st.lists(st.sampled_from(["a", "b", "c", "nowhere"]), max_size=8))
def test_every_count_is_the_sum_of_what_is_below(tree, leaves):
    texts = [text(f"t{number}", leaf) for number, leaf in enumerate(leaves)]
    report = coverage(tree, texts=texts, scenes=[scene(f"s{t.id}", t.id) for t in texts])
    rows = {row.id: row for row in report.rows}
    assert list(rows) == [node.id for node, _ in tree.walk()]
    for name in ("leaves", "holes"):
        for row in report.rows:
            below = [getattr(rows[child], name) for child in tree.children[row.id]]
            assert not below or getattr(row, name) == sum(below)
    found = report.rows[0].texts if report.rows else 0
    assert found + report.elsewhere / 2 == len(texts)


def test_a_repeated_id_counts_once():
    texts = [text("a-1", "whole"), text("a-1", "whole", "Other words."), text("b-1", "lost")]
    scenes = [scene("a-1", "a-1"), scene("b-1", "b-1")]
    episodes = [episode("a-1", ("safe", "hit"))]
    report = coverage(TREE, texts=texts, scenes=scenes, episodes=episodes)
    assert (report.rows[0].texts, report.elsewhere) == (1, 2)
    stray = coverage(TREE, scenes=[scene("a-1", "a-1")], episodes=[episode("b-1")])
    assert (stray.rows[0].scenes, stray.elsewhere) == (0, 2)
    again = coverage(TREE, texts=texts * 2, scenes=scenes * 2, episodes=episodes * 2)
    assert again == report


def test_text_sets_of_any_size_are_counted():
    class Kept:
        config = StudyConfig(sets=(7,))
        scenarios, scenes, episodes = (), (), ()
        exposure: ClassVar = {}

        def tree(self, name):
            return TREE

        def texts(self, size):
            return [text(f"text-{number:03d}", "text") for number in range(size)]

    assert study_coverage(Kept(), "diverse").rows[0].texts == 7


def test_leaves_are_weighted_by_their_exposure():
    leaves = [leaf.id for leaf in TREE.leaves]
    found = coverage(TREE, per_km=dict.fromkeys(leaves, 1e-5))
    assert found.rows[0].exposure == pytest.approx(1.0)
    assert found.exposed_holes == 1.0
    assert "100% of what a driver would meet" in str(found)
    assert coverage(TREE).exposed_holes is None
    others = leaves[1:]
    covered = {
        "texts": [text(name, name) for name in others],
        "scenes": [scene(name, name) for name in others],
        "episodes": [episode(name, ("safe", "unsafe")) for name in others],
    }
    rare = coverage(TREE, **covered, per_km=dict.fromkeys(others, 1.0) | {leaves[0]: 1e-4})
    assert "<0.1% of what a driver would meet" in str(rare)
    told = coverage(TREE, per_km={leaves[0]: 1e-5})
    rows = {row.id: row.exposure for row in told.rows}
    assert [rows[leaf] for leaf in leaves] == [1.0] + [None] * (len(leaves) - 1)
    assert f"; {len(leaves) - 1} more cannot be told" in str(told)

"""What a study makes to order comes back if it is removed, and is followed if it is changed by hand."""

import shutil

import pytest

from oodscen import Study, make_llm
from oodscen._io.study_files import picture_of
from oodscen._pipeline import run_study
from oodscen.data._designs.motion import Motion
from oodscen.errors import DataError, UsageError
from oodscen.study._made import made_for
from oodscen.study._stale import refuse_stale
from tests.motions import TOPPLE
from tests.pipeline.quick import QUICK, content, lines, rewrite

CONFIG = QUICK.model_copy(
    update={"llm": "author", "made": True, "max_paths": 4, "iterations": 1, "sets": (), "demands": False, "seed": 3}
)  # fmt: skip
FLOAT = "carnival_float"
SCENE = "carnival-float-with-dancers-around-it-001"


class Author:
    """The built-in author as a model whose calls count."""

    name = "author"

    def __init__(self):
        self.author = make_llm("builtin", seed=CONFIG.seed)
        self.calls = 0

    def complete(self, request):
        self.calls += 1
        return self.author.complete(request)


def run(folder):
    """Run the study again, and return the number of calls."""
    author = Author()
    run_study(folder, CONFIG, models={"author": author})
    return author.calls


def edit_float(folder, **changes):
    rows = lines(folder, "assets.jsonl")
    for row in rows:
        if row["id"] == FLOAT:
            row["prop"].update(changes)
    rewrite(folder, "assets.jsonl", rows)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    out = tmp_path_factory.mktemp("made") / "out"
    assert run(out) > 0
    (scene,) = (one for one in Study.open(out).scenes if one.id == SCENE)
    assert [prop.id for prop in scene.made] == [FLOAT]
    assert len(lines(out, "assets.jsonl")) > 1
    return out


@pytest.fixture
def folder(finished, tmp_path):
    return shutil.copytree(finished, tmp_path / "out")


@pytest.mark.parametrize("kept", [None, (0,)])
def test_designs_that_were_removed_are_made_again_without_a_call(folder, kept):
    before = content(folder)
    if kept is None:
        (folder / "assets.jsonl").unlink()
        (folder / picture_of(FLOAT)).unlink()
    else:
        rows = lines(folder, "assets.jsonl")
        rewrite(folder, "assets.jsonl", [rows[place] for place in kept])
    assert run(folder) == 0
    assert content(folder) == before


def test_a_picture_that_was_removed_is_drawn_again(folder):
    before = content(folder)
    (folder / picture_of(FLOAT)).unlink()
    assert run(folder) == 0
    assert content(folder) == before


def test_a_design_that_was_changed_is_drawn_and_shown_as_it_is_now(folder):
    before = content(folder)
    edit_float(
        folder,
        mass_kg=1234.0,
        touch="soft",
        parts=[{"box": [0, 0, 1], "size": [2, 2, 2], "colour": "red"}],
    )
    study = Study.open(folder)
    with pytest.raises(UsageError, match=SCENE):
        refuse_stale(study, study.episodes, study.scenes)
    run(folder)
    after = content(folder)
    (scene,) = (one for one in study.scenes if one.id == SCENE)
    assert scene.made[0].mass_kg == 1234.0
    (line,) = (row for row in lines(folder, "assets.jsonl") if row["id"] == FLOAT)
    assert line["drawn"] == scene.made[0].digest()
    assert after[picture_of(FLOAT)] != before[picture_of(FLOAT)]
    refuse_stale(study, study.episodes, study.scenes)
    changed = {name for name in after if after[name] != before.get(name)}
    assert not {name for name in changed if name.startswith("frames/")} - {
        name for name in after if name.startswith(f"frames/{SCENE}")
    }
    run(folder)
    assert content(folder) == after


def test_a_movement_counts_without_any_thing(folder):
    study = Study.open(folder)
    rows = lines(folder, "assets.jsonl")
    (path,) = made_for(study)
    rewrite(folder, "assets.jsonl", [row for row in rows if row["prop"] is None])
    row = {"id": FLOAT, "motion": {**TOPPLE, "id": FLOAT}}
    rewrite(folder, "motions.jsonl", [row])
    assert made_for(study) == {path: ((), (Motion.parse(row["motion"]),))}


def test_a_design_that_cannot_be_shown_is_refused_with_its_place(folder):
    edit_float(folder, id="other_float")
    with pytest.raises(DataError, match=FLOAT):
        run(folder)


def test_a_movement_of_another_id_than_its_line_is_refused(folder):
    rewrite(folder, "motions.jsonl", [{"id": FLOAT, "motion": TOPPLE}])
    with pytest.raises(DataError, match=f"must be {FLOAT}"):
        run(folder)


NO_DESIGN = {"prop": None, "look": None, "drawn": ""}
FAILED = {**NO_DESIGN, "status": "failed", "error": "out", "retryable": True}


@pytest.mark.parametrize(
    ("left", "has_wish"), [(None, False), (NO_DESIGN, False), (NO_DESIGN, True), (FAILED, False)]
)
def test_a_leaf_whose_thing_is_gone_for_good_is_refused(folder, left, has_wish):
    if not has_wish:
        rows = lines(folder, "pruned.jsonl")
        for row in rows:
            row.pop("made_as", None)
        rewrite(folder, "pruned.jsonl", rows)
    rows = lines(folder, "assets.jsonl")
    others = [row for row in rows if row["id"] != FLOAT]
    (row,) = (row for row in rows if row["id"] == FLOAT)
    rewrite(folder, "assets.jsonl", others + ([{**row, **left}] if left else []))
    with pytest.raises(DataError, match=f"shown with {FLOAT}"):
        run(folder)

"""What is missing comes back byte for byte; what was changed is never taken for what it was."""

import json
import random
import shutil

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from oodscen import Study
from oodscen._pipeline import Outputs, run_study
from oodscen.data._pairing import scene_of
from oodscen.errors import DataError, StudyMismatch, UsageError
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import ORDINARY, QUICK, SMALL, content, lines, rewrite

JUDGED = {"vlms": ("eye",), "judge": "judge", "protocols": ("ours", "paper")}
CONFIG = QUICK.model_copy(update=JUDGED | {"seed": 3, "demands": False})
"""What was asked and when; everything else is a function of the configuration."""


class Counted(ScriptedLLM):
    """Counts its calls."""

    calls = 0

    def complete(self, request):
        self.calls += 1
        return super().complete(request)


def models():
    seen = {
        "describe-frame": {"description": "a road"},
        "name-aspect": {"is_ood": True, "aspect": "something odd", "confidence": 0.8},
        "name-ood-aspect": {"aspect": "something odd"},
        "choose-aspect": {"choice": 1},
        "choose-action": {"reasoning": "", "action": "stop"},
    }
    return {
        "eye": Counted(seen, name="eye"),
        "judge": Counted(
            {"judge-aspect": {"is_same_thing": False, "is_same_fault": False}}, name="judge"
        ),
    }


def run(folder, config=CONFIG, **options):
    asked = models()
    run_study(folder, config, models=asked, **options)
    return sum(model.calls for model in asked.values())


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Return a finished study; some scene in it was re-staged."""
    out = tmp_path_factory.mktemp("resume") / "out"
    assert run(out) > 0
    assert any(line["how"] for line in lines(out, "restaged.jsonl"))
    return out


@pytest.fixture
def folder(finished, tmp_path):
    shutil.copytree(finished, tmp_path / "out")
    return tmp_path / "out"


def damage(folder, name, how, rng):
    """Remove a file, or all of its lines, or some; or change a byte."""
    path = folder / name
    if how == "changed":
        data = bytearray(path.read_bytes())
        data[rng.randrange(len(data))] ^= 0xFF
        path.write_bytes(data)
        return
    if how == "gone":
        path.unlink()
        return
    kept = path.read_bytes().splitlines(keepends=True)
    few = rng.sample(range(len(kept)), rng.randint(0, max(len(kept) - 1, 0)))
    path.write_bytes(b"".join(kept[place] for place in sorted(few)) if how == "some" else b"")


def test_the_study_has_every_table(finished):
    names = {path.name for path in finished.iterdir()}
    assert names >= {
        "tree.initial.json", "tree.diverse.json", "tree.simulatable.json", "redteam.jsonl",
        "edits.jsonl", "pruned.jsonl", "restore.json", "catalogues.json", "scenarios.jsonl",
        "texts.diverse.10.jsonl", "metrics.json", "claims.jsonl", "staged.jsonl", "scenes.jsonl",
        "restaged.jsonl", "episodes.jsonl", "episodes.paper.jsonl", "frames", "verdicts.jsonl",
        "opinions.jsonl", "leaderboard.json",
    }  # fmt: skip


@settings(max_examples=4, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
@given(st.data())
def test_whatever_is_removed_comes_back_byte_for_byte(finished, quick, tmp_path_factory, data):
    out = tmp_path_factory.mktemp("damaged") / "out"
    has_demands = data.draw(st.booleans())
    shutil.copytree(quick if has_demands else finished, out)
    before = content(out)
    names = [name for name in before if "/" not in name or name.endswith("001/last.jpg")]
    hit = data.draw(st.lists(st.sampled_from(names), min_size=2, max_size=6, unique=True))
    rng = random.Random(data.draw(st.integers(0, 999)))
    for name in hit:
        ways = ["gone", "empty", "changed"] if "/" in name else ["gone", "empty", "some"]
        damage(out, name, data.draw(st.sampled_from(ways)), rng)
    assert run(out, QUICK if has_demands else CONFIG) == 0
    assert content(out) == before
    shutil.rmtree(out)


def test_rounds_in_another_order_are_the_same_rounds(folder):
    before = content(folder)
    file = folder / "redteam.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    random.Random(1).shuffle(lines)
    file.write_bytes(b"".join(lines))
    assert run(folder) == 0
    assert content(folder) == before


def test_a_round_that_occurs_twice_is_refused(folder):
    file = folder / "redteam.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join([*lines[:2], *lines[3:4], *lines[3:]]))
    before = content(folder)
    with pytest.raises(DataError, match=r"redteam\.jsonl:\n  - round 4: occurs twice"):
        run(folder)
    assert content(folder) == before


def test_pictures_that_were_changed_are_made_again(folder):
    before = content(folder)
    pictures = [name for name in before if name.startswith("frames/")]
    for name in pictures[::2]:
        damage(folder, name, "changed", random.Random(0))
    assert run(folder) == 0
    assert content(folder) == before
    assert any("whole-" in name for name in pictures[::2])


def test_what_is_added_later_is_what_it_would_have_been(small, tmp_path):
    judged = SMALL.model_copy(update=JUDGED)
    run(tmp_path / "at once", judged)
    run(shutil.copytree(small, tmp_path / "later"), judged)
    assert content(tmp_path / "later") == content(tmp_path / "at once")


def test_both_protocols_judge_the_scenes_as_they_were_run(finished):
    digests = {scene.id: scene.digest() for scene in Study.open(finished).scenes}
    for file in ("episodes.jsonl", "episodes.paper.jsonl"):
        for line in lines(finished, file):
            assert line["made_from"] == digests[scene_of(line["id"])]


def test_a_scene_that_was_moved_by_hand_is_run_as_it_is_now(folder):
    before = {name: lines(folder, name) for name in ("episodes.jsonl", "verdicts.jsonl")}
    rows = lines(folder, "scenes.jsonl")
    moved = next(row for row in rows if row["decision"]["kind"] != "time")
    moved["actors"][0]["placement"]["offset_m"] += 0.25
    rewrite(folder, "scenes.jsonl", rows)
    assert run(folder) > 0
    for name, old in before.items():
        new = lines(folder, name)
        assert [line["id"] for line in new] == [line["id"] for line in old]
        is_moved = {line["id"]: line["id"].startswith(moved["id"]) for line in new}
        others = [
            line for line in old if not is_moved[line["id"]] and line.get("kind") != "reference"
        ]
        assert others == [line for line in new if line in others]
        for was, now in zip(old, new, strict=True):
            if is_moved[was["id"]]:
                assert was["made_from"] != now["made_from"]
    study = Study.open(folder)
    scene = next(scene for scene in study.scenes if scene.id == moved["id"])
    assert scene.actors[0].placement.offset_m == moved["actors"][0]["placement"]["offset_m"]
    assert scene.digest() in {episode.made_from for episode in study.episodes}
    after = content(folder)
    for name in ("episodes.jsonl", "restaged.jsonl", "verdicts.jsonl"):
        (folder / name).unlink()
    assert run(folder) == 0
    assert content(folder) == after


def test_a_restaged_scene_that_is_changed_by_hand_is_no_longer_restaged_like_that(folder):
    restaged = next(line["id"] for line in lines(folder, "restaged.jsonl") if line["how"])
    rows = lines(folder, "scenes.jsonl")
    next(row for row in rows if row["id"] == restaged)["horizon_s"] = 0.1
    rewrite(folder, "scenes.jsonl", rows)
    (folder / "staged.jsonl").unlink()
    run(folder)
    (line,) = (line for line in lines(folder, "restaged.jsonl") if line["id"] == restaged)
    assert not line["how"]
    assert line["tried"]
    assert lines(folder, "scenes.jsonl") == rows


def test_a_verdict_on_an_episode_that_is_another_now_is_given_again(folder):
    rows = lines(folder, "episodes.jsonl")
    stop = rows[0]["actions"]["stop"]
    stop |= {"safe": not stop["safe"], "marginal": False}
    rewrite(folder, "episodes.jsonl", rows)
    assert run(folder) == 0
    verdicts = {line["id"]: line for line in lines(folder, "verdicts.jsonl")}
    assert verdicts[f"{rows[0]['id']}@eye"]["action_is_safe"] is stop["safe"]


def test_what_follows_from_a_text_that_was_changed_is_made_again(folder):
    before = {name: lines(folder, name) for name in ("claims.jsonl", "staged.jsonl")}
    metrics = json.loads((folder / "metrics.json").read_text())
    rows = lines(folder, "scenarios.jsonl")
    rows[0]["text"] += " It is night."
    rewrite(folder, "scenarios.jsonl", rows)
    run(folder)
    assert lines(folder, "scenarios.jsonl") == rows
    for name, old in before.items():
        new = lines(folder, name)
        assert new[0]["made_from"] != old[0]["made_from"]
        assert new[1:] == old[1:]
    assert json.loads((folder / "metrics.json").read_text())["made_from"] != metrics["made_from"]


def test_the_texts_are_measured_again_against_ordinary_texts_that_were_changed(small, tmp_path):
    folder, baseline = shutil.copytree(small, tmp_path / "study"), tmp_path / "own.txt"
    texts = ORDINARY.read_text().splitlines()
    info = json.loads((folder / "study.json").read_text())
    info["config"]["baseline"] = str(baseline)
    (folder / "study.json").write_text(json.dumps(info))
    measured = []
    for count in (len(texts), len(texts) // 2):
        baseline.write_text("\n".join(texts[:count]))
        study = run_study(folder, SMALL.model_copy(update={"baseline": str(baseline)}))
        measured.append(study.metrics["sets"]["simulatable"]["oodness"])
    assert measured[0] != measured[1]


def test_a_branch_that_is_kept_by_hand_gets_texts_and_the_others_stay(folder):
    rows = lines(folder, "pruned.jsonl")
    leaves = {line["leaf"] for line in lines(folder, "scenarios.jsonl")}
    gone = next(row for row in rows if row["id"] in leaves)
    gone["keep"] = False
    rewrite(folder, "pruned.jsonl", rows)
    run(folder)
    assert gone["id"] not in {line["leaf"] for line in lines(folder, "scenarios.jsonl")}
    study = Study.open(folder)
    assert gone["id"] not in study.tree("simulatable").by_id
    assert {scene.id for scene in study.scenes} == {scenario.id for scenario in study.scenarios}
    assert {scene_of(episode.id) for episode in study.episodes} == {s.id for s in study.scenes}


def test_a_scene_that_was_changed_by_hand_and_lost_its_text_is_named(folder):
    rows = lines(folder, "scenes.jsonl")
    rows[0]["horizon_s"] = 3.0
    rewrite(folder, "scenes.jsonl", rows)
    texts = lines(folder, "scenarios.jsonl")
    decisions = lines(folder, "pruned.jsonl")
    next(decision for decision in decisions if decision["id"] == texts[0]["leaf"])["keep"] = False
    rewrite(folder, "pruned.jsonl", decisions)
    with pytest.raises(DataError, match=rows[0]["id"]):
        run(folder)
    assert lines(folder, "scenes.jsonl") == rows


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        (lambda rows: rows.append({**rows[0], "id": "own-001"}), DataError, "own-001"),
        (lambda rows: rows.append({**rows[0], "horizon_s": 3.0}), DataError, "two scenes"),
        (
            lambda rows: rows[0].update(decision={"kind": "ttc", "value": 2.0}),
            DataError,
            "line 1.*decision.actor: name the actor",
        ),
    ],
)
def test_a_scene_that_cannot_be_taken_is_named(folder, change, error, words):
    rows = lines(folder, "scenes.jsonl")
    change(rows)
    rewrite(folder, "scenes.jsonl", rows)
    before = content(folder)
    with pytest.raises(error, match=f"(?s){words}"):
        run(folder)
    assert content(folder) == before
    assert Study(folder).info["status"] != "running"


@pytest.mark.parametrize("number", ["777", "002", "001", ""])
def test_a_text_that_was_added_by_hand_is_named(folder, number):
    rows = lines(folder, "scenarios.jsonl")
    name = f"{rows[-1]['leaf']}-{number or 777}"
    added = {**rows[-1], "id": name, "text": "A goat stands on the road."}
    if not number:
        del added["leaf"]
    rewrite(folder, "scenarios.jsonl", [*rows, added])
    before = content(folder)
    with pytest.raises(DataError, match=rf"line {len(rows) + 1}.*\n.*{name}' is one too many"):
        run(folder)
    assert content(folder) == before
    assert Study(folder).info["status"] != "running"


def test_a_round_that_does_not_fit_its_tree_is_named_before_anything_is_written(folder):
    rows = lines(folder, "redteam.jsonl")
    edits = next(row["edits"] for row in rows if any(edit["parent"] for edit in row["edits"]))
    edits[0]["parent"] = "elsewhere"
    rewrite(folder, "redteam.jsonl", rows)
    before = content(folder)
    with pytest.raises(DataError, match=r"(?s)redteam\.jsonl:.*'elsewhere' does not exist"):
        run(folder)
    assert content(folder) == before


@pytest.mark.parametrize(
    "outputs", [Outputs(traces=True), Outputs(annotations=True), Outputs(video="bird")]
)
def test_outputs_that_episodes_were_not_run_with_are_refused(finished, outputs):
    before = content(finished)
    with pytest.raises(UsageError, match=r"run without (traces|annotations|videos)"):
        run(finished, outputs=outputs)
    assert content(finished) == before


def test_outputs_that_episodes_were_run_with_may_be_asked_for_again(small, tmp_path):
    shutil.copytree(small, tmp_path, dirs_exist_ok=True)
    (tmp_path / "episodes.jsonl").unlink()
    for _ in range(2):
        run_study(tmp_path, SMALL, outputs=Outputs(annotations=True))
    assert list(tmp_path.glob("frames/*/last.json"))


@pytest.mark.parametrize("status", ["running", "stopped", "success", "incomplete"])
def test_only_an_unfinished_study_needs_the_author_that_began_it(small, tmp_path, status):
    folder = shutil.copytree(small, tmp_path / "out")
    info = json.loads((folder / "study.json").read_text())
    info["status"] = status
    info["authors"]["llm"] += ", extended by mine.toml (digest 0)"
    (folder / "study.json").write_text(json.dumps(info))
    if status in ("success", "incomplete"):
        assert run_study(folder, SMALL).info["authors"]["llm"] == info["authors"]["llm"]
        return
    with pytest.raises(StudyMismatch, match=r"llm: the study has .*mine\.toml"):
        run_study(folder, SMALL)
    assert json.loads((folder / "study.json").read_text()) == info


@pytest.mark.parametrize("status", ["stopped", "success"])
def test_a_study_goes_on_with_its_models_at_another_address(small, tmp_path, status):
    folder = shutil.copytree(small, tmp_path / "out")
    info = json.loads((folder / "study.json").read_text())
    info["status"], info["config"]["api_base"] = status, "http://localhost:1/v1"
    (folder / "study.json").write_text(json.dumps(info))
    moved = SMALL.model_copy(update={"api_base": "http://localhost:2/v1"})
    assert run_study(folder, moved).config == moved

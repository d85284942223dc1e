"""Published data sets: what is in them, what is not, and that other readers take them."""

import ast
import base64
import csv
import hashlib
import io
import json
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from shutil import copytree, rmtree
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Study, evaluate
from oodscen._io.lock import locked
from oodscen.data._scene import Hazard, Scene
from oodscen.errors import DataError, FolderTaken, InUse, StudyError, UsageError
from oodscen.judging import leaderboard
from oodscen.publish import score_answers
from oodscen.publish._card import _cell, _without_folders, card
from oodscen.publish._parquet import DRIVES, QUESTIONS
from oodscen.publish._question_rows import published_drives, question_rows
from oodscen.publish._replacing import SUMS, replacing
from oodscen.publish._splits import splits
from oodscen.publish._vlmevalkit import COLUMNS, LETTERS
from oodscen.study._asked import asked_drives
from oodscen.testing import ScriptedLLM
from tests.report.conftest import build_study

parquet = pytest.importorskip("pyarrow.parquet")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return build_study(tmp_path_factory.mktemp("publish") / "study", per_path=3, with_twins=True)


@pytest.fixture(scope="module")
def data(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return study.publish(tmp_path_factory.mktemp("published") / "data").folder


def rows(data: Path, table: str) -> list[dict[str, Any]]:
    found = []
    for split in ("validation", "test"):
        part = parquet.read_table(data / "data" / table / f"{split}.parquet").to_pylist()
        found += [{**row, "split": split} for row in part]
    return found


def test_every_drive_has_three_questions_with_its_own_pictures(study, data):
    asked = {asked_drive.episode.scene_id: asked_drive for asked_drive in asked_drives(study)}
    drives = rows(data, "drives")
    assert {row["item"] for row in drives} == set(asked)
    held = {row["drive"]: row["frame_sha256"] for row in drives}
    found = defaultdict(list)
    for row in rows(data, "questions"):
        sums = [hashlib.sha256(image["bytes"]).hexdigest() for image in row["images"]]
        assert sums == held[row["drive"]]
        found[row["drive"]].append(row["purpose"])
    assert all(
        sorted(purposes) == ["choose-action", "choose-aspect", "name-aspect"]
        for purposes in found.values()
    )


def test_every_drive_has_the_scene_that_was_driven(data):
    for row in rows(data, "drives"):
        scene = Scene.parse(row["scene"])
        assert scene.id == row["item"]
        assert scene.map == row["map"]
        assert row["kind"] == "rare" or scene.hazard == Hazard()


def test_no_kind_and_no_pair_is_in_two_splits(data):
    splits_of = defaultdict(set)
    for row in rows(data, "questions"):
        splits_of[row["path"][-1]].add(row["split"])
        splits_of[row["pair"]].add(row["split"])
    assert all(len(found) == 1 for found in splits_of.values())
    assert set().union(*splits_of.values()) == {"validation", "test"}


@settings(max_examples=25, deadline=None)
@given(
    st.dictionaries(st.from_regex(r"[a-z]{1,6}", fullmatch=True), st.text(min_size=1, max_size=12)),
    st.floats(0.0, 0.9),
    st.integers(0, 9),
)
def test_splits_are_whole_kinds_and_the_test_split_is_never_empty(labels, share, seed):
    found = splits(labels, share=share, seed=seed)
    assert found.keys() == labels.keys()
    assert not labels or "test" in found.values()
    assert share or "validation" not in found.values()
    assert found == splits(labels, share=share, seed=seed)


def test_names_tell_nothing(data, study):
    names = [path.relative_to(data).as_posix() for path in data.rglob("*")]
    for row in rows(data, "questions"):
        names += [row["id"], row["drive"], row["pair"], *(one["path"] for one in row["images"])]
    leaves = {scenario.leaf for scenario in study.scenarios}
    assert not any(leaf in name for leaf in leaves for name in names)


def test_the_sums_are_those_of_the_files_and_the_card_needs_no_other(data):
    lines = (data / SUMS).read_text().splitlines()
    told = dict(reversed(line.split("  ", 1)) for line in lines)
    there = {
        path.relative_to(data).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in data.rglob("*")
        if path.is_file() and path.name != SUMS
    }
    assert told == there
    text = (data / "README.md").read_text()
    assert all(f"`{column}`" in text for column in (*QUESTIONS, "safe"))
    assert "{{" not in text
    assert str(data) not in text
    assert "api_base" not in text
    head = text.split("---\n")[1]
    assert "license: cc-by-4.0" in head
    assert "data/questions/test.parquet" in head


def test_it_is_the_same_again_and_other_files_are_left_alone(study, data, tmp_path):
    again = study.publish(tmp_path / "again").folder
    assert (again / SUMS).read_bytes() == (data / SUMS).read_bytes()
    study.publish(again, forms=())
    assert not (again / "vlmevalkit" / "oodscen.tsv").exists()
    (again / "mine.txt").write_text("mine")
    with pytest.raises(FolderTaken):
        study.publish(again)
    with pytest.raises(FolderTaken):
        study.publish(study.folder)


def fill(folder: Path, names: Iterable[str], content: str) -> None:
    """Write files and their sums."""
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)
    digest = hashlib.sha256(content.encode()).hexdigest()
    (folder / SUMS).write_text("".join(f"{digest}  {name}\n" for name in names))


def content(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else b""
        for path in folder.rglob("*")
    }


def stopping(count: int) -> Callable[[Path, Path], Path]:
    """Return `Path.replace`, which is interrupted before it moves one more than so many files."""
    moves, move = iter(range(count)), Path.replace

    def replace(path: Path, target: Path) -> Path:
        if next(moves, None) is None:
            raise KeyboardInterrupt
        return move(path, target)

    return replace


NAMES = st.sets(
    st.sampled_from(
        [
            "data/questions/test.parquet",
            "data/drives/test.parquet",
            "drivelm/test.json",
            "drivelm/images/a-0.jpg",
            "vlmevalkit/oodscen.tsv",
        ]
    )
).map(lambda names: names | {"README.md"})


@given(NAMES, NAMES, st.integers(0, 5))
@settings(deadline=None)
def test_a_folder_holds_the_earlier_or_the_new_data_set(earlier, new, moved):
    with TemporaryDirectory() as name:
        folder = Path(name) / "set"
        with replacing(folder) as part:
            fill(part, earlier, "earlier")
        before = content(folder)
        with suppress(ZeroDivisionError), replacing(folder) as part:
            fill(part, new, "new")
            _ = 1 // 0
        assert content(folder) == before
        with pytest.MonkeyPatch.context() as patch, suppress(KeyboardInterrupt):
            patch.setattr(Path, "replace", stopping(moved))
            with replacing(folder) as part:
                fill(part, new, "new")
        assert (folder / SUMS).exists() == (moved > len(new))
        with replacing(folder) as part:
            fill(part, new, "new")
        fill(whole := Path(name) / "whole", new, "new")
        assert content(folder) == content(whole)


@given(
    names=st.dictionaries(st.sampled_from(["README.md", "a.tar.gz", "src/b.c"]), st.booleans()),
    rest=st.lists(st.sampled_from(["", "notes", f"{'0' * 64}  ../out", f"{'0' * 64}  /etc"])),
)
@settings(deadline=None)
def test_sums_of_somebody_else_are_no_licence_to_remove(names, rest):
    with TemporaryDirectory() as name:
        folder = Path(name) / "release"
        fill(folder, names, "theirs")
        with (folder / SUMS).open("a") as file:
            file.write("".join(f"{line}\n" for line in rest))
        before = content(folder)
        if set(names) == {"README.md"} and not rest:
            return
        with pytest.raises(FolderTaken) as caught, replacing(folder):
            pass
        assert content(folder) == before
        if others := names.keys() - {"README.md"}:
            assert others & set(caught.value.names[:2]), "what is not ours is named first"


@pytest.mark.parametrize("name", ["lmms_eval/oodscen/utils.py", "data/questions/test.parquet"])
def test_a_file_that_was_changed_by_hand_is_kept(study, tmp_path, name):
    folder = study.publish(tmp_path / "set", forms=("lmms-eval",)).folder
    with (folder / name).open("ab") as file:
        file.write(b"# ours")
    before = content(folder)
    with pytest.raises(UsageError, match="changed since it was published"):
        study.publish(folder)
    assert content(folder) == before


def test_a_data_set_that_cannot_be_written_leaves_nothing(study, data, tmp_path, monkeypatch):
    before = {path: path.read_bytes() for path in data.rglob("*") if path.is_file()}

    def full(*unused: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("oodscen.publish._publishing.write_tsv", full)
    for folder in (data, tmp_path / "new" / "set"):
        with pytest.raises(StudyError, match="No space left"):
            study.publish(folder)
    assert {path: path.read_bytes() for path in data.rglob("*") if path.is_file()} == before
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_another_writes_is_left_alone(study, data):
    before = content(data)
    with ThreadPoolExecutor(1) as other, locked(data, "data set"), pytest.raises(InUse):
        other.submit(study.publish, data).result()
    assert content(data) == before


@pytest.mark.parametrize("place", ["README.md", "data"])
def test_no_link_in_the_folder_is_followed(study, tmp_path, place):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "kept").write_text("kept")
    folder = study.publish(tmp_path / "set", forms=()).folder
    if place == "data":
        rmtree(folder / place)
        (folder / place).symlink_to(tmp_path / "mine")
    else:
        (folder / place).unlink()
        (folder / place).symlink_to(tmp_path / "mine" / "kept")
    with pytest.raises(UsageError, match="nothing is overwritten"):
        study.publish(folder, forms=())
    assert content(tmp_path / "mine") == {"kept": b"kept"}


def test_a_card_that_was_changed_by_hand_is_kept(study, tmp_path):
    folder = study.publish(tmp_path / "set", forms=()).folder
    first, readme = content(folder), folder / "README.md"
    readme.write_text(f"{readme.read_text()}\nOur note.\n")
    before = content(folder)
    with pytest.raises(UsageError, match=r"README\.md was changed since it was published"):
        study.publish(folder, forms=())
    assert content(folder) == before
    readme.unlink()
    study.publish(folder, forms=())
    assert content(folder) == first


@pytest.mark.parametrize(
    "text", ['{"llm":"builtin:/home/ann/h.toml","x":"a/b"}', "replay:../c/h.toml"]
)
def test_the_card_names_files_of_models_without_their_folders(text):
    told = _without_folders(text)
    assert ":h.toml" in told
    assert "ann" not in told
    assert ".." not in told
    assert ('"x":"a/b"' in told) == ('"x"' in text)


@given(st.text())
def test_a_cell_of_the_card_is_one_line_without_markup(text):
    said = _cell(text)
    assert len(said.splitlines()) <= 1
    assert not re.search(r"[<>]|(?<!\\)(?:\\\\)*[`|\[\]]", said)


def test_the_card_tells_how_else_models_were_asked(study, tmp_path):
    out = copytree(study.folder, tmp_path / "study")
    record = json.loads((out / "study.json").read_text())
    record["config"]["chain"] = True
    (out / "study.json").write_text(json.dumps(record))
    verdicts = [
        verdict.model_copy(update={"protocol": "paper", "model": "m", "kind": "model"})
        for verdict in study.verdicts
        if verdict.model == study.verdicts[0].model
    ]
    drives = published_drives(asked_drives(study), {})
    board = leaderboard(verdicts, study.episodes, study.scenarios)
    board = board.model_copy(update={"judge": "wise@0123"})
    text = card(Study.open(out), board, drives, "cc0-1.0", {})
    assert "| m (the paper's questions) |" in text
    assert "`--chain`" in text
    assert "The paper's questions are others" in text
    assert "scored by the judge wise." in text
    plain = card(study, study.leaderboard(), drives, "cc0-1.0", {})
    assert "`--chain`" not in plain
    assert "by the judge" not in plain
    assert "paper's questions" not in plain


@pytest.mark.parametrize(
    "licence", ["", "mit\n---\ninjected: true", "mit other", "no", "Yes", "null", "1.0", "2"]
)
def test_a_licence_is_one_identifier(study, tmp_path, licence):
    with pytest.raises(UsageError, match="licence"):
        study.publish(tmp_path / "set", licence=licence)
    assert not (tmp_path / "set").exists()


def test_a_licence_that_looks_like_a_key_is_refused(study, tmp_path):
    with pytest.raises(UsageError, match="looks like a key") as refused:
        study.publish(tmp_path / "set", licence="sk-proj-AbCdEfGhIjKlMnOpQrSt")
    assert "AbCdEf" not in str(refused.value)
    assert not (tmp_path / "set").exists()


def test_right_answers_are_right_and_are_scored_like_a_study(study, data):
    shares = score_answers([(row, row["answer"]) for row in rows(data, "questions")])
    oracle = next(row for row in study_board(study).standings if row.model == "right")
    assert shares["safe"] == oracle.control.safe.value
    assert shares["act-both"] == oracle.paired.act.value
    assert shares["notice-both"] == oracle.paired.notice.value == 1.0
    assert shares["name"] == oracle.identification.open.value == 1.0
    assert shares["pick"] == oracle.identification.closed.value == 1.0
    assert shares["alarms"] == 0.0


@pytest.fixture(scope="module")
def other(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return another study's data set, of scenes with the same ids; its pictures have recorded hashes."""
    made = build_study(tmp_path_factory.mktemp("other") / "study", per_path=3, with_twins=True)
    episodes = list(made.store.lines("episodes.jsonl"))
    for episode in episodes:
        episode["file_sha256"] = {
            name: made.store.digest(name) for name in episode["frames"].values()
        }
    made.store.write_lines("episodes.jsonl", episodes)
    return made.publish(tmp_path_factory.mktemp("others") / "data", forms=()).folder


def acted(data: Path, action: str, *kinds: str) -> list[tuple[dict[str, Any], str]]:
    """Return one answer to all questions about drives of some kinds: what to do."""
    return [
        (row, json.dumps({"action": action}))
        for row in rows(data, "questions")
        if row["purpose"] == "choose-action" and row["kind"] in kinds
    ]


def test_answers_about_two_data_sets_all_count(data, other):
    every = ("rare", "twin", "demand")
    here, there = acted(data, "stop", *every), acted(other, "keep_speed", *every)
    apart = [score_answers(one) for one in (here, there)]
    assert apart[0] != apart[1]
    together = score_answers(here + there)
    assert together == score_answers(there + here)
    for name, value in together.items():
        assert value == pytest.approx((apart[0][name] + apart[1][name]) / 2)


def test_pairs_are_within_one_data_set(data, other):
    found = score_answers(acted(data, "stop", "rare") + acted(other, "stop", "twin", "demand"))
    assert "safe" in found
    assert "act-both" not in found


def test_a_question_answered_twice_is_refused(data):
    answers = acted(data, "stop", "rare", "twin")
    item = json.loads(answers[0][0]["key"])["item"]
    with pytest.raises(UsageError, match=f"choose-action about {item} is answered twice; give one"):
        score_answers([*answers, (answers[0][0], '{"action": "keep_speed"}')])


@pytest.mark.parametrize("text", [None, b'{"action": "stop"}', {"action": "stop"}])
def test_an_answer_is_a_text(data, text):
    with pytest.raises(UsageError, match="must be a text, not "):
        score_answers([(acted(data, "stop", "rare")[0][0], text)])


def test_a_row_without_its_pair_is_refused(data):
    row, text = acted(data, "stop", "rare")[0]
    with pytest.raises(DataError, match="a key, a pair and a purpose"):
        score_answers([({name: row[name] for name in ("purpose", "key")}, text)])


@pytest.mark.parametrize("wrong", [{"purpose": []}, {"purpose": {}}, {"purpose": 1}, {"pair": 5}])
def test_a_row_of_other_types_is_refused(data, wrong):
    row, text = acted(data, "stop", "rare")[0]
    with pytest.raises(DataError, match=next(iter(wrong))):
        score_answers([({**row, **wrong}, text)])


def test_a_question_s_stem_has_neither_its_options_nor_how_to_answer(study):
    for drive in published_drives(asked_drives(study), {}):
        for row in question_rows(drive):
            assert row.stem.endswith(("?", "right.", "least:", "rare."))
            assert "step by step" not in row.stem
            assert not any(f"{option}\n" in f"{row.stem}\n" for option in row.options)


def study_board(study: Study):
    """Return the board of a model that gives the published answers to a study's own questions."""
    verdicts = []
    for drive in published_drives(asked_drives(study), {}):
        said = {row.purpose: row.answer or "none" for row in question_rows(drive)}
        model = ScriptedLLM({purpose: [text] * 2 for purpose, text in said.items()}, name="right")
        one = drive.asked
        verdicts.append(
            evaluate(
                one.episode,
                one.frames,
                model,
                path=one.key.path,
                leaf=one.key.leaf,
                options=one.options,
                visible=one.key.visible,
            )
        )
    return leaderboard(verdicts, study.episodes, study.scenarios)


@pytest.fixture
def long_fields() -> Iterator[None]:
    """Let fields of CSV files hold pictures, as VLMEvalKit does."""
    before = csv.field_size_limit(1 << 30)
    yield
    csv.field_size_limit(before)


@pytest.mark.usefixtures("long_fields")
def test_the_tsv_has_the_columns_of_vlmevalkit(data):
    with (data / "vlmevalkit" / "oodscen.tsv").open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file, delimiter="\t"))
    assert list(found[0]) == list(COLUMNS)
    images = {row["index"]: row["image"] for row in found}
    assert list(images) == [str(number) for number in range(len(found))]
    published = {(row["drive"], row["tasks"][0]): row for row in rows(data, "questions")}
    for row in found:
        held = row["image"] if len(row["image"]) > 64 else images[row["image"]]
        pictures = [base64.b64decode(one) for one in ast.literal_eval(held)]
        source = published[row["drive"], row["category"]]
        assert pictures == [image["bytes"] for image in source["images"]]
        assert len(ast.literal_eval(row["image_path"])) == len(pictures)
        texts = [row[letter] for letter in LETTERS if row[letter]]
        assert texts == source["options"]
        assert row["answer"] in row["accepted"]
        assert [LETTERS.index(letter) for letter in row["accepted"]] == source["accepted"]
        assert "JSON" not in row["question"]
        assert "step by step" not in row["question"]


@pytest.mark.usefixtures("long_fields")
def test_vlmevalkit_saves_the_pictures_without_loss(data, tmp_path):
    """It decodes each and saves it anew under its name, of which the ending is the format."""
    pictures = pytest.importorskip("PIL.Image")
    with (data / "vlmevalkit" / "oodscen.tsv").open(encoding="utf-8", newline="") as file:
        row = next(csv.DictReader(file, delimiter="\t"))
    names, held = ast.literal_eval(row["image_path"]), ast.literal_eval(row["image"])
    for name, content in zip(names, held, strict=True):
        published = pictures.open(io.BytesIO(base64.b64decode(content)))
        published.save(tmp_path / name)
        saved = pictures.open(tmp_path / name)
        assert saved.size == published.size
        assert saved.tobytes() == published.tobytes()


def test_drivelm_has_a_picture_for_every_frame_and_a_right_option_for_every_question(data):
    for split in ("validation", "test"):
        scenes = json.loads((data / "drivelm" / f"{split}.json").read_text())
        assert scenes
        for scene in scenes.values():
            frames = list(scene["key_frames"].values())
            for frame in frames:
                assert (data / "drivelm" / frame["image_paths"]["CAM_FRONT"]).is_file()
            asked = [one for part in frames[-1]["QA"].values() for one in part]
            assert asked
            assert all(one["A"] in one["Q"] for one in asked)
            assert not any(one for frame in frames[:-1] for one in frame["QA"].values() if one)


def test_lmms_eval_finds_what_its_files_name(data):
    folder = data / "lmms_eval" / "oodscen"
    functions = set()
    for path in folder.glob("*.yaml"):
        text = path.read_text()
        functions |= {line.split("utils.")[1] for line in text.splitlines() if "!function" in line}
    utils: dict[str, Any] = {}
    exec((folder / "utils.py").read_text(), utils)
    assert functions <= utils.keys()
    common = (folder / "_common.yaml").read_text()
    for line in common.splitlines():
        if ".parquet" in line:
            assert (folder / line.split(": ")[1]).resolve().is_file()
    assert "generation_kwargs:\n  until: []\n" in common
    assert "metadata:\n  version: 1.0\n" in common
    row = next(row for row in rows(data, "questions") if row["purpose"] == "choose-action")
    found = utils["process_results"](row, [row["answer"]])
    assert utils["safe"]([found["safe"]] * 1) in (0.0, 1.0) or row["kind"] != "rare"


def test_the_hub_library_loads_it_offline(data, tmp_path):
    pytest.importorskip("datasets")
    code = (
        "import sys; from datasets import load_dataset\n"
        "found = load_dataset(sys.argv[1]); one = found['test'][0]\n"
        "print(sorted(found), one['images'][0].size, load_dataset(sys.argv[1], 'drives')['test'][0]['kind'])"
    )
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code, str(data)],
        capture_output=True,
        text=True,
        check=False,
        env={"HF_HUB_OFFLINE": "1", "HF_HOME": str(tmp_path), "PATH": "/usr/bin:/bin"},
    )
    assert done.returncode == 0, done.stderr[-2_000:]
    assert done.stdout.startswith("['test', 'validation'] (")


def test_the_columns_of_drives_are_documented(data):
    assert set(rows(data, "drives")[0]) == {*DRIVES, "split"}

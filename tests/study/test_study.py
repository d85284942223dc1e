"""Reading a study: every table in one call, clear errors where something is missing."""

import os
import pickle
from contextlib import suppress

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen import Scenario, Study
from oodscen.errors import DataError, OodscenError, StudyError, UnknownComponent, UsageError
from oodscen.stages._prune.side_by_side import CatalogueComparison
from oodscen.stages._redteam.red_teamer import Round
from oodscen.study._store import Store


@pytest.fixture
def study(tmp_path):
    store = Store(tmp_path)
    store.write("study.json", '{"status":"running","config":{"seed":3}}')
    store.write_lines(
        "scenarios.jsonl",
        [
            Scenario(id="a-001", text="A tree lies across the road.", leaf="a", path=("x", "a")),
            {"id": "b", "leaf": "b", "path": ["x", "b"], "status": "failed", "error": "no answer"},
        ],
    )
    store.write_lines(
        "redteam.jsonl", [Round(round=1, text="t", nodes=4), Round(round=2, status="failed")]
    )
    return Study.open(tmp_path)


def test_rows_come_as_their_types_and_failures_apart(study):
    assert [scenario.id for scenario in study.scenarios] == ["a-001"]
    assert [row["error"] for row in study.failures("scenarios")] == ["no answer"]
    assert [item.status for item in study.rounds] == ["ok", "failed"]
    assert study.config.seed == 3
    assert study.metrics == {}


def test_tables_come_as_data_frame_and_as_arrow(study):
    assert list(study.to_pandas("redteam")["round"]) == [1, 2]
    assert study.to_arrow("redteam").column("nodes").to_pylist() == [4, 0]


LINES = st.lists(
    st.fixed_dictionaries(
        {"id": st.text("ab", max_size=2)},
        optional={"value": st.integers(-9, 9), "demand": st.just({"kind": "x"})},
    ),
    min_size=1,
    max_size=5,
)


@given(LINES)
def test_an_arrow_table_has_the_fields_of_all_lines(tmp_path_factory, lines):
    folder = tmp_path_factory.mktemp("arrow")
    Store(folder).write_lines("calls.jsonl", lines)
    found = Study(folder).to_arrow("calls").to_pylist()
    assert [{name: one for name, one in row.items() if one is not None} for row in found] == lines


def test_a_folder_without_a_study_says_so(tmp_path):
    with pytest.raises(StudyError, match="no study"):
        Study.open(tmp_path / "nowhere")


def test_a_name_that_no_file_can_have_is_no_study():
    with pytest.raises(StudyError, match="no study"):
        Study.open("x" * 5_000)


class Place(os.PathLike):
    """A path of another library."""

    def __init__(self, folder):
        self.folder = folder

    def __fspath__(self):
        return str(self.folder)


def test_a_path_of_another_library_opens_a_study(study):
    assert Study.open(Place(study.folder)).folder == study.folder


def test_malformed_metrics_are_named_with_their_folder(study):
    Store(study.folder).write("metrics.json", '{"paths":3}')
    with pytest.raises(DataError) as caught:
        _ = study.exposure
    assert caught.value.source == str(study.folder / "metrics.json")


def test_unknown_names_have_close_matches(study):
    with pytest.raises(UnknownComponent) as caught:
        study.table("scenario")
    assert caught.value.matches[0] == "scenarios"
    with pytest.raises(UnknownComponent):
        study.tree("simulated")
    with pytest.raises(UsageError):
        study.tree(None)


@pytest.mark.parametrize(
    "call",
    [
        lambda study: study.texts("10"),
        lambda study: study.trace(3),
        lambda study: study.trace(None),
    ],
)
def test_sizes_are_numbers_and_scenes_have_names(study, call):
    with pytest.raises(UsageError, match="must be"):
        call(study)


@example(at=434, byte=69)  # The type of a column becomes an integer of more bits than there are.
@given(at=st.integers(0, 500), byte=st.integers(0, 255))
def test_a_trace_with_another_byte_is_a_table_or_a_study_error(tmp_path_factory, at, byte):
    pyarrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    study = Study(tmp_path_factory.mktemp("traced"))
    path = study.folder / "traces" / "a.parquet"
    path.parent.mkdir()
    parquet.write_table(pyarrow.table({"speed": [1, 2]}), path)
    content = bytearray(path.read_bytes())
    content[at] = byte
    path.write_bytes(content)
    with suppress(StudyError):
        study.trace("a")


def test_a_trace_that_is_missing_is_a_study_error(study):
    with pytest.raises(StudyError, match="no such episode, or it was run without traces"):
        study.trace("b")


def test_a_malformed_line_is_named(study, tmp_path):
    Store(tmp_path).append("scenarios.jsonl", {"id": "c-001", "text": ""})
    with pytest.raises(DataError) as caught:
        _ = study.scenarios
    assert caught.value.source.endswith("line 3")
    assert [issue.path for issue in caught.value.issues] == ["text"]


@pytest.mark.parametrize(
    "more",
    [
        '"versions":[]',
        '"counts":1',
        '"failures":{"scenes":Infinity}',
        '"usage":NaN',
        '"status":"done"',
        '"config":[]',
        '"authors":{"llm":3}',
    ],
)
def test_a_wrong_record_is_one_typed_error(tmp_path, more):
    (tmp_path / "study.json").write_text('{"schema_version":1,"config":{},' + more + "}")
    with pytest.raises(OodscenError):
        _ = Study.open(tmp_path).info


@pytest.mark.parametrize("content", ["", "{", '{"config": {"se', "[]", "{}", "null"])
def test_a_record_that_is_empty_or_cut_is_no_study(content, study):
    (study.folder / "study.json").write_text(content)
    with pytest.raises(DataError, match=r"study\.json"):
        Study.open(study.folder)


def test_tables_of_mixed_types_are_a_study_error(tmp_path):
    Store(tmp_path).write_lines("calls.jsonl", [{"a": 1}, {"a": "x"}, {"a": {"b": []}}])
    with pytest.raises(StudyError, match=r"calls.jsonl"):
        Study(tmp_path).to_arrow("calls")
    assert len(Study(tmp_path).to_pandas("calls")) == 3


@pytest.mark.parametrize("name", ["verdicts.jsonl", "calls.jsonl", "frames"])
def test_a_study_with_a_pipe_in_it_is_refused_by_every_reader(tmp_path, name):
    Store(tmp_path).write("study.json", "{}")
    os.mkfifo(tmp_path / name)
    with pytest.raises(DataError, match=f"(?s){name}:.*is not a "):
        Study.open(tmp_path)


@pytest.mark.parametrize("name", ["frames", "frames/some-scene"])
def test_frames_that_lie_elsewhere_are_found_before_anything_is_written(study, tmp_path, name):
    (study.folder / name).parent.mkdir(exist_ok=True)
    (study.folder / name).symlink_to(tmp_path.parent)
    with pytest.raises(DataError, match="leads outside"):
        study.check()


def test_a_drive_that_is_none_is_found_before_anything_is_written(study):
    study.store.write_lines("drives.jsonl", [{"id": "a", "driver": 1}])
    with pytest.raises(DataError, match="drives"):
        study.check()


@pytest.mark.parametrize("name", ["metrics.json", "catalogues.json"])
@pytest.mark.parametrize("content", [b"null", b"[]", b'{"lines":1}', b"\xef\xbb\xbf{}", b"\xff"])
def test_a_broken_file_of_one_value_is_found_before_anything_is_written(study, name, content):
    study.store.path(name).write_bytes(content)
    before = sorted(path.name for path in study.folder.iterdir())
    with pytest.raises(DataError, match=name):
        study.check()
    assert sorted(path.name for path in study.folder.iterdir()) == before


def test_a_comparison_has_one_decision_for_each_catalogue():
    side = {"keep": False, "match": None, "reason": ""}
    line = {"id": "n1", "path": ["a", "b"], "sides": [side]}
    with pytest.raises(DataError, match="one entry for each catalogue"):
        CatalogueComparison.parse({"catalogues": [], "tallies": [], "lines": [line]})


def test_a_pickled_study_is_its_folder(study, monkeypatch, tmp_path):
    monkeypatch.chdir(study.folder.parent)
    data = pickle.dumps(Study.open(study.folder.name))
    monkeypatch.chdir(tmp_path)
    assert pickle.loads(data).scenarios == study.scenarios

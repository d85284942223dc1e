import json
from pathlib import Path

import numpy as np
import pytest

from oodscen import Metrics
from oodscen.baselines._embedded import open_embeddings, write_embeddings
from oodscen.errors import DataError, OodscenError, UsageError
from oodscen.testing._encoder import HashEncoder

TEXTS = [f"car {i} waits at light {i * 7}" for i in range(50)]
ENCODER = HashEncoder(16)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "ordinary.npy"
    assert write_embeddings(path, ENCODER, iter(TEXTS)) == 50
    return path


def arrow(path, rows, name, field="vector"):
    pa = pytest.importorskip("pyarrow")
    column = pa.FixedSizeListArray.from_arrays(pa.array(rows.ravel()), rows.shape[1])
    schema = pa.schema([(field, column.type)], metadata={"encoder": name} if name else {})
    with pa.ipc.new_file(str(path), schema) as sink:
        for first in range(0, len(rows), 20):
            part = column.slice(first, 20)
            sink.write_batch(pa.record_batch([part], schema=schema))
    return path


def test_it_scores_as_the_texts_do(file, tmp_path):
    asked = ["a deer jumps", "car 3 waits at light 21"]
    expected = Metrics(ENCODER, TEXTS).oodness(asked)
    other = arrow(tmp_path / "ordinary.arrow", np.load(file), ENCODER.name)
    for path in (file, other):
        metrics = Metrics(ENCODER, open_embeddings(path, ENCODER))
        found = metrics.oodness(asked)
        np.testing.assert_allclose(found.per_text, expected.per_text, atol=1e-6)
        assert found.N == 50
        report = metrics.report(asked)
        assert report.calibration is None
        assert report.baseline == path.name
        with pytest.raises(UsageError):
            metrics.oodness(asked, "events")


def test_rows_are_scaled_and_zeros_stay(tmp_path):
    rows = np.arange(12, dtype=np.float32).reshape(3, 4)
    rows[1] = 0.0
    rows[2] = 3e38  # Its length is no float32.
    np.save(tmp_path / "b.npy", rows)
    (tmp_path / "b.npy.json").write_text(json.dumps({"encoder": "hash-4"}))
    found = open_embeddings(tmp_path / "b.npy", HashEncoder(4))[0:3]
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), [1, 0, 1], atol=1e-6)


@pytest.mark.parametrize("path", ["", ".", "/", "vectors.arrow"])
def test_only_a_npy_file_is_written(path):
    with pytest.raises(UsageError, match=r"written as \.npy"):
        Metrics(ENCODER, TEXTS).write_embeddings(path, ["a car"])


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file" / "x.npy", tmp_path / ("a" * 300 + ".npy"), "a\0b.npy"):
        with pytest.raises(OodscenError, match="cannot write"):
            Metrics(ENCODER, TEXTS).write_embeddings(path, ["a car"])


@pytest.mark.parametrize(
    ("texts", "fault"),
    [
        ([], "holds no text"),
        ("a car", "is one string"),
        (["a car"] * 4100 + [" "], r"\[4100\]: is blank"),
        (["a car", 3], r"\[1\]: is int"),
    ],
)
def test_texts_that_cannot_be_measured_leave_an_earlier_file(file, texts, fault):
    before = file.read_bytes()
    with pytest.raises(DataError, match=fault):
        write_embeddings(file, ENCODER, texts)
    assert file.read_bytes() == before
    assert sorted(path.name for path in file.parent.iterdir()) == [file.name, f"{file.name}.json"]


def unreadable_line():
    yield "a car"
    yield Path("missing.txt").read_text()


@pytest.mark.parametrize(
    ("texts", "kind"),
    [
        (unreadable_line(), FileNotFoundError),
        ((str(int(text)) for text in ["x"]), ValueError),
    ],
)
def test_errors_of_the_callers_texts_are_the_callers(file, texts, kind):
    before = file.read_bytes()
    with pytest.raises(kind) as error:
        write_embeddings(file, ENCODER, texts)
    assert not isinstance(error.value, OodscenError)
    assert "write" not in str(error.value)
    assert file.read_bytes() == before


@pytest.mark.parametrize("name", ["n" * 248 + ".npy", "folder.npy"])
def test_nothing_is_replaced_where_the_record_cannot_be_written(tmp_path, name):
    (tmp_path / "folder.npy.json").mkdir()
    before = sorted(tmp_path.iterdir())
    with pytest.raises(OodscenError, match=r"cannot write .*\.npy\.json"):
        write_embeddings(tmp_path / name, ENCODER, TEXTS)
    assert sorted(tmp_path.iterdir()) == before


def test_a_record_never_describes_another_array(file, monkeypatch):
    whole = Path.replace

    def fail(path, target):
        if Path(target).suffix == ".json":
            raise OSError("the disk is gone")
        return whole(path, target)

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OodscenError, match="the disk is gone"):
        write_embeddings(file, HashEncoder(16), reversed(TEXTS))
    with pytest.raises(DataError):
        open_embeddings(file, ENCODER)


def test_a_record_of_another_number_of_rows_is_refused(file):
    np.save(file, np.load(file)[:3])
    with pytest.raises(DataError, match=r"\(3, 16\), but \(50, 16\) in ordinary\.npy\.json"):
        open_embeddings(file, ENCODER)


@pytest.mark.parametrize("step", [2, -1])
def test_rows_are_read_without_a_step(file, step):
    with pytest.raises(UsageError, match="step"):
        open_embeddings(file, ENCODER)[::step]


def test_another_encoders_baseline_is_refused(file):
    with pytest.raises(UsageError, match="hash-16"):
        open_embeddings(file, HashEncoder(8))
    with pytest.raises(UsageError):
        Metrics(HashEncoder(8), open_embeddings(file, ENCODER))


@pytest.mark.parametrize("damage", ["truncated", "no record", "float64", "flat", "text", "nan"])
def test_a_damaged_file_is_a_data_error(file, damage):
    content = file.read_bytes()
    if damage == "truncated":
        file.write_bytes(content[:-100])
    elif damage == "no record":
        (file.parent / "ordinary.npy.json").unlink()
    elif damage == "float64":
        np.save(file, np.load(file).astype(np.float64))
    elif damage == "flat":
        np.save(file, np.load(file).ravel())
    elif damage == "text":
        file.write_text("not an array")
    else:
        rows = np.load(file)
        rows[7, 3] = np.nan
        np.save(file, rows)
    with pytest.raises(DataError):
        Metrics(ENCODER, open_embeddings(file, ENCODER)).oodness(["a car"])


def header(text):
    return b"\x93NUMPY\x01\x00v\x00" + text.ljust(117).encode() + b"\n" + bytes(64)


def shaped(shape):
    return header(f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}")


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"PK\x03\x04" + b"x" * 100,
        shaped((10**30, 16)),
        shaped((-3, 16)),
        shaped((2**62, 16)),
        shaped((True, 16)),
        header("{'descr': '<f4', 'shape': (("),
        header("{[]: 1}"),
        header("{'descr': ('a',), 'fortran_order': False, 'shape': (1,)}"),
    ],
)
@pytest.mark.filterwarnings("ignore")
def test_what_is_no_array_is_a_data_error(file, content):
    file.write_bytes(content)
    with pytest.raises(DataError, match="is no array"):
        open_embeddings(file, ENCODER)


def test_an_archive_of_arrays_is_a_data_error(file):
    np.savez(file.with_suffix(".npz"), a=np.ones((2, 16), np.float32))
    file.with_suffix(".npz").rename(file)
    with pytest.raises(DataError, match="is no array"):
        open_embeddings(file, ENCODER)


def test_an_arrow_file_of_another_layout_is_a_data_error(tmp_path):
    rows = np.ones((3, 16), np.float32)
    for bad in (
        arrow(tmp_path / "a.arrow", rows, ""),
        arrow(tmp_path / "b.arrow", rows, "hash-16", "other"),
        arrow(tmp_path / "c.arrow", rows.astype(np.float64), "hash-16"),
    ):
        with pytest.raises(DataError):
            open_embeddings(bad, ENCODER)


@pytest.mark.parametrize("name", ["list_", "large_list", "float32"])
def test_a_column_of_another_type_is_named(tmp_path, name):
    pa = pytest.importorskip("pyarrow")
    kind = pa.float32() if name == "float32" else getattr(pa, name)(pa.float32())
    values = pa.array([0.5 if name == "float32" else [0.5] * 16], kind)
    schema = pa.schema([("vector", kind)], metadata={"encoder": ENCODER.name})
    path = tmp_path / "ordinary.arrow"
    with pa.ipc.new_file(str(path), schema) as sink:
        sink.write_table(pa.table([values], schema=schema))
    with pytest.raises(DataError, match=r"vector: holds values of the type .*, not fixed"):
        open_embeddings(path, ENCODER)


@pytest.mark.parametrize("null", ["vector", "value"])
def test_nulls_in_an_arrow_file_are_a_data_error(tmp_path, null):
    pa = pytest.importorskip("pyarrow")
    whole = [0.5] * 16
    vectors = [whole, None if null == "vector" else [None, *whole[1:]], whole]
    kind = pa.list_(pa.float32(), 16)
    schema = pa.schema([("vector", kind)], metadata={"encoder": ENCODER.name})
    path = tmp_path / "ordinary.arrow"
    with pa.ipc.new_file(str(path), schema) as sink:
        sink.write_table(pa.table([pa.array(vectors, kind)], schema=schema))
    with pytest.raises(DataError, match="vector: holds nulls"):
        open_embeddings(path, ENCODER)


@pytest.mark.parametrize("rows", [slice(20, 30), slice(-30, None), slice(None)])
def test_a_value_that_is_not_finite_is_named_by_its_row(file, rows):
    vectors = np.load(file)
    vectors[23, 3] = np.inf
    np.save(file, vectors)
    with pytest.raises(DataError, match="row 23"):
        open_embeddings(file, ENCODER)[rows]

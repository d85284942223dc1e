import pytest

from oodscen.baselines import load_baseline
from oodscen.baselines._baseline import Baseline
from oodscen.errors import DataError, UsageError


def test_a_file_becomes_a_baseline(tmp_path):
    path = tmp_path / "own.txt"
    path.write_text("a car waits\na van turns\na car waits\n")
    baseline = load_baseline(path, licence="MIT")
    assert baseline.texts == ("a car waits", "a van turns", "a car waits")
    assert (len(baseline), baseline.name, baseline.licence) == (3, "own.txt", "MIT")
    assert str(tmp_path) not in baseline.to_json()


def test_the_digest_is_of_the_texts_in_order():
    one = Baseline(texts=("a", "b"), name="x")
    assert one.digest() == Baseline(texts=("a", "b"), name="y").digest()
    assert one.digest() != Baseline(texts=("b", "a")).digest()
    assert one.digest() != Baseline(texts=("a b",)).digest()


def test_a_baseline_round_trips():
    baseline = Baseline(texts=("a", "b"), name="x", source="s", licence="l")
    assert Baseline.parse(baseline.to_json()) == baseline


@pytest.mark.parametrize("texts", [[], ["a", " "]])
def test_a_baseline_without_texts_is_refused(texts):
    with pytest.raises(DataError):
        Baseline.parse({"texts": texts})


def test_an_undecodable_file_is_refused(tmp_path):
    (tmp_path / "a.txt").write_bytes(b"\x80\x81")
    with pytest.raises(DataError):
        load_baseline(tmp_path / "a.txt")


def test_the_bundled_texts_have_no_layout():
    with pytest.raises(UsageError, match="layout"):
        load_baseline(layout="drivelm")
    assert load_baseline(layout="plain") == load_baseline()

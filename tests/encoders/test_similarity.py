import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.encoders import _similarity as similarity
from oodscen.encoders._similarity import largest, nearest, nearest_other, smallest, unit
from oodscen.errors import UsageError
from oodscen.metrics._vectors import accelerated


def vectors(seed: int, n: int, d: int, *, adverse: bool = False) -> np.ndarray:
    """Random rows; if adverse, among them copies, near-copies, opposites and zeros."""
    draws = np.random.default_rng(seed)
    rows = draws.normal(size=(n, d)).astype(np.float32)
    if adverse:
        source = draws.integers(0, n, n)
        kind = draws.integers(0, 5, n)
        rows[kind == 0] = rows[source[kind == 0]]
        rows[kind == 1] = rows[source[kind == 1]] * np.float32(1.0 + 1e-6)
        rows[kind == 2] = -rows[source[kind == 2]]
        rows[kind == 3] = 0.0
    return rows


def exact(rows: np.ndarray) -> np.ndarray:
    wide = rows.astype(np.float64)
    lengths = np.linalg.norm(wide, axis=1)[:, None]
    return np.divide(wide, lengths, out=np.zeros_like(wide), where=lengths > 0)


@pytest.fixture(params=["as it is", "small blocks"])
def blocks(request, monkeypatch):
    if request.param == "small blocks":
        for name, size in (("_ROWS", 5), ("_COLUMNS", 3), ("_MOST_COLUMNS", 4), ("_GROUP", 2)):
            monkeypatch.setattr(similarity, name, size)


sizes = st.integers(1, 30)
laws = settings(deadline=None, max_examples=60)


@pytest.mark.parametrize("small", [False, True])
@laws
@given(st.integers(0, 999), sizes, sizes, st.integers(1, 9), st.booleans())
def test_it_agrees_with_float64(small, seed, n, m, d, adverse):
    with pytest.MonkeyPatch.context() as patch:
        if small:
            patch.setattr(similarity, "_ROWS", 5)
            patch.setattr(similarity, "_COLUMNS", 3)
            patch.setattr(similarity, "_MOST_COLUMNS", 4)
            patch.setattr(similarity, "_GROUP", 2)
        a, b = vectors(seed, n, d, adverse=adverse), vectors(seed + 1, m, d, adverse=adverse)
        cosines = exact(a) @ exact(b).T
        found = nearest(unit(a), unit(b))
        np.testing.assert_allclose(found.cosine, cosines.max(axis=1), atol=1e-6)
        np.testing.assert_allclose(cosines[np.arange(n), found.index], found.cosine, atol=1e-6)
        np.testing.assert_allclose(smallest(unit(a), unit(b)), cosines.min(axis=1), atol=1e-6)
        k = 1 + seed % m
        values, places = largest(unit(a), unit(b), k)
        np.testing.assert_allclose(values, -np.sort(-cosines, axis=1)[:, :k], atol=1e-6)
        assert all(len(set(row)) == k for row in places.tolist())
        if n > 1:
            own = exact(a) @ exact(a).T
            np.fill_diagonal(own, -np.inf)
            other = nearest_other(unit(a))
            np.testing.assert_allclose(other.cosine, own.max(axis=1), atol=1e-6)
            np.testing.assert_allclose(own[np.arange(n), other.index], other.cosine, atol=1e-6)
            skipped, _ = largest(unit(a), unit(a), 1, np.arange(n))
            np.testing.assert_allclose(skipped[:, 0], other.cosine, atol=1e-6)


def test_many_blocks_give_what_one_gives():
    rows = unit(vectors(3, 9000, 6))
    found = nearest_other(rows)
    cosines, places = largest(rows, rows, 1, np.arange(9000))
    np.testing.assert_allclose(found.cosine, cosines[:, 0], atol=1e-6)
    assert (found.index == places[:, 0]).mean() > 0.999
    assert (found.index != np.arange(9000)).all()


def test_of_equals_the_first_is_named(blocks):
    a = unit(vectors(1, 1, 4))
    many = np.repeat(a, 11, axis=0)
    assert nearest(a, many).index.tolist() == [0]
    assert largest(a, many, 4)[1].tolist() == [[0, 1, 2, 3]]
    assert nearest_other(many).index.tolist() == [1] + [0] * 10


@laws
@given(st.integers(0, 2**32 - 1), sizes, st.integers(2, 9), st.booleans(), st.data())
def test_the_nearest_of_a_query_do_not_depend_on_the_other_queries(seed, m, d, small, data):
    draws = np.random.default_rng(seed)
    a, b = (unit(draws.integers(-1, 2, (n, d)).astype(np.float32)) for n in (70, m))
    k = data.draw(st.integers(1, m))
    some = data.draw(st.lists(st.integers(0, 69), min_size=1, max_size=5))
    with pytest.MonkeyPatch.context() as patch:
        if small:
            patch.setattr(similarity, "_COLUMNS", 3)
            patch.setattr(similarity, "_MOST_COLUMNS", 4)
        together = np.sort(largest(a, b, k)[1], axis=1)
        alone = np.sort(largest(a[some], b, k)[1], axis=1)
    assert together[some].tolist() == alone.tolist()
    cosines = exact(a) @ exact(b).T
    first = np.sort(np.argsort(-np.round(cosines, 5), axis=1, kind="stable")[:, :k], axis=1)
    assert together.tolist() == first.tolist()


def test_a_zero_vector_has_the_cosine_0_to_everything(blocks):
    rows = unit(np.vstack([np.zeros((1, 4), np.float32), vectors(2, 9, 4)]))
    assert nearest(rows[:1], rows[1:]).cosine.tolist() == [0.0]
    assert nearest_other(rows).cosine[0] == 0.0


def test_references_may_lie_on_disk(tmp_path, blocks):
    rows = unit(vectors(5, 40, 8))
    np.save(tmp_path / "rows.npy", rows)
    found = nearest(rows[:7], np.load(tmp_path / "rows.npy", mmap_mode="r"))
    assert found.index.tolist() == list(range(7))


@laws
@given(st.integers(0, 999), sizes, sizes)
def test_torch_gives_the_same(seed, n, m):
    a, b = unit(vectors(seed, n, 6, adverse=True)), unit(vectors(seed + 1, m, 6, adverse=True))
    ours, torchs = nearest(a, b), accelerated.nearest(a, b, "cpu")
    np.testing.assert_allclose(torchs.cosine, ours.cosine, atol=1e-6)
    chosen = np.einsum("ij,ij->i", a, b[torchs.index])
    np.testing.assert_allclose(chosen, ours.cosine, atol=1e-6)


def test_a_device_that_is_not_here_is_refused():
    assert accelerated.chosen_device("cpu") == "cpu"
    with pytest.raises(UsageError):
        accelerated.chosen_device("no-such-device")

import io
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.encoders._similarity import unit
from oodscen.errors import UsageError
from oodscen.metrics._vectors.axes import principal_axes
from oodscen.report._charts.plots import plot

pytest.importorskip("matplotlib")


def rows(seed: int, n: int) -> np.ndarray:
    return unit(np.random.default_rng(seed).normal(size=(n, 6)).astype(np.float32))


def drawn(figure, tmp_path) -> bytes:
    figure.savefig(tmp_path / "figure.png")
    return (tmp_path / "figure.png").read_bytes()


def words(figure) -> list[str]:
    return [text.get_text() for text in figure.axes[0].texts]


def test_every_set_is_in_the_picture(tmp_path):
    figure = plot({"ordinary": [0.1, 0.2, 0.2], "strange": [0.5]}, label="score")
    assert {"ordinary", "n = 3", "mean 0.167", "strange", "n = 1"} <= set(words(figure))
    assert drawn(figure, tmp_path)[:4] == b"\x89PNG"
    vectors = {"strange": rows(1, 2), "ordinary": rows(0, 30)}
    mapped = plot(vectors, "map", reference="ordinary")
    assert [word for word in words(mapped) if "(" in word] == ["ordinary (30)", "strange (2)"]
    points = [len(dots.get_offsets()) for dots in mapped.axes[0].collections]
    assert points[:2] == [30, 2]
    assert len(plot(vectors, "size_curve", repeats=2).axes[0].patches) == 4


def test_the_same_sets_give_the_same_picture(tmp_path):
    sets = {"a": rows(0, 20), "b": rows(1, 9)}
    assert drawn(plot(sets, "map"), tmp_path) == drawn(plot(sets, "map"), tmp_path)


def test_axes_are_orthonormal_and_their_sign_is_fixed():
    set_ = rows(2, 40)
    mean, axes, share = principal_axes(set_)
    np.testing.assert_allclose(axes @ axes.T, np.eye(2), atol=1e-9)
    again = principal_axes(set_[::-1])[1]
    np.testing.assert_allclose(axes, again, atol=1e-6)
    values = np.linalg.eigvalsh(np.cov((set_ - mean).T.astype(float)))[::-1]
    np.testing.assert_allclose(share, values[:2] / values.sum(), atol=1e-6)
    assert principal_axes(set_[:1])[2].tolist() == [0.0, 0.0]


def test_nothing_to_draw_is_refused():
    for bad in ({}, {"a": []}):
        with pytest.raises(UsageError):
            plot(bad)
    with pytest.raises(UsageError):
        plot({"a": rows(0, 1)}, "size_curve")
    with pytest.raises(UsageError):
        plot({"a": rows(0, 3)}, "map", reference="b")
    for bad in (
        [math.nan],
        ["x"],
        ["1"],
        [True],
        [1j],
        [1e13],
        np.ones((2, 3)),
        [[1.0], [1.0, 2.0]],
    ):
        with pytest.raises(UsageError, match="scores"):
            plot({"a": bad})
    for bad in (np.full((4, 3), math.nan), np.ones(4), ["x", "y"], np.ones((2, 0))):
        for kind in ("map", "size_curve"):
            with pytest.raises(UsageError, match="vectors"):
                plot({"a": bad}, kind)
    with pytest.raises(UsageError, match="lengths"):
        plot({"a": rows(0, 3), "b": rows(0, 3)[:, :2]}, "map")
    with pytest.raises(UsageError, match="UTF-8"):
        plot({"\ud800": [1.0]})
    with pytest.raises(UsageError, match=r"label .*UTF-8"):
        plot({"a": [1.0]}, label="\ud800")
    with pytest.raises(UsageError, match="heatmap"):
        plot({"a": [1.0]}, "heatmap")


@pytest.mark.parametrize(
    "bad",
    [
        [-(2**63)],
        [2**63],
        np.array([-(2**63)]),
        np.array([math.inf, 1.0], np.float16),
        np.array([-math.inf], np.float32),
        np.longdouble("1e400"),
        np.array([np.longdouble("1e400")]),
    ],
    ids=repr,
)
def test_numbers_beyond_what_can_be_drawn_are_refused(bad):
    with pytest.raises(UsageError):
        plot({"a": bad})


def test_half_precision_is_drawn_as_it_is():
    halves = np.array([0.25, 0.5, 1.0], np.float16)
    assert words(plot({"a": halves})) == words(plot({"a": halves.astype(float)}))
    vectors = np.eye(3, dtype=np.float16)
    assert words(plot({"a": vectors}, "map")) == words(plot({"a": vectors.astype(float)}, "map"))


@settings(deadline=None, max_examples=20)
@given(
    st.sampled_from(("$\\bad$", "$x$ cost $y$", "a_b^c", "\\frac", "$")),
    st.text(st.characters(min_codepoint=32, max_codepoint=126), min_size=1, max_size=12),
)
def test_names_and_labels_are_words_and_no_mathematics(name, label):
    figure = plot({name: [1.0]}, label=label)
    assert {name, label} <= set(words(figure))
    figure.savefig(io.BytesIO())
    assert not any(text.get_parse_math() for text in figure.axes[0].texts)


def test_options_of_another_kind_or_beyond_their_range_are_refused():
    sets = {"a": rows(0, 3)}
    for bad in (0, -1, 10**9):
        with pytest.raises(UsageError, match="repeats"):
            plot(sets, "size_curve", repeats=bad)
    for kind in ("distribution", "size_curve"):
        with pytest.raises(UsageError, match="only a map"):
            plot(sets, kind, reference="a")


@pytest.mark.parametrize("factor", [0.0, 0.5, 3.0])
def test_a_size_curve_is_of_unit_vectors(factor):
    with pytest.raises(UsageError, match="unit length"):
        plot({"a": rows(0, 5) * factor}, "size_curve")


def test_whole_numbers_are_numbers():
    assert words(plot({"a": [1, 2]})) == words(plot({"a": [1.0, 2.0]}))
    assert len(plot({"a": [[1, 0], [0, 1]]}, "size_curve", repeats=1).axes[0].patches) == 2

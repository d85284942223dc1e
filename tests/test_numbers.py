"""Numbers that a script gives: those that nobody can mean are refused, whatever function they are for."""

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Metrics, StudyConfig
from oodscen._numbers import finite_number, plain_number, whole_number
from oodscen.driving._base_simulator import checked_control
from oodscen.errors import OodscenError, UsageError
from oodscen.judging._leaderboard.power import power_of, scenes_needed
from oodscen.protocols import Camera, Control
from oodscen.stages._simulate import simulate
from oodscen.testing._encoder import HashEncoder
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

STRANGE = [math.nan, math.inf, -math.inf, 1e308, -1, 10**400, "3", None, b"3", [], 1j, True]
NO_COUNT = [*STRANGE, 0, 2.5]
TEXTS = ["A deer.", "A sofa.", "A car waits."]
METRICS = Metrics(HashEncoder(), ["A car drives.", "A van waits.", "A bus stops.", "A tram."])


@pytest.mark.parametrize(
    ("least", "most", "words"),
    [
        (-math.inf, math.inf, "a finite number, not"),
        (-math.inf, 1.0, "a finite number of at most 1, not"),
        (0.5, math.inf, "a finite number of at least 0.5, not"),
        (0.5, 1.0, "a finite number from 0.5 to 1, not"),
    ],
)
def test_a_message_names_the_range(least, most, words):
    with pytest.raises(UsageError, match=words):
        finite_number("x", math.nan, least, most)


@pytest.mark.parametrize("value", NO_COUNT)
def test_counts(value):
    calls = [
        lambda: scenes_needed(0.66, 0.51, comparisons=value),
        lambda: scenes_needed(0.66, 0.51, per_path=value),
        lambda: power_of(0.66, 0.51, value),
        lambda: METRICS.select(TEXTS, value),
        lambda: METRICS.compare(TEXTS, TEXTS, repeats=value),
        lambda: METRICS.distance(TEXTS, TEXTS, repeats=value),
        lambda: METRICS.baseline_batch(value),
        lambda: METRICS.baseline_batch(2, value),
        lambda: Camera(width=value),
    ]
    if value is not None:
        calls += [
            lambda: METRICS.compare(TEXTS, TEXTS, size=value),
            lambda: METRICS.distance(TEXTS, TEXTS, size=value),
            lambda: METRICS.baseline_diversity(value),
        ]
    for call in calls:
        with pytest.raises(UsageError):
            call()


@pytest.mark.parametrize("value", [*STRANGE, 0.5])
def test_seeds(value):
    for call in (
        lambda: simulate(example_scene(), FlatSimulator(), seed=value),
        lambda: Metrics(HashEncoder(), seed=value),
    ):
        with pytest.raises(UsageError):
            call()


@pytest.mark.parametrize("value", STRANGE)
def test_rates(value):
    for call in (
        lambda: scenes_needed(value, 0.5),
        lambda: scenes_needed(0.5, value),
        lambda: scenes_needed(0.66, 0.51, power=value),
        lambda: scenes_needed(0.66, 0.51, alpha=value),
        lambda: power_of(value, 0.5, 10),
        lambda: power_of(0.5, 0.4, 10, alpha=value),
    ):
        with pytest.raises(UsageError):
            call()
    if value not in (-1, True):
        for name in ("agreement", "icc"):
            with pytest.raises(UsageError):
                scenes_needed(0.66, 0.51, **{name: value})


@pytest.mark.parametrize("value", [math.nan, "3", None, b"3", [], 1j])
def test_bounds(value):
    for call in (
        lambda: METRICS.band(TEXTS, value, 0.0),
        lambda: METRICS.band(TEXTS, 0.0, value),
        lambda: METRICS.off_topic(TEXTS, value),
        lambda: StudyConfig(band=(value, 0.0)),
    ):
        with pytest.raises(UsageError):
            call()


@pytest.mark.parametrize("name", ["", "wrong", None, 3])
def test_choices(name):
    for call in (
        lambda: METRICS.oodness(TEXTS, name),
        lambda: METRICS.baseline_batch(2, definition=name),
        lambda: METRICS.select(TEXTS, 2, method=name),
        lambda: simulate(example_scene(), FlatSimulator(), actions=[name]),
    ):
        with pytest.raises(UsageError):
            call()


NUMBERS = [
    name
    for name, field in StudyConfig.model_fields.items()
    if field.annotation in (int, float, int | None, float | None)
]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -2, "many", [], 1j])
@pytest.mark.parametrize("name", NUMBERS)
def test_a_configuration(name, value):
    for make in (StudyConfig, StudyConfig.quick):
        with pytest.raises(UsageError) as caught:
            make(**{name: value})
        assert caught.value.issues[0].path == name


@given(
    rates=st.tuples(st.floats(), st.floats()),
    shares=st.tuples(st.floats(), st.floats(), st.floats(), st.floats()),
    counts=st.tuples(st.integers(), st.integers(), st.integers()),
)
def test_power_is_a_number_or_a_typed_error(rates, shares, counts):
    power, alpha, agreement, icc = shares
    comparisons, per_path, scenes = counts
    given = {
        "alpha": alpha,
        "agreement": agreement,
        "icc": icc,
        "comparisons": comparisons,
        "per_path": per_path,
    }
    try:
        assert scenes_needed(*rates, power=power, **given).scenes >= 1
        assert 0 <= power_of(*rates, scenes, **given) <= 1
    except UsageError:
        pass


@given(
    gap=st.floats(1e-9, 0.49),
    alpha=st.floats(1e-9, 0.5),
    power=st.floats(1e-9, 1 - 1e-9),
    comparisons=st.integers(1, 1_000_000),
    paired=st.booleans(),
)
def test_power_is_told_as_far_as_it_is_promised(gap, alpha, power, comparisons, paired):
    first = 1e-9
    given = {"alpha": alpha, "comparisons": comparisons, "paired": paired}
    found = scenes_needed(first, first + 2 * gap, power=power, **given)
    assert found.scenes >= 0
    assert 0 <= power_of(first, first + 2 * gap, 1_000_000, **given) <= 1


@given(value=st.one_of(st.floats(), st.integers(), st.text(), st.none(), st.booleans()))
def test_a_number_is_returned_as_it_is_or_refused(value):
    for read, kind in ((whole_number, int), (finite_number, float)):
        try:
            found = read("n", value)
        except UsageError:
            continue
        assert found == value
        assert type(found) is kind


SMALL_INTEGERS = st.sampled_from([np.int8, np.uint8, np.int16, np.uint16, np.int32, np.int64])


@given(kind=SMALL_INTEGERS, per_path=st.integers(1, 127), comparisons=st.integers(1, 127))
def test_small_integers_of_numpy_count_as_pythons(kind, per_path, comparisons):
    rates = (0.75, 0.5)
    wanted = scenes_needed(*rates, per_path=per_path, comparisons=comparisons, icc=0.25)
    found = scenes_needed(*rates, per_path=kind(per_path), comparisons=kind(comparisons), icc=0.25)
    assert found == wanted
    assert found.power_of(kind(100)) == wanted.power_of(100)
    camera = Camera(kind(per_path), kind(comparisons))
    assert camera.width * camera.height == per_path * comparisons


@given(value=st.one_of(st.floats(), st.integers(), st.text(), st.none(), st.booleans()))
def test_a_plain_number_is_left_alone(value):
    assert plain_number(value) is value


def test_a_duration_is_no_number():
    for check in (whole_number, finite_number):
        with pytest.raises(UsageError, match="timedelta64"):
            check("n", np.timedelta64(3, "s"))


@pytest.mark.parametrize("value", [math.nan, math.inf, 10**400, "3", None, [], 1j, Decimal("sNaN")])
def test_controls(value):
    for control in (Control(value, 0.0), Control(0.0, value), value):
        with pytest.raises(UsageError):
            checked_control(control)


@pytest.mark.parametrize("value", [math.nan, 0, 2.0, 2.5, "3", None, True])
def test_sizes_of_a_table(value):
    with pytest.raises(UsageError):
        METRICS.paper_table(TEXTS, sizes=(2, value))


@given(x=st.floats(allow_nan=False), y=st.floats(allow_nan=False), z=st.floats(allow_nan=False))
def test_a_camera_at_any_place_draws_or_is_refused(x, y, z):
    try:
        frame = DRAWING.render(Camera(8, 6, x=x, y=y, z=z))
    except OodscenError:
        return
    assert frame.rgb.shape == (6, 8, 3)


DRAWING = FlatSimulator()
DRAWING.reset(example_scene(), 0)

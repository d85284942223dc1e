"""The floor below which a viewer cannot name a hazard."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._sighting import LEAST_SIGNAL, LEAST_SIZE_PX, Sighting, apparent_size

sizes = st.floats(0.0, 500.0)


@given(sizes, st.floats(0.0, 1e5), st.floats(1.0, 4.0))
def test_size_lies_between_the_height_and_its_double_and_grows_with_the_picture(
    height, area, scale
):
    size = apparent_size(height, area)
    assert height <= size <= 2.0 * height
    assert apparent_size(scale * height, scale * scale * area) == pytest.approx(scale * size)
    assert apparent_size(height, 2.0 * area) >= size


def look(**fields):
    clear = {"actor": "dog", "distance_m": 20.0, "height_px": 30.0, "size_px": 30.0}
    return Sighting.model_validate({**clear, "contrast": 0.3, **fields})


@pytest.mark.parametrize(
    ("fields", "faults"),
    [
        ({}, ()),
        ({"contrast": None}, ()),
        ({"size_px": LEAST_SIZE_PX}, ()),
        ({"size_px": LEAST_SIZE_PX - 0.1}, ("small",)),
        ({"size_px": 0.0}, ("outside",)),
        ({"size_px": 0.0, "hidden": 1.0}, ("hidden",)),
        ({"hidden": 0.9}, ("hidden",)),
        ({"contrast": 0.01}, ("faint",)),
        ({"contrast": 0.1, "area_px": 100.0}, ("faint",)),
        ({"contrast": 0.1, "area_px": 400.0}, ()),
        ({"contrast": None, "area_px": 1.0}, ()),
        ({"brightness": 0.01, "contrast": 0.01}, ("faint", "dark")),
    ],
)
def test_every_fault_is_named(fields, faults):
    assert look(**fields).faults == faults


@given(st.floats(0.04, 1.0), st.floats(0.0, 1e5), st.floats(1.0, 10.0))
def test_what_shows_stays_so_when_it_grows_or_stands_out_more(contrast, area, factor):
    if look(contrast=contrast, area_px=area).faults == ():
        assert look(contrast=contrast, area_px=factor * area).faults == ()
        assert look(contrast=min(1.0, factor * contrast), area_px=area).faults == ()
    else:
        assert contrast * contrast * area <= 1.001 * LEAST_SIGNAL**2

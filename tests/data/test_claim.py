"""Claims are a closed vocabulary; what is outside it is refused with a reason."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._claim import NUMBERS, OF_THINGS, VALUES, Claim, Mismatch
from oodscen.errors import DataError


@st.composite
def claims(draw):
    kind = draw(st.sampled_from([*VALUES, *NUMBERS]))
    value = str(draw(st.integers(1, 1000)))
    if kind in VALUES:
        value = draw(st.sampled_from(sorted(VALUES[kind])))
    subject = draw(st.sampled_from(["car", "cardboard box"] if kind in OF_THINGS else ["", " "]))
    return Claim(kind=kind, value=value, subject=subject, quote=draw(st.text(max_size=20)))


@given(claims())
def test_a_claim_survives_json_and_says_what_it_means(claim):
    assert Claim.parse(claim.to_json()) == claim
    assert str(claim).startswith(f"{claim.subject.strip() or claim.kind}: ")
    assert str(claim) in str(Mismatch(claim=claim, found="nothing of it"))


@pytest.mark.parametrize(
    "fields",
    [
        {"kind": "weather", "value": "hail"},
        {"kind": "weather", "value": "rain", "subject": "car"},
        {"kind": "thing", "value": "present"},
        {"kind": "lanes", "value": "many"},
        {"kind": "count", "value": "0", "subject": "car"},
        {"kind": "count", "value": "٣", "subject": "car"},
        {"kind": "colour", "value": "red"},
    ],
)
def test_what_is_outside_the_vocabulary_is_refused(fields):
    with pytest.raises(DataError):
        Claim.parse(fields)

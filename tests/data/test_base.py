"""Laws of every data type: canonical text, exact round trips, every fault at once."""

import json
import pickle
from functools import cached_property

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from oodscen.data._base import Data, LeanData, canonical_json
from oodscen.data._catalogue import Asset, BehaviourKind, BehaviourParameter, RoadMap, WeatherRange
from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._messages import Image, Message
from oodscen.data._scenario import Scenario
from oodscen.data._verdict import Verdict
from oodscen.errors import DataError
from oodscen.llm._call_log import Call
from oodscen.protocols import Completion, Usage

text = st.text(max_size=8)
number = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=1e-3, max_value=1e3)
parameters = st.lists(number, min_size=3, max_size=3).map(
    lambda three: BehaviourParameter(
        **dict(zip(("minimum", "default", "maximum"), sorted(three), strict=True))
    )
)
identifier = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,8}", fullmatch=True)

values = st.one_of(
    st.builds(Scenario, id=identifier, text=st.text(min_size=1), path=st.lists(text).map(tuple)),
    st.builds(Message, role=st.sampled_from(["system", "user"]), text=text),
    st.builds(Image, name=text, sha256=text),
    st.builds(Usage, input_tokens=st.integers(), cost_usd=st.none() | number),
    st.builds(Completion, text=text),
    st.builds(Asset, length=positive, width=positive, height=positive),
    parameters,
    st.builds(BehaviourKind, parameters=st.dictionaries(text, parameters)),
    st.builds(RoadMap, lanes=st.integers(1, 6), speed_limit=positive, length_m=positive),
    st.builds(WeatherRange, min_friction=number),
    st.builds(ActionOutcome, margin_m=st.none() | number),
    st.builds(
        Episode,
        status=st.sampled_from(["ok", "failed"]),
        visible=st.dictionaries(text, st.dictionaries(text, st.integers())),
        actions=st.dictionaries(text, st.builds(ActionOutcome, margin_m=st.none() | number)),
    ),
    st.builds(Verdict, descriptions=st.lists(text).map(tuple)),
    st.builds(Call, status=st.sampled_from(["ok", "failed"]), seconds=number),
)


@given(values)
def test_json_gives_the_value_back(value):
    again = type(value).parse(value.to_json())
    assert again == value
    assert again.to_json() == value.to_json()
    assert type(value).parse(json.loads(value.to_json())) == value
    assert pickle.loads(pickle.dumps(value)) == value


@given(values, values)
def test_the_digest_tells_values_apart(one, other):
    if type(one) is type(other):
        assert (one.digest() == other.digest()) == (one.to_json() == other.to_json())


@given(st.dictionaries(text, st.recursive(number | text | st.none(), st.lists, max_leaves=4)))
def test_canonical_text_does_not_depend_on_the_order_of_keys(value):
    other = dict(reversed(value.items()))
    assert canonical_json(other) == canonical_json(value)
    assert json.loads(canonical_json(value)) == value


def test_values_are_frozen_and_closed():
    with pytest.raises(ValueError, match="frozen"):
        Usage().input_tokens = 3
    with pytest.raises(DataError) as caught:
        Usage.parse({"tokens": 1})
    assert [issue.path for issue in caught.value.issues] == ["tokens"]


@pytest.mark.parametrize("constant", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_numbers_are_finite(constant):
    with pytest.raises(DataError):
        Usage.parse(f'{{"cost_usd": {constant}}}')


class Several(Data):
    values: tuple[int, ...] = Field(min_length=2)


class Exact(Data):
    _refuses_conversion = True

    number: float
    other: Several | None = None


@pytest.mark.parametrize("other", [Several(values=(1, 2)), {"values": [1, 2]}, None])
def test_a_number_as_text_is_refused_whatever_stands_beside_it(other):
    assert Exact.parse({"number": 8.0, "other": other}).number == 8.0
    for number in ("8.0", True):
        with pytest.raises(DataError) as caught:
            Exact.parse({"number": number, "other": other})
        assert [issue.path for issue in caught.value.issues] == ["number"]


@pytest.mark.parametrize("number", [np.float32(1.0), np.int64(1), np.ones(1), object()])
def test_what_json_cannot_hold_is_refused(number):
    with pytest.raises(DataError):
        Exact.parse({"number": number})


def test_half_a_character_is_told_by_its_name_not_by_an_escape_that_nobody_wrote():
    with pytest.raises(DataError, match="lone surrogate"):
        Exact.parse({"number": "\ud800"})


class Lean(LeanData):
    _left_out = ("count", "names", "flag")

    count: int | None = 5
    names: tuple[str, ...] = ()
    flag: bool = False


@given(st.builds(Lean, count=st.none() | st.integers(), names=st.lists(text).map(tuple)))
def test_a_number_is_never_left_out(value):
    assert ("count" in json.loads(value.to_json())) == (value.count is not None)
    assert ("names" in json.loads(value.to_json())) == bool(value.names)
    assert value.count is None or Lean.parse(value.to_json()) == value


def test_a_noun_keeps_an_acronym_together():
    class OSIFile(Data): ...

    assert OSIFile.noun == "osi file"
    assert Lean.noun == "lean"


@given(st.binary())
def test_any_bytes_in_a_file_are_a_value_or_a_data_error(tmp_path_factory, data):
    file = tmp_path_factory.getbasetemp() / "any.json"
    file.write_bytes(data)
    with pytest.raises(DataError):
        Scenario.load(file)


def test_a_missing_file_and_a_folder_are_data_errors(tmp_path):
    for path in (tmp_path / "none.json", tmp_path):
        with pytest.raises(DataError) as caught:
            Scenario.load(path)
        assert caught.value.source == str(path)


def test_an_image_is_read_late(tmp_path):
    file = tmp_path / "a.jpg"
    file.write_bytes(b"bytes")
    image = Image.from_file(file, "frames/a.jpg")
    assert (image.name, image.read()) == ("frames/a.jpg", b"bytes")
    assert "path" not in json.loads(image.to_json())
    with pytest.raises(FileNotFoundError):
        Image.parse(image.to_json()).read()


def test_a_changed_copy_remembers_nothing_of_the_original():
    class Doubled(Data):
        number: int

        @cached_property
        def twice(self) -> int:
            return 2 * self.number

    one = Doubled(number=2)
    assert one.twice == 4
    assert one.model_copy(update={"number": 5}).twice == 10


def test_a_copy_does_not_take_a_misspelt_field_for_no_change():
    with pytest.raises(DataError, match="token: is no field") as caught:
        Usage().model_copy(update={"token": 1, "input_tokens": 2})
    assert caught.value.noun == "usage"

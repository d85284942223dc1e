"""Files of catalogues: what is ambiguous or no size is refused with file, id or field."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data import Catalogue
from oodscen.data._catalogue import LONGEST_ASSET_M, BehaviourParameter
from oodscen.errors import DataError
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE


def changed(**fields: Any) -> dict[str, Any]:
    plain: dict[str, Any] = FLAT_CATALOGUE.model_dump(mode="json")
    return {**plain, **fields}


@pytest.mark.parametrize("kind", ["assets", "behaviours", "maps"])
def test_an_id_twice_is_told_with_the_file(kind: str, tmp_path: Path) -> None:
    things = changed()[kind]
    path = tmp_path / "cat.json"
    path.write_text(json.dumps(changed(**{kind: [*things, things[0]]})))
    with pytest.raises(DataError) as refused:
        Catalogue.load(path)
    assert [issue.path for issue in refused.value.issues] == [kind]
    assert str(path) in str(refused.value)
    assert repr(things[0]["id"]) in str(refused.value)


@given(
    st.sampled_from(["length", "width", "height"]),
    st.floats(max_value=0.0) | st.floats(LONGEST_ASSET_M, exclude_min=True) | st.just(math.nan),
)
def test_what_is_no_size_is_refused_with_its_field(field: str, size: float) -> None:
    first, *others = changed()["assets"]
    with pytest.raises(DataError) as refused:
        Catalogue.parse(changed(assets=[{**first, field: size}, *others]))
    assert [issue.path for issue in refused.value.issues] == [f"assets[0].{field}"]


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(finite, finite, finite)
def test_a_parameter_has_its_default_between_its_limits(
    low: float, high: float, default: float
) -> None:
    limits = {"minimum": low, "maximum": high, "default": default}
    if low <= default <= high:
        assert BehaviourParameter.parse(limits).default == default
    else:
        with pytest.raises(DataError) as refused:
            BehaviourParameter.parse(limits)
        assert [issue.path for issue in refused.value.issues] == [
            "minimum" if low > high else "default"
        ]

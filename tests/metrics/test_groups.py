"""Groups of texts are named by labels, numbers and paths, and by nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scenario import Scenario
from oodscen.errors import UsageError
from oodscen.metrics._groups import group_name, paths_of

LABELS = st.text(min_size=1)


@given(st.lists(LABELS, min_size=1, max_size=4))
def test_a_path_has_one_name_whatever_holds_its_labels(labels):
    name = group_name(tuple(labels))
    assert name == group_name(labels)
    scenario = Scenario(id="a", text="Fog.", path=tuple(labels))
    assert paths_of([scenario]) == (name,)


@given(LABELS, st.integers())
def test_a_label_is_its_own_name_and_a_number_its_digits(label, number):
    assert group_name(label) == label
    assert group_name(number) == str(number)


@pytest.mark.parametrize("label", [None, True, 1.5, (), ("r", 2), {}, np.array([1, 2])])
def test_anything_else_is_no_group(label):
    with pytest.raises(UsageError, match="each element of groups"):
        group_name(label)


def test_texts_without_paths_have_no_groups():
    scenario = Scenario(id="a", text="Fog.", path=("r",))
    assert paths_of([scenario, "Rain."]) is None
    assert paths_of([scenario.model_copy(update={"path": ()})]) is None

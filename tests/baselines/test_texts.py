import numpy as np
import pytest

from oodscen.baselines._baseline import Baseline
from oodscen.baselines._texts import check_texts
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError


class Table:
    """A table as pandas has it: a loop over it gives the names of its columns."""

    ndim = 2

    def __iter__(self):
        return iter(["text", "label"])


def test_one_string_is_not_a_set_of_texts():
    with pytest.raises(DataError):
        check_texts("a text")
    for other in (
        {"a": "b"},
        {"a"},
        (text for text in ["a"]),
        3,
        np.array("a"),
        np.array([["a", "b"]]),
        Table(),
    ):
        with pytest.raises(DataError, match="not a sequence of texts"):
            check_texts(other)
    assert check_texts(["a text"]) == ("a text",)


@pytest.mark.parametrize(
    "one",
    [
        "a",
        b"a",
        bytearray(b"ab"),
        Scenario(id="a", text="a"),
        Baseline(texts=("a", "b"), name="a", source="a"),
    ],
)
def test_a_single_text_gets_one_fault_that_names_it(one):
    fault = f"is {type(one).__name__}, not a sequence of texts"
    with pytest.raises(DataError, match=fault) as error:
        check_texts(one)
    assert len(error.value.issues) == 1

import numpy as np
import pytest

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
    ("one", "kind"),
    [("a", "string"), (b"a", "bytes object"), (Scenario(id="a", text="a"), "scenario")],
)
def test_a_single_text_gets_one_fault_that_names_it(one, kind):
    with pytest.raises(DataError, match=f"is one {kind}, not a sequence of texts") as error:
        check_texts(one)
    assert len(error.value.issues) == 1

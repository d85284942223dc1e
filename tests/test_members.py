"""Members that a component need not have, of components that misbehave."""

from typing import Any

import pytest

from oodscen import Metrics, make_catalogue
from oodscen._members import as_catalogue, conforming
from oodscen.errors import DataError, UsageError
from oodscen.judging._references import is_reference, takes_cases
from oodscen.llm._ask import speaker
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder


class Broken(ScriptedLLM):
    """A model whose missing attributes raise another error than they should."""

    def __getattr__(self, name: str) -> Any:
        raise RuntimeError(name)


class Obliging(ScriptedLLM):
    """A model that has every attribute, as a mock has."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *_: None


@pytest.mark.parametrize("kind", [Broken, Obliging])
def test_a_model_with_odd_attributes_is_a_plain_model(kind: type[ScriptedLLM]) -> None:
    model = kind(lambda request: "")
    assert not is_reference(model)
    assert not takes_cases(model)
    assert speaker(model) == model.name


@pytest.mark.parametrize(
    "name", ["a\nb", "a\tb", "a\u2028b", "a\x1b[31m", "a\u202eb", "a\ud800", " ", "\u200b", "a\n"]
)
@pytest.mark.parametrize("kind", ["encoder", "llm"])
def test_a_name_is_visible_and_on_one_line(kind: str, name: str) -> None:
    made: Any = HashEncoder() if kind == "encoder" else ScriptedLLM(lambda request: "")
    for usable in ("a b", "all-MiniLM-L6-v2@1a2b", "模型", "modèle  2"):
        made.name = usable
        assert conforming(kind, made) is made
    made.name = name
    with pytest.raises(UsageError, match="has the unusable name") as caught:
        conforming(kind, made)
    assert str(caught.value).isprintable()


def test_an_encoder_whose_attributes_raise_is_not_cached() -> None:
    class BrokenEncoder:
        name, dimension = "broken", HashEncoder().dimension
        encode = staticmethod(HashEncoder().encode)

        def __getattr__(self, name: str) -> Any:
            raise RuntimeError(name)

    texts = ["A cow stands in the lane.", "A sofa lies on the road."]
    assert Metrics(BrokenEncoder(), texts).oodness(texts).mean == pytest.approx(-1.0)


@pytest.mark.parametrize("change", [{"length": 5_000.0}, {"id": "adult"}])
def test_a_copied_catalogue_with_impossible_values_is_refused(change: dict[str, Any]) -> None:
    catalogue = make_catalogue("pybullet")
    first, *rest = catalogue.assets
    copy = catalogue.model_copy(update={"assets": (first.model_copy(update=change), *rest)})
    for _ in range(2):
        assert as_catalogue(catalogue, "mine") is catalogue
        with pytest.raises(DataError, match="malformed catalogue in mine"):
            as_catalogue(copy, "mine")

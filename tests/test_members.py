"""Members that a component need not have, of components that misbehave."""

from typing import Any

import pytest

from oodscen import Metrics
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


def test_an_encoder_whose_attributes_raise_is_not_cached() -> None:
    class BrokenEncoder:
        name, dimension = "broken", HashEncoder().dimension
        encode = staticmethod(HashEncoder().encode)

        def __getattr__(self, name: str) -> Any:
            raise RuntimeError(name)

    texts = ["A cow stands in the lane.", "A sofa lies on the road."]
    assert Metrics(BrokenEncoder(), texts).oodness(texts).mean == pytest.approx(-1.0)

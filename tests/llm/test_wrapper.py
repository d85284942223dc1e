"""A model in front of another one looks like it."""

import copy

import pytest

from oodscen.llm._wrapper import WrappingLLM
from oodscen.testing import ScriptedLLM


def test_it_has_the_name_and_the_attributes_of_who_answers():
    llm = ScriptedLLM(lambda request: "")
    llm.seed = 7
    assert (WrappingLLM(llm).name, WrappingLLM(llm).seed) == (llm.name, 7)


def test_what_is_private_or_missing_is_an_attribute_error():
    llm = WrappingLLM(ScriptedLLM(lambda request: ""))
    for name in ("_secret", "colour"):
        with pytest.raises(AttributeError):
            getattr(llm, name)


def test_a_copy_does_not_look_for_its_model_without_end():
    assert copy.copy(WrappingLLM(ScriptedLLM(lambda request: ""))).name

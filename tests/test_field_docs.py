"""`help` shows what a field means."""

import pydoc
from dataclasses import dataclass, fields

import pytest

from oodscen._field_docs import with_fields
from oodscen.data import Asset, RoadMap, WeatherRange
from oodscen.driving._staged_scene import StagedBody
from oodscen.protocols import Camera, Control, Frame, Observation, State


@with_fields
@dataclass
class Thing:
    """A thing."""

    size: float = 1.0
    """Its size, m, which may be
    long."""
    bare: int = 0
    _hidden: int = 0
    """Nobody's business."""

    def method(self) -> None:
        """Do nothing."""


def test_fields_are_listed_with_type_default_and_meaning() -> None:
    assert (Thing.__doc__ or "").splitlines() == [
        "A thing.",
        "",
        "    Attributes:",
        "        size (float = 1.0): Its size, m, which may be long.",
        "        bare (int = 0)",
        "    ",
    ]
    assert Thing().__doc__ == Thing.__doc__


@pytest.mark.parametrize("cls", [Camera, Control, Frame, Observation, StagedBody, State])
def test_help_tells_every_field_of_what_an_adapter_exchanges(cls) -> None:
    told = pydoc.render_doc(cls, renderer=pydoc.plaintext)
    for field in fields(cls):
        assert f" {field.name} (" in told


@pytest.mark.parametrize("cls", [Asset, RoadMap, WeatherRange])
def test_help_tells_every_field_of_a_catalogue(cls) -> None:
    told = pydoc.render_doc(cls, renderer=pydoc.plaintext)
    for name in cls.model_fields:
        assert f" {name} (" in told

"""A scenario: one text that describes a driving situation."""

from typing import ClassVar

from pydantic import Field

from oodscen.data._base import Data


class Scenario(Data):
    """One text, with the path of the tree that it realises."""

    noun: ClassVar[str] = "scenario"

    id: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", max_length=200)
    """Known before the work: `<leaf>-003`."""
    text: str = Field(min_length=1, max_length=2_000)
    """The situation in words, as an engineer would write it."""
    leaf: str = ""
    """Id of the leaf that it realises; empty for a text from elsewhere."""
    path: tuple[str, ...] = ()
    """Labels from the root down to the leaf."""
    style: str = ""
    """Register in which it was asked for; empty where none was."""
    ordinary: str | None = None
    """Its ordinary twin: same place, phrasing and length, without what is unusual."""
    runners_up: tuple[str, ...] = ()
    """Ids of further leaves that it fits."""

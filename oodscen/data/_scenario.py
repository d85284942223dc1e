"""The scenario: one text that describes a driving situation."""

from pydantic import Field, field_validator

from oodscen.data._base import Data


class Scenario(Data):
    """One text and the tree path that it realises."""

    id: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", max_length=200)
    """Id, fixed before generation: `<leaf>-003`."""
    text: str = Field(min_length=1, max_length=2_000)
    """The situation in an engineer's words."""
    leaf: str = ""
    """Id of the leaf that the text realises; empty for a text from another source."""
    path: tuple[str, ...] = ()
    """Labels from the root down to the leaf."""
    style: str = ""
    """The requested writing style; empty if none was requested."""
    ordinary: str | None = None
    """The text of its ordinary twin: same place, phrasing and length, without the unusual part."""
    runners_up: tuple[str, ...] = ()
    """Ids of further matching leaves."""

    @field_validator("text")
    @classmethod
    def _has_words(cls, text: str) -> str:
        if not text.strip():
            raise ValueError("must not be blank")
        if "\0" in text:
            raise ValueError("must not hold a NUL character")
        return text

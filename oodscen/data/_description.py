"""Descriptions of things and movements made to order, which a model or a file gives."""

from typing import Annotated

from pydantic import AfterValidator, Field

from oodscen._text import is_visible
from oodscen._wording import wording_fault


def _plain(text: str) -> str:
    fault = wording_fault(text) if is_visible(text) else "is empty"
    if fault:
        raise ValueError(f"it {fault}")
    return text


Description = Annotated[
    str,
    Field(min_length=3, max_length=120, pattern=r"^[^\x00-\x1f\x7f<>]+$"),
    AfterValidator(_plain),
]
"""Plain words by the rules of the tree's labels: it goes into questions and onto pages."""

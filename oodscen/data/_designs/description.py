"""Descriptions of things and movements made to order, which a model or a file gives."""

from typing import Annotated

from pydantic import AfterValidator, Field

from oodscen._words.text import is_visible
from oodscen._words.wording import appearance_fault


def _plain(text: str) -> str:
    fault = appearance_fault(text) if is_visible(text) else "is empty"
    if fault:
        raise ValueError(f"it {fault}")
    return text


Description = Annotated[
    str,
    Field(min_length=3, max_length=120),
    AfterValidator(_plain),
]
"""Plain words: it goes into questions and onto pages."""

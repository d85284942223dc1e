"""Outcomes of making something to order, whatever it is."""

from typing import Literal, Self

from oodscen._text import one_line
from oodscen.data._base import Data
from oodscen.errors import LLMError


class Made(Data):
    """Something that was to be made: a subclass has its design."""

    id: str
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    reason: str = ""
    """Why it could not be made."""
    model: str = ""
    """Name of the model that designed it."""
    prompt: str = ""
    """The question that the model was asked: `purpose@version`."""

    @classmethod
    def failed(cls, name: str, error: LLMError, *, model: str, prompt: str) -> Self:
        """Return something that was not made because its model failed."""
        return cls(
            id=name,
            status="failed",
            error=one_line(str(error)),
            retryable=error.retryable,
            model=model,
            prompt=prompt,
        )

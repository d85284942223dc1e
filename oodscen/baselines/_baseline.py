"""A set of texts of ordinary driving."""

from pydantic import Field, field_validator

from oodscen.baselines._texts import check_texts
from oodscen.data._base import Data, digest
from oodscen.data._issues import IssuesError
from oodscen.errors import DataError


class Baseline(Data):
    """Texts of ordinary driving, with their source and licence."""

    texts: tuple[str, ...] = Field(repr=False)
    name: str = "own"
    """The name shown in reports."""
    source: str = ""
    """Origin of the texts."""
    licence: str = ""
    """Licence for redistribution; empty if unknown."""

    @field_validator("texts")
    @classmethod
    def _say_something(cls, texts: tuple[str, ...]) -> tuple[str, ...]:
        try:
            return check_texts(texts, cls.noun)
        except DataError as error:
            raise IssuesError(error.issues) from None

    def __len__(self) -> int:
        return len(self.texts)

    def digest(self) -> str:
        """Return the SHA-256 of the texts in their order; the name does not enter."""
        return digest(self.texts)

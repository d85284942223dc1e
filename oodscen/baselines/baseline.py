"""A set of texts of ordinary driving."""

import hashlib
from pathlib import Path
from typing import ClassVar

from pydantic import Field, field_validator

from oodscen._data import Data, Faults, canonical_json
from oodscen.baselines.texts import check_texts, read_records
from oodscen.errors import DataError


class Baseline(Data):
    """Texts of ordinary driving, with where they come from."""

    noun: ClassVar[str] = "baseline"

    texts: tuple[str, ...] = Field(repr=False)
    name: str = "own"
    """What reports call it."""
    source: str = ""
    """Where the texts come from."""
    licence: str = ""
    """Under which they may be passed on; empty where it is not known."""

    @field_validator("texts")
    @classmethod
    def _say_something(cls, texts: tuple[str, ...]) -> tuple[str, ...]:
        try:
            return check_texts(texts, cls.noun)
        except DataError as error:
            raise Faults(error.issues) from None

    def __len__(self) -> int:
        return len(self.texts)

    def digest(self) -> str:
        """Return the SHA-256 of the texts in their order; the name plays no part."""
        return hashlib.sha256(canonical_json(self.texts).encode()).hexdigest()


def load_baseline(path: str | Path, *, name: str = "", licence: str = "") -> Baseline:
    """Read a baseline from a file.

    Plain lines, JSON lines with `text`, a JSON list, or CSV or TSV with a column `text`. Equal
    texts are kept: a text that occurs often is as ordinary as one that occurs once, and OOD-ness
    does not change.

    Args:
        path: The file.
        name: What reports call it; the file's name by default.
        licence: Under which the texts may be passed on.

    Raises:
        DataError: When the file cannot be read, is not UTF-8, holds no text, or a line has none.
    """
    texts = tuple(record.text for record in read_records(path, Baseline.noun))
    return Baseline(
        texts=texts, name=name or Path(path).name, source=Path(path).name, licence=licence
    )

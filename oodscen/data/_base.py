"""The base class of all data types that are stored in a file or passed between components."""

import hashlib
import json
import re
from collections.abc import Collection, Mapping, Sized
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self, get_args

from pydantic import (
    BaseModel,
    ConfigDict,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_serializer,
)

from oodscen._display import Brief
from oodscen._io.files import read_utf8
from oodscen._io.json import parse_json
from oodscen.data._issues import issues_of
from oodscen.errors import DataError, Issue

ROUNDING = 1e-9
"""Excess over a limit that is rounding, in the unit of the limit."""

if TYPE_CHECKING:
    _Model = BaseModel
else:

    class _Constructor(type(BaseModel)):
        """Makes a direct call raise `DataError`; validation of nested values keeps raising pydantic's error."""

        def __call__(cls, *values: Any, **fields: Any) -> Any:
            try:
                return super().__call__(*values, **fields)
            except ValidationError as error:
                raise DataError(cls.noun, issues_of(error)) from None

    # `help` would show the metaclass's docstring instead of the class's.
    type.__setattr__(_Constructor, "__doc__", type.__dict__["__doc__"])

    class _Model(BaseModel, metaclass=_Constructor):
        noun: ClassVar[str] = "value"


def no_truth_value(value: object) -> object:
    """Return a value unless it is true or false, which Python takes for 1 and 0."""
    if isinstance(value, bool):
        raise ValueError("must not be true or false")
    return value


class Data(Brief, _Model):
    """Immutable, JSON-serialisable value without extra fields; validation reports every fault at once.

    Raises:
        DataError: With one `Issue` per fault.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    noun: ClassVar[str] = "value"
    """The words for an instance in error messages; by default those of the class's name, or of a named base class."""
    _refuses_conversion: ClassVar[bool] = False
    """True if `parse` takes numbers only as numbers, not as texts or truth values."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if cls.noun == Data.noun and "noun" not in vars(cls):
            cls.noun = re.sub(
                r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", cls.__name__.lstrip("_")
            ).lower()

    @field_validator("schema_version", mode="before", check_fields=False)
    @classmethod
    def _is_no_truth_value(cls, version: object) -> object:
        return no_truth_value(version)

    @classmethod
    def parse(cls, value: object, *, source: str = "") -> Self:
        """Validate plain data or JSON text from outside.

        Args:
            value: A JSON document as text, or the equivalent mapping.
            source: The origin of the data, for error messages.

        Raises:
            DataError: With one `Issue` per fault, each with its path.
        """
        is_text = isinstance(value, (str, bytes))
        try:
            if cls._refuses_conversion and not isinstance(value, (str, bytes, cls)):
                value = cls._as_json(value, source)
            if isinstance(value, (str, bytes)):
                parse_json(value)
                return cls.model_validate_json(value, strict=cls._refuses_conversion or None)
            return cls.model_validate(value)
        except ValidationError as error:
            raise DataError(cls.noun, issues_of(error), source=source) from None
        except ValueError as error:
            fault = f"is no JSON: {error}" if is_text else str(error)
            raise DataError(cls.noun, [Issue("", fault)], source=source) from None

    @classmethod
    def _as_json(cls, value: object, source: str) -> str:
        """Return plain data as JSON text, in which a number that is a text stays one.

        Raises:
            DataError: With pydantic's faults of what has no JSON, or else that it has none.
        """
        try:
            return json.dumps(value, ensure_ascii=False, allow_nan=False, default=_as_plain)
        except (TypeError, ValueError, RecursionError) as error:
            with suppress(RecursionError):
                cls.model_validate(value)
            issue = Issue("", f"cannot be written as JSON: {error}")
            raise DataError(cls.noun, [issue], source=source) from None

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read one value from a JSON file.

        Raises:
            DataError: If the file cannot be read or does not hold a valid value.
        """
        return cls.parse(read_utf8(path, cls.noun), source=str(path))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with some fields changed; what was cached of the fields is not copied.

        The values are taken as they are.

        Raises:
            DataError: If there is no field of a name.
        """
        fields = type(self).model_fields.keys()
        if unknown := [Issue(name, "is no field") for name in update or () if name not in fields]:
            raise DataError(self.noun, unknown)
        copied = super().model_copy(update=update, deep=deep)
        for name in copied.__dict__.keys() - fields:
            del copied.__dict__[name]
        return copied

    def to_json(self) -> str:
        """Return the canonical JSON text: sorted keys, no spaces, and the same bytes for equal values but -0.0 and 0.0."""
        return canonical_json(self.model_dump(mode="json"))

    def digest(self) -> str:
        """Return the SHA-256 of the canonical JSON text."""
        return digest(self.model_dump(mode="json"))


class LeanData(Data):
    """Value whose JSON text leaves out some of its fields while they are empty."""

    noun: ClassVar[str] = Data.noun
    _left_out: ClassVar[Collection[str]] = ()
    """The fields that are left out while they are `None`, false or of no length."""

    @model_serializer(mode="wrap")
    def _lean(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        value: dict[str, Any] = serialise(self)
        for name in self._left_out:
            if name in value and _is_empty(value[name]):
                del value[name]
        return value


class Choices(Data):
    """Value of a caller's choices: where no yes or no is asked for, also in a list, `True` is refused and is not 1."""

    noun: ClassVar[str] = Data.noun

    @field_validator("*", mode="before")
    @classmethod
    def _counts_no_truth_value(cls, value: object, info: ValidationInfo) -> object:
        kind = cls.model_fields[info.field_name or ""].annotation
        if bool not in (kind, *get_args(kind)):
            for item in value if isinstance(value, list | tuple) else (value,):
                no_truth_value(item)
        return value


def _is_empty(value: object) -> bool:
    return value is None or value is False or (isinstance(value, Sized) and not len(value))


def _as_plain(value: object) -> Any:
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json")
    raise TypeError(f"JSON has no {type(value).__name__}")


def canonical_json(value: Any) -> str:
    """Serialise plain data to the same text whatever the order of keys."""
    return json.dumps(
        value, ensure_ascii=False, sort_keys=True, separators=(",", ":"), allow_nan=False
    )


def digest(value: Any) -> str:
    """Return the SHA-256 of plain data in canonical JSON."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()

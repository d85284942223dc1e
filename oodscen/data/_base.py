"""The base class of all data types that are stored in a file or passed between components."""

import hashlib
import json
import re
from collections.abc import Collection, Iterable, Mapping, Sequence, Sized
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    SerializerFunctionWrapHandler,
    ValidationError,
    field_validator,
    model_serializer,
)

from oodscen._display import Brief
from oodscen._files import read_utf8
from oodscen._json import parse_json
from oodscen.errors import DataError, Issue

MOST_PARTS = 40
"""Maximum number of parts of a thing made to order, and of those in a group."""
ROUNDING = 1e-9
"""Excess over a limit that is rounding, in the unit of the limit."""
_MAX_NAME = 80
"""Length to which a name in the path of an issue is cut, in characters."""

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
            raise DataError(cls.noun, [Issue("", f"is no JSON: {error}")], source=source) from None

    @classmethod
    def _as_json(cls, value: object, source: str) -> str:
        """Return plain data as JSON text, in which a number that is a text stays one.

        Raises:
            DataError: With pydantic's faults of what has no JSON, or else that it has none.
        """
        try:
            return json.dumps(value, allow_nan=False, default=_as_plain)
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
        """Return a copy with some fields changed; what was cached of the fields is not copied."""
        copied = super().model_copy(update=update, deep=deep)
        for name in copied.__dict__.keys() - type(self).model_fields.keys():
            del copied.__dict__[name]
        return copied

    def to_json(self) -> str:
        """Return the canonical JSON text: sorted keys, no spaces, and the same bytes for equal values."""
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


def _is_empty(value: object) -> bool:
    return value is None or value is False or (isinstance(value, Sized) and not len(value))


def _as_plain(value: object) -> Any:
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json")
    raise TypeError(f"JSON has no {type(value).__name__}")


def canonical_json(value: Any) -> str:
    """Serialise plain data to the same text for equal values."""
    return json.dumps(
        value, ensure_ascii=False, sort_keys=True, separators=(",", ":"), allow_nan=False
    )


def digest(value: Any) -> str:
    """Return the SHA-256 of plain data in canonical JSON."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()


class IssuesError(ValueError):
    """Raised by validators that check a value as a whole and can find several faults at once."""

    def __init__(self, issues: Sequence[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("; ".join(map(str, issues)))


def same_length(**lengths: int) -> None:
    """Refuse fields that belong together if their lengths differ.

    Raises:
        ValueError: With the length of each.
    """
    if len({*lengths.values()}) > 1:
        told = ", ".join(f"{length} in {name}" for name, length in lengths.items())
        raise ValueError(f"lengths differ: {told}")


def issues_of(error: ValidationError) -> list[Issue]:
    """Convert pydantic's errors into issues with paths such as `actors[2].placement.lane`."""
    issues = []
    found = error.errors(include_url=False, include_input=False)
    long: dict[str, None] = {}
    for item in found:
        if (whole := _overlong(item["loc"])) is not None:
            long[dotted(whole)] = None
            continue
        inside = (one["loc"][: len(item["loc"])] == item["loc"] != one["loc"] for one in found)
        if item["type"] == "too_short" and any(inside):
            continue  # Faulty elements are named, and pydantic does not count them.
        path = dotted(item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, IssuesError):
            issues += below(path, cause.issues)
        else:
            issues.append(Issue(path, item["msg"].removeprefix("Value error, ")))
    for path in long:
        issues = [issue for issue in issues if not issue.path.startswith(f"{path}[")]
        issues.append(Issue(path, f"at most {MOST_PARTS} parts are allowed"))
    return issues


def _overlong(location: tuple[str | int, ...]) -> tuple[str | int, ...] | None:
    """Return the list of parts in which a fault lies beyond the last that is allowed.

    pydantic counts the sound elements of a list only, so it would tell thousands of faults, and not that there are
    too many.
    """
    for k in range(1, len(location)):
        one, index = location[k - 1], location[k]
        is_details = k > 1 and location[k - 2] == "details"
        is_part = one in ("parts", "otherwise") and not is_details
        if is_part and isinstance(index, int) and index >= MOST_PARTS:
            return location[:k]
    return None


def below(path: str, issues: Iterable[Issue]) -> list[Issue]:
    """Return the issues of a part as issues of the whole, in which the part has a path."""
    found = []
    for issue in issues:
        joint = "." if path and issue.path and not issue.path.startswith("[") else ""
        found.append(Issue(f"{path}{joint}{issue.path}", issue.message))
    return found


def _brief(name: str) -> str:
    return name if len(name) <= _MAX_NAME else f"{name[:_MAX_NAME]}..."


def dotted(location: Iterable[str | int]) -> str:
    """Return a location as an indexing expression, e.g. `actors[2].placement.lane`."""
    text = ""
    for part in location:
        # A key that nobody knows may be as long as its writer likes.
        text += f"[{part}]" if isinstance(part, int) else f".{_brief(part)}"
    return text.removeprefix(".")

"""The promises of every kind of component: what it must have, and what becomes of it when it raises."""

import inspect
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from oodscen._numbers import finite_number
from oodscen._redaction import redact
from oodscen._text import one_line, plain, whole
from oodscen.errors import EncoderError, LLMError, OodscenError, SimulatorCrash, UsageError

_MOST_SAID = 500


class _Promise(NamedTuple):
    """What an object of a kind must have."""

    values: tuple[str, ...]
    methods: tuple[str, ...]


_PROMISES = {
    "llm": _Promise(("name",), ("complete",)),
    "encoder": _Promise(("name", "dimension"), ("encode",)),
    "simulator": _Promise(
        ("name", "dt"),
        ("catalogue", "reset", "step", "render", "observe", "close", "__enter__", "__exit__"),
    ),
    "driver": _Promise((), ("act",)),
}


def conforming(kind: str, made: Any, label: str = "") -> Any:
    """Return a component if it is what `oodscen.protocols` asks of its kind.

    What may be costly to know, such as an encoder's dimension, must be there and is not read.

    Args:
        kind: `llm`, `encoder`, `simulator` or `driver`.
        made: The component.
        label: What the caller called it; its class if left out.

    Raises:
        UsageError: With everything that is missing or of another type.
        OodscenError: Of another kind where its name cannot be told for a reason of its own.
    """
    called = f"the {kind} {label!r}" if label else f"this {kind}, {described(made)},"
    if isinstance(made, type):
        raise UsageError(f"{called} is the class {made.__name__}: pass an object of it")
    faults = [f"has no {', '.join(missing)}"] if (missing := _missing(kind, made)) else []
    if not faults:
        faults = [fault for name in ("name", "dt") if (fault := _fault(kind, made, name))]
    if faults:
        told = f" (it is {described(made)})" if label else ""
        raise UsageError(f"{called} {' and '.join(faults)}{told}")
    return made


def _missing(kind: str, made: Any) -> list[str]:
    values, methods = _PROMISES[kind]
    missing = [name for name in values if not _is_there(made, name)]
    return missing + [f"{name}()" for name in methods if not callable(_read(made, name, None))]


def _is_there(made: Any, name: str) -> bool:
    """Tell whether there is an attribute; a property is not read, since it may load a model."""
    absent = object()
    if inspect.getattr_static(made, name, absent) is not absent:
        return True
    return _read(made, name, absent) is not absent


def _read(made: Any, name: str, absent: object) -> Any:
    """Return an attribute; one that cannot be read counts as absent."""
    try:
        return getattr(made, name, absent)
    except Exception:
        return absent


def _fault(kind: str, made: Any, name: str) -> str:
    """Say what is wrong with a value that every component of a kind must have, or nothing."""
    if name not in _PROMISES[kind].values:
        return ""
    try:
        value = getattr(made, name)
    except OodscenError:
        raise
    except Exception as error:
        return f"cannot tell its {name}: {reason(error)}"
    if name == "name":
        if not isinstance(value, str):
            return f"has a name that is {described(value)}, not a text"
        return "" if value.strip() and whole(value) == value else f"has the unusable name {value!r}"
    with suppress(UsageError):
        if finite_number(name, value) > 0:
            return ""
    return f"has a {name} of {value!r:.40}, not of a number above 0"


def described(value: object) -> str:
    """Say of what type a value is, for an error message."""
    return "None" if value is None else f"of type {type(value).__name__}"


@contextmanager
def working(kind: str, label: str) -> Iterator[None]:
    """Turn whatever a component raises while it works into the error of its kind.

    Raises:
        OodscenError: As it came; else an `LLMError`, `EncoderError` or `SimulatorCrash`, or a
            `UsageError` for other kinds.
    """
    try:
        yield
    except OodscenError:
        raise
    except (Exception, SystemExit) as error:
        raise _broken(kind, label, error) from error


def _broken(kind: str, label: str, error: BaseException) -> OodscenError:
    if kind == "simulator":
        return SimulatorCrash(label, reason(error))
    if kind == "encoder":
        return EncoderError(f"the encoder {label!r} broke down: {reason(error)}")
    if kind == "llm":
        is_retryable = isinstance(error, TimeoutError | ConnectionError)
        words = f"{label} broke down: {reason(error)}"
        return LLMError(words, model=label, retryable=is_retryable)
    return UsageError(f"the {kind} {label!r} broke down: {reason(error)}")


def reason(error: BaseException) -> str:
    """Return the type and the words of a foreign exception, in one line."""
    try:
        # Before it is cut: half a key is no key that could be found.
        said = one_line(plain(redact(str(error))))[:_MOST_SAID]
    except Exception:
        said = ""
    return f"{type(error).__name__}: {said}" if said else type(error).__name__

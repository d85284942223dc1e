"""The required members of each kind of component, and the error type that its exceptions become."""

import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from oodscen._numbers import finite_number
from oodscen._words.redaction import redact_start
from oodscen._words.text import is_name, one_line, printable, whole
from oodscen.data._catalogue import Catalogue
from oodscen.errors import (
    DataError,
    EncoderError,
    LLMError,
    LLMTimeout,
    MissingExtra,
    OodscenError,
    SceneError,
    SimulatorCrash,
    SimulatorError,
    UsageError,
)

if TYPE_CHECKING:
    from oodscen.protocols import Simulator

SHORTEST_DT, LONGEST_DT = 0.001, 0.1
"""Limits of a simulator's step, s. In a longer one, a body could pass through another unseen."""

_LONGEST_MESSAGE = 500
"""Characters of a foreign message that are shown."""
_LONGEST_READ = 200_000
"""Number of characters of a foreign exception's message beyond which the rest is left out, as redacting takes time."""
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")
"""A place in memory, which differs from run to run."""
_FROM_CALLER = "_oodscen_is_of_the_caller"
"""Attribute of exceptions that no component raised."""
_CANCELLING = ("asyncio", "trio", "_pytest")
"""Packages whose exceptions outside `Exception` cancel work from outside."""


class _Promise(NamedTuple):
    """A member that every component of a kind must have."""

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


def conforming(kind: str, component: Any, label: str = "") -> Any:
    """Return the component if it satisfies the protocol of its kind in `oodscen.protocols`.

    Members that may be costly to compute, such as an encoder's dimension, must exist but are not read.

    Args:
        kind: `llm`, `encoder`, `simulator` or `driver`.
        component: The component.
        label: The name that the caller used; the component's class name by default.

    Raises:
        UsageError: Lists every member that is missing or has the wrong type.
        OodscenError: Any other kind, if reading the component's name raises it.
    """
    subject = f"the {kind} {label!r}" if label else f"this {kind}, {described(component)},"
    if isinstance(component, type):
        raise UsageError(f"{subject} is the class {component.__name__}: pass an object of it")
    faults = [f"has no {', '.join(missing)}"] if (missing := _missing(kind, component)) else []
    if not faults:
        faults = [fault for name in ("name", "dt") if (fault := _fault(kind, component, name))]
    if faults:
        actual = f" (it is {described(component)})" if label else ""
        raise UsageError(f"{subject} {' and '.join(faults)}{actual}")
    return component


def _missing(kind: str, component: Any) -> list[str]:
    missing = [name for name in _PROMISES[kind].values if not _is_there(component, name)]
    return missing + missing_methods(kind, component)


def missing_methods(kind: str, component: Any) -> list[str]:
    """Return the methods that a component, or the class of one, should have and has not."""
    methods = _PROMISES[kind].methods if kind in _PROMISES else ()
    return [f"{name}()" for name in methods if not callable(optional(component, name, None))]


def _is_there(component: Any, name: str) -> bool:
    """Return whether the attribute exists. Properties are not read, since they may load a model."""
    absent = object()
    if inspect.getattr_static(component, name, absent) is not absent:
        return True
    return optional(component, name, absent) is not absent


def optional(component: Any, name: str, absent: object) -> Any:
    """Return an attribute that a component need not have, or `absent` if there is none or it cannot be read."""
    try:
        return getattr(component, name, absent)
    except BaseException as error:
        if is_interruption(error):
            raise
        return absent


def _fault(kind: str, component: Any, name: str) -> str:
    """Return the fault of a required member, or an empty string."""
    if name not in _PROMISES[kind].values:
        return ""
    try:
        value = getattr(component, name)
    except OodscenError:
        raise
    except BaseException as error:
        if is_interruption(error):
            raise
        return f"cannot tell its {name}: {reason(error)}"
    if name == "name":
        if not isinstance(value, str):
            return f"has a name that is {described(value)}, not a text"
        return "" if is_name(value) else f"has the unusable name {value[:100]!r}"
    with suppress(UsageError):
        finite_number(name, value, SHORTEST_DT, LONGEST_DT)
        return ""
    return (
        f"has a {name} of {value!r:.40}, not of a number from {SHORTEST_DT:g} to {LONGEST_DT:g} s"
    )


def as_catalogue(catalogue: object, name: str) -> Catalogue:
    """Return the catalogue that a simulator of this name told.

    Raises:
        UsageError: If it is something else.
        DataError: If it is a copy (`model_copy`) with values that no catalogue can have.
    """
    if not isinstance(catalogue, Catalogue):
        raise UsageError(f"the catalogue of {name!r} is {described(catalogue)}, not a Catalogue")
    if _CHECKED.get(id(catalogue)) is not catalogue:
        Catalogue.parse(catalogue.model_dump(warnings=False), source=name)
        if len(_CHECKED) >= _MOST_CHECKED:
            _CHECKED.clear()
        _CHECKED[id(catalogue)] = catalogue
    return catalogue


_CHECKED: dict[int, Catalogue] = {}
"""Catalogues found without a fault, by identity: a simulator shows one for every scene."""
_MOST_CHECKED = 16


def described(value: object) -> str:
    """Return the type of a value in words, for an error message."""
    return "None" if value is None else f"of type {type(value).__name__}"


@contextmanager
def working(kind: str, label: str) -> Iterator[None]:
    """Turn any exception that a component raises into the error type of its kind.

    Raises:
        OodscenError: Passed through unchanged, except for a model's own malformed data, and for all but
            `SceneError`, `SimulatorError` and `MissingExtra` of a simulator. Any other exception becomes an
            `LLMError`, `EncoderError` or `SimulatorCrash`, or a `UsageError` for other kinds, except for what
            `of_the_caller` lets pass.
    """
    try:
        yield
    except BaseException as error:
        if is_interruption(error) or getattr(error, _FROM_CALLER, False) or _is_told(kind, error):
            raise
        raise _broken(kind, label, error) from error


def _is_told(kind: str, error: BaseException) -> bool:
    """Return whether an error says as it is what a component of this kind could not do."""
    if kind == "simulator":
        return isinstance(error, SceneError | SimulatorError | MissingExtra)
    is_malformed = kind == "llm" and isinstance(error, DataError)
    return isinstance(error, OodscenError) and not is_malformed


@contextmanager
def of_the_caller() -> Iterator[None]:
    """Let what a function of the caller's raises pass through the components around it as it is."""
    try:
        yield
    except BaseException as error:
        setattr(error, _FROM_CALLER, True)
        raise


def is_interruption(error: BaseException) -> bool:
    """Return whether an exception ends the program's work rather than a component's.

    A component may raise anything, `SystemExit` and exceptions outside `Exception` included. Cancelled tasks,
    and the outcomes by which pytest ends a test, must pass.
    """
    if isinstance(error, Exception | SystemExit | GeneratorExit):
        return False
    module = type(error).__module__.partition(".")[0]
    return isinstance(error, KeyboardInterrupt) or module in _CANCELLING


@contextmanager
def using(simulator: "Simulator") -> Iterator["Simulator"]:
    """Close a simulator at the end; what its `close` raises costs none of the work that is done."""
    try:
        yield simulator
    finally:
        close(simulator)


def close(simulator: "Simulator") -> None:
    """Close a simulator, whatever it raises."""
    try:
        simulator.close()
    except BaseException as error:
        if is_interruption(error):
            raise


def _broken(kind: str, label: str, error: BaseException) -> OodscenError:
    if kind == "simulator":
        return SimulatorCrash(label, reason(error))
    if kind == "encoder":
        return EncoderError(f"the encoder {label!r} failed: {reason(error)}")
    if kind == "llm":
        words, is_late = f"{label} failed: {reason(error)}", isinstance(error, TimeoutError)
        is_retryable = is_late or isinstance(error, ConnectionError)
        error_type = LLMTimeout if is_late else LLMError
        return error_type(words, model=label, retryable=is_retryable)
    return UsageError(f"the {kind} {label!r} failed: {reason(error)}")


def message(error: BaseException) -> str:
    """Return the redacted message of a foreign exception as text that a file can hold; it may have none."""
    try:
        return _ADDRESS.sub("", whole(redact_start(str(error), _LONGEST_READ)))
    except Exception:
        return ""


def reason(error: BaseException) -> str:
    """Return the type and message of a foreign exception on one line."""
    # Redact before truncating: a truncated key would no longer be recognised.
    words = one_line(printable(message(error)))[:_LONGEST_MESSAGE]
    return f"{type(error).__name__}: {words}" if words else type(error).__name__

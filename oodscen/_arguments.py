"""Checks of arguments, at the public functions."""

import os
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cache, wraps
from inspect import Signature, signature
from numbers import Real
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    ParamSpec,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from oodscen._members import conforming
from oodscen._numbers import plain_number, said
from oodscen._words.redaction import redact
from oodscen.errors import UnknownComponent, UsageError

if TYPE_CHECKING:
    from oodscen.data._scene import Scene
    from oodscen.protocols import State

_COMPONENTS = {"LLM": "llm", "Encoder": "encoder", "Simulator": "simulator", "Driver": "driver"}
"""The protocols of components, by name."""
_TAKEN: Mapping[Any, Any] = {None: NoneType, int: Real, float: Real, Path: os.PathLike}
"""The types of what is taken for annotations that are no types, or narrower ones."""

P = ParamSpec("P")
Returned = TypeVar("Returned")


def instance_of(name: str, value: Any, *kinds: type) -> None:
    """Do nothing if an argument is of one of some types.

    Raises:
        UsageError: If it is not; the message names the argument and the types.
    """
    if not isinstance(value, kinds):
        raise UsageError(f"{name} must be {_any_of(kinds)}, not {said(value, 80)}")


def instances_of(name: str, values: Any, *kinds: type) -> None:
    """Do nothing if an argument is a collection whose elements are of one of some types.

    Raises:
        UsageError: If it is not.
    """
    if not _is_many(values, Collection):
        raise UsageError(f"{name} must be a list, not {said(values, 80)}")
    for value in values:
        instance_of(f"each element of {name}", value, *kinds)


def state_of(scene: "Scene", state: "State") -> None:
    """Do nothing if a state has the bodies of a scene.

    Raises:
        UsageError: If it is the state of another scene.
    """
    wanted = ("ego", *(actor.id for actor in scene.actors))
    if tuple(state.ids) != wanted:
        raise UsageError(
            f"state must be one of the scene {scene.id!r}, with the bodies {', '.join(wanted)}, not "
            f"{', '.join(state.ids)}"
        )


def refuse_key(name: str, value: str) -> None:
    """Refuse a value that is to be written into a file, if it holds what looks like a credential.

    Raises:
        UsageError: If it does.
    """
    if redact(value) != value:
        raise UsageError(
            f"{name}: {redact(value)} holds what looks like a key, and would be written into a file; keys belong into "
            "environment variables"
        )


def checked(function: Callable[P, Returned]) -> Callable[P, Returned]:
    """Return a public function that refuses arguments of kinds that its annotations do not allow.

    Components must have the members of their protocol. The range of numbers is left to the function
    (`oodscen._numbers`), and so are annotations that are strings. Numbers of other libraries become Python's, since
    a small integer of numpy overflows in silence. Nothing else is converted, and nothing is consumed: the elements
    of iterators are not checked.

    Raises:
        UnknownComponent: By the returned function, for an unknown word where words are listed.
        UsageError: By the returned function, for any other kind; the message names the argument.
    """

    @cache
    def form() -> tuple[Signature, dict[str, tuple[Any, str]]]:
        known = signature(function)
        kinds = {
            name: Real if _is_number(parameter.annotation) else parameter.annotation
            for name, parameter in known.parameters.items()
            if parameter.kind not in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
            and parameter.annotation is not parameter.empty
        }
        return known, {name: (kind, _component(kind)) for name, kind in kinds.items()}

    @wraps(function)
    def call(*args: P.args, **named: P.kwargs) -> Returned:
        known, kinds = form()
        try:
            bound = known.bind(*args, **named)
        except TypeError:
            return function(*args, **named)  # Python's own message names the function.
        for name, value in bound.arguments.items():
            kind, component = kinds.get(name, (Any, ""))
            if kind is Real:
                bound.arguments[name] = plain_number(value)
            elif not _fits(value, kind):
                raise _refusal(name, value, kind)
            if component and value is not None:
                conforming(component, value)
        return function(*bound.args, **bound.kwargs)

    return call


def _alternatives(kind: Any) -> tuple[Any, ...]:
    """Return the kinds that an annotation allows."""
    if get_origin(kind) in (Union, UnionType):
        return tuple(alternative for part in get_args(kind) for alternative in _alternatives(part))
    return _alternatives(get_args(kind)[0]) if get_origin(kind) is Annotated else (kind,)


def _is_number(kind: Any) -> bool:
    return not {int, float}.isdisjoint(
        alternative for alternative in _alternatives(kind) if isinstance(alternative, type)
    )


def _fits(value: Any, kind: Any) -> bool:
    """Return whether a value is of a kind, or the kind cannot be told."""
    if type(value) is kind:
        return True  # As nearly all elements of lists are, without a look into the annotation.
    return any(_is_of(value, alternative) for alternative in _alternatives(kind))


def _is_of(value: Any, kind: Any) -> bool:
    origin = get_origin(kind)
    if origin is Literal:
        return isinstance(value, str) and value in get_args(kind)
    if origin is Callable:
        return callable(value)
    generic = getattr(kind, "__pydantic_generic_metadata__", None) or {}
    plain = origin or generic.get("origin") or kind
    plain = _TAKEN.get(plain, plain)
    if plain is Any or not isinstance(plain, type):
        return True
    if getattr(plain, "_is_protocol", False) and plain.__module__ == "oodscen.protocols":
        return value is not None  # What it lacks is told by `conforming`.
    if issubclass(plain, Mapping):
        return isinstance(value, Mapping) and not _misfit(value, kind)
    if issubclass(plain, Iterable) and origin is not None and plain.__module__ != "numpy":
        wanted = Collection if issubclass(plain, Collection) else Iterable
        return _is_many(value, wanted) and not _misfit(value, kind)
    return isinstance(value, plain)


def _is_many(value: Any, kind: type) -> bool:
    """Return whether a value of a kind holds elements; an empty array, which is neither true nor false, does not."""
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, kind):
        return False
    shape = getattr(value, "shape", None)
    return shape is None or (len(shape) > 0 and shape[0] > 0)


def _component(kind: Any) -> str:
    """Return the kind of component that an annotation asks for, or nothing."""
    alternatives = [part for part in _alternatives(kind) if part is not NoneType]
    name = getattr(alternatives[0], "__qualname__", "") if len(alternatives) == 1 else ""
    return _COMPONENTS.get(name, "")


def _misfit(value: Any, kind: Any) -> tuple[Any, Any] | None:
    """Return the first element, key or value of another kind, and the kind that it should be."""
    parts = get_args(kind)
    if isinstance(value, Mapping) and len(parts) == 2:
        pairs = (
            (one, part) for pair in value.items() for one, part in zip(pair, parts, strict=True)
        )
    elif isinstance(value, Collection) and (len(parts) == 1 or parts[1:] == (Ellipsis,)):
        pairs = ((one, parts[0]) for one in value)
    else:
        return None
    return next(((one, part) for one, part in pairs if not _fits(one, part)), None)


def _refusal(name: str, value: Any, kind: Any) -> UsageError:
    """Return the error for an argument of another kind."""
    words = [
        one for part in _alternatives(kind) if get_origin(part) is Literal for one in get_args(part)
    ]
    if words and isinstance(value, str):
        return UnknownComponent(name, value[:80], words)
    for part in _alternatives(kind):
        origin = get_origin(part)
        is_listed = isinstance(origin, type) and issubclass(origin, Iterable)
        is_filled = isinstance(value, Mapping) or _is_many(value, Collection)
        if is_listed and is_filled and (found := _misfit(value, part)):
            return _refusal(f"{name}: every element", *found)
    return UsageError(f"{name} must be {_any_of(_alternatives(kind))}, not {said(value, 80)}")


def _any_of(kinds: Iterable[Any]) -> str:
    return " or ".join(dict.fromkeys(map(_worded, kinds)))


def _worded(kind: Any) -> str:
    origin = get_origin(kind)
    if origin is Literal:
        return "one of " + ", ".join(map(str, get_args(kind)))
    if origin is Callable:
        return "a function"
    if kind is None or kind is NoneType:
        return "None"
    name = getattr(origin or kind, "__name__", str(kind)).lstrip("_").partition("[")[0]
    plain = {"str": "text", "bool": "True or False", "Path": "a path", "Sequence": "a list"}
    return plain.get(name, f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}")

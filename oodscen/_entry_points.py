"""Registered components by name, and those that `module:attr` points to; nothing is made here."""

import importlib.util
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from importlib import metadata
from importlib.metadata import EntryPoint, EntryPoints
from typing import Any, cast

from oodscen._members import is_interruption, missing_methods, reason
from oodscen._words.redaction import redact_keys
from oodscen.errors import OodscenError, UnknownComponent, UsageError

KINDS = {
    "llm": "oodscen.llms",
    "encoder": "oodscen.encoders",
    "simulator": "oodscen.simulators",
    "catalogue": "oodscen.catalogues",
    "driver": "oodscen.drivers",
}
"""Entry-point group of each kind of component."""
DRIVERS = {
    "rule-based": "oodscen.driving._drivers.rule_based:RuleBasedDriver",
    "r157": "oodscen.driving._drivers.r157:R157Driver",
    "rss": "oodscen.driving._drivers.rss:RSSDriver",
}
"""The built-in reference drivers by name."""
DEFAULT_LLM = "builtin"

_OWN_PACKAGES = ("oodscen", "oodscen_pybullet", "oodscen_carla", "oodscen_highway", "oodscen_sumo")
_LONGEST = 4_096
"""Maximum length of a name, in characters; a path can be this long."""


def entry_points(group: str) -> EntryPoints:
    """Return the entry points of a group; installed packages are read again when one was added or removed."""
    folders: list[tuple[str, int]] = []
    for path in sys.path:
        with suppress(OSError, ValueError):
            folder = (path, os.stat(path or os.curdir).st_mtime_ns)
            if _holds_packages(*folder):
                folders.append(folder)
    return _installed(tuple(folders))[group]


@lru_cache(maxsize=256)
def _holds_packages(path: str, changed_ns: int) -> bool:
    """Return whether a folder with this time of change lists installed packages; an archive may."""
    if os.path.isfile(path):
        return True
    listed = (name.lower() for name in os.listdir(path or os.curdir))
    return any(name.endswith(("dist-info", "egg-info")) for name in listed)


@lru_cache(maxsize=1)
def _installed(folders: tuple[tuple[str, int], ...]) -> dict[str, EntryPoints]:
    """Return the entry points of packages in folders with these times of change, by group."""
    points = cast(EntryPoints, metadata.entry_points())  # mypy reads the signature of Python 3.10.
    return {group: points.select(group=group) for group in KINDS.values()}


def names(kind: str) -> dict[str, EntryPoint]:
    """Return the registered entry points of a kind, by name; nothing is imported.

    A name of this library stays its own. Of other packages that share a name, `load_factory` takes neither.
    """
    return {name: points[0] for name, points in _registered(kind).items()}


def _registered(kind: str) -> dict[str, list[EntryPoint]]:
    """Return the different entry points of each name, those of this library first."""
    points = sorted(entry_points(group=KINDS[kind]), key=lambda point: (not _is_own(point), point))
    if kind == "driver":
        own = (EntryPoint(name, path, KINDS[kind]) for name, path in DRIVERS.items())
        points = [*own, *points]
    by_name: dict[str, dict[str, EntryPoint]] = {}
    for point in points:
        by_name.setdefault(point.name, {}).setdefault(point.value, point)
    return {name: list(same_name.values()) for name, same_name in sorted(by_name.items())}


def _is_own(point: EntryPoint) -> bool:
    """Return whether an entry point is one of this library and its adapters."""
    return point.module.partition(".")[0] in _OWN_PACKAGES


def load_factory(kind: str, name: str) -> Callable[..., Any]:
    """Return the factory registered under a name, or the one that `module:attr` points to.

    Raises:
        UnknownComponent: With close matches.
        UsageError: If the component exists but cannot be imported or called.
    """
    refuse_unusable(kind, name)
    registered = _registered(kind)
    if name in registered:
        point, *others = registered[name]
        if others and not _is_own(point):
            raise UsageError(
                f"{len(others) + 1} packages call a {kind} {name!r}: "
                f"{', '.join(same.value for same in (point, *others))}; name the one that is meant in this form"
            )
    elif is_reference(name):
        point = EntryPoint(name, name, KINDS[kind])
    elif reads_as_reference(name):
        raise no_module(kind, name)
    else:
        raise UnknownComponent(kind, name, registered)
    try:
        factory = point.load()
    except OodscenError:
        raise
    except BaseException as error:
        if is_interruption(error):
            raise
        raise UsageError(
            f"the {kind} {name!r} ({point.value}) cannot be imported: {reason(error)}"
        ) from error
    if not callable(factory):
        raise UsageError(f"the {kind} {name!r} ({point.value}) is neither a class nor a function")
    return cast(Callable[..., Any], factory)


def no_module(kind: str, name: str) -> UsageError:
    """Return the error for a `module:attr` whose module does not exist."""
    module = name.partition(":")[0]
    return UsageError(
        f"the {kind} {name!r} cannot be imported: there is no module {module!r}; is its folder on PYTHONPATH?"
    )


def reads_as_reference(name: str) -> bool:
    """Return whether a name has the form `module:attr`."""
    module, colon, attribute = name.partition(":")
    return bool(colon) and all(part.isidentifier() for part in f"{module}.{attribute}".split("."))


def is_reference(name: str) -> bool:
    """Return whether a name has the form `module:attr` and its module exists."""
    if not reads_as_reference(name):
        return False
    module = name.partition(":")[0]
    try:
        return module in sys.modules or importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False
    except BaseException as error:
        if is_interruption(error):
            raise
        return True  # The module exists, but a package around it fails: importing it will show how.


def refuse_unusable(kind: str, name: str) -> None:
    """Raise an error for a name that `name_fault` objects to."""
    if fault := name_fault(kind, name):
        raise UsageError(fault)


def name_fault(kind: str, name: str) -> str:
    """Return why nothing may have a name, or "": an endless one takes long to compare, and a key would be kept."""
    if len(name) > _LONGEST:
        return f"no {kind} has a name of {len(name):,} characters: {name[:40]!r} ..."
    if kind in ("llm", "encoder") and (redacted := redact_keys(name)) != name:
        return (
            f"the name of the {kind}, {redacted!r}, holds a key that the environment holds too, and would be kept in "
            "files; give a model's name here, and the key in the environment alone"
        )
    return ""


def survey() -> list[dict[str, str]]:
    """List every registered component and whether it loads; the fault of a broken one is its state."""
    return [
        {"kind": kind, "name": name, "source": point.value, "state": _state(kind, point, points)}
        for kind in KINDS
        for name, points in _registered(kind).items()
        for point in points
    ]


def _state(kind: str, point: EntryPoint, same_name: list[EntryPoint]) -> str:
    """Return "ok", or why a registered component cannot be used by its name."""
    first = same_name[0]
    if point is not first and _is_own(first):
        return f"not used: the name is that of {first.value}"
    try:
        factory = load_factory(kind, point.name)
    except OodscenError as error:
        return str(error)
    missing = missing_methods(kind, factory) if isinstance(factory, type) else []
    return f"has no {', '.join(missing)}" if missing else "ok"


def is_builtin(name: str) -> bool:
    """Return whether a model name means the built-in author, with or without the user's own knowledge."""
    return name.partition(":")[0] == DEFAULT_LLM


def is_asked(name: str) -> bool:
    """Return whether a name belongs to an external model, which is asked for its answers."""
    return not is_builtin(name) and name.partition(":")[0] not in ("constant", "random", "replay")

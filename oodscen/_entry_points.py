"""Registered components by name, and those that `module:attr` points to; nothing is made here."""

import importlib.util
import os
import sys
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from importlib import metadata
from importlib.metadata import EntryPoint, EntryPoints
from typing import Any, cast

from oodscen._members import is_interruption, reason
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
    return _installed(tuple(folders)).select(group=group)


@lru_cache(maxsize=256)
def _holds_packages(path: str, changed_ns: int) -> bool:
    """Return whether a folder with this time of change lists installed packages; an archive may."""
    if os.path.isfile(path):
        return True
    listed = (name.lower() for name in os.listdir(path or os.curdir))
    return any(name.endswith(("dist-info", "egg-info")) for name in listed)


@lru_cache(maxsize=1)
def _installed(folders: tuple[tuple[str, int], ...]) -> EntryPoints:
    """Return all entry points of packages in folders with these times of change."""
    return cast(EntryPoints, metadata.entry_points())  # mypy reads the signature of Python 3.10.


def names(kind: str) -> dict[str, EntryPoint]:
    """Return the registered entry points of a kind, by name; nothing is imported."""
    points = {point.name: point for point in sorted(entry_points(group=KINDS[kind]))}
    if kind == "driver":
        points |= {name: EntryPoint(name, path, KINDS[kind]) for name, path in DRIVERS.items()}
    return points


def load_factory(kind: str, name: str) -> Callable[..., Any]:
    """Return the factory registered under a name, or the one that `module:attr` points to.

    Raises:
        UnknownComponent: With close matches.
        UsageError: If the component exists but cannot be imported or called.
    """
    refuse_long(kind, name)
    registered = names(kind)
    if name in registered:
        point = registered[name]
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


def refuse_long(kind: str, name: str) -> None:
    """Raise an error for an endless name, which would take long to compare with the known ones."""
    if len(name) > _LONGEST:
        raise UsageError(f"no {kind} has a name of {len(name):,} characters: {name[:40]!r} ...")


def survey() -> list[dict[str, str]]:
    """List every registered component and whether it loads; a broken one only causes a warning."""
    rows = []
    for kind in KINDS:
        for name, point in names(kind).items():
            try:
                load_factory(kind, name)
                state = "ok"
            except OodscenError as error:
                state = str(error)
                warnings.warn(
                    f"the {kind} {name!r} is broken: {error}", RuntimeWarning, stacklevel=2
                )
            rows.append({"kind": kind, "name": name, "source": point.value, "state": state})
    return rows

"""Find implementations by name: entry points, `module:attr`, or an object as it is."""

import importlib
import warnings
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from typing import Any, cast

from oodscen.errors import OodscenError, UnknownComponent, UsageError
from oodscen.protocols import LLM, Encoder, Simulator

KINDS = {
    "llm": "oodscen.llms",
    "encoder": "oodscen.encoders",
    "simulator": "oodscen.simulators",
}
"""Entry-point group by kind of component."""

DEFAULT_SIMULATOR = "pybullet"
DEFAULT_ENCODER = "minilm"
DEFAULT_LLM = "builtin"


def names(kind: str) -> dict[str, EntryPoint]:
    """Return what is registered for a kind, by name; nothing is imported."""
    return {point.name: point for point in sorted(entry_points(group=KINDS[kind]))}


def find(kind: str, name: str) -> Callable[..., Any]:
    """Return the factory that is registered under a name, or that `module:attr` points to.

    Raises:
        UnknownComponent: With close matches.
        UsageError: When the component exists but cannot be imported.
    """
    registered = names(kind)
    if name in registered:
        point = registered[name]
    elif ":" in name and not name.startswith(":"):
        point = EntryPoint(name, name, KINDS[kind])
    else:
        raise UnknownComponent(kind, name, registered)
    try:
        return cast(Callable[..., Any], point.load())
    except OodscenError:
        raise
    except Exception as error:
        raise UsageError(
            f"the {kind} {name!r} ({point.value}) cannot be imported: {error}"
        ) from error


def make_simulator(simulator: str | Simulator) -> Simulator:
    """Return a simulator by name, or the given one."""
    if isinstance(simulator, str):
        return cast(Simulator, find("simulator", simulator)())
    return simulator


def make_encoder(encoder: str | Encoder) -> Encoder:
    """Return an encoder by name, or the given one.

    A name that is not registered but is an existing folder is loaded by sentence-transformers.
    """
    if isinstance(encoder, str):
        return cast(Encoder, find("encoder", encoder)())
    return encoder


def make_llm(llm: str | LLM, *, seed: int = 0, api_base: str | None = None) -> LLM:
    """Return a language model by name, or the given one.

    A registered name may carry an argument after a colon (`constant:stop`). Every other name is
    passed to litellm when it names a provider or a known model (`gpt-4o`, `ollama/llama3`,
    `claude-...`), or when `api_base` is given.

    Raises:
        UnknownComponent: When nobody knows the name.
    """
    if not isinstance(llm, str):
        return llm
    registered = names("llm")
    head, _, argument = llm.partition(":")
    if head in registered and head != "litellm":
        factory = find("llm", head)
        return cast(LLM, factory(argument, seed=seed) if argument else factory(seed=seed))
    if ":" in llm and "/" not in llm and head and importlib_knows(head):
        return cast(LLM, find("llm", llm)())
    client = find("llm", "litellm")
    return cast(LLM, client(llm.removeprefix("litellm:"), api_base=api_base, seed=seed))


def importlib_knows(module: str) -> bool:
    """Whether a module of this name could be imported."""
    try:
        return importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def survey() -> list[dict[str, str]]:
    """List every registered component and whether it can be loaded; a broken one only warns."""
    rows = []
    for kind in KINDS:
        for name, point in names(kind).items():
            try:
                find(kind, name)
                state = "ok"
            except OodscenError as error:
                state = str(error)
                warnings.warn(
                    f"the {kind} {name!r} is broken: {error}", RuntimeWarning, stacklevel=2
                )
            rows.append({"kind": kind, "name": name, "source": point.value, "state": state})
    return rows

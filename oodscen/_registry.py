"""Find implementations by name: entry points, `module:attr`, or an object as it is."""

import importlib.util
import inspect
import sys
import warnings
from collections.abc import Callable
from contextlib import closing
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from oodscen._conformance import conforming, described, reason, working
from oodscen.errors import MissingExtra, OodscenError, UnknownComponent, UsageError, close_matches
from oodscen.protocols import LLM, Driver, Encoder, Simulator

if TYPE_CHECKING:
    from oodscen.data._catalogue import Catalogue
    from oodscen.llm._remote.limits import Traffic

KINDS = {
    "llm": "oodscen.llms",
    "encoder": "oodscen.encoders",
    "simulator": "oodscen.simulators",
    "catalogue": "oodscen.catalogues",
    "driver": "oodscen.drivers",
}
"""Entry-point group by kind of component."""

DEFAULT_SIMULATOR = "pybullet"
DEFAULT_CATALOGUES = ("carla-0.9.16",)
"""What a study shows beside its own simulator."""
DEFAULT_ENCODER = "minilm"
DEFAULT_LLM = "builtin"
_LONGEST = 4_096
"""Longest name, in characters: that of a path."""


def is_builtin(name: str) -> bool:
    """Whether a model's name stands for the built-in author, with or without own knowledge."""
    return name.partition(":")[0] == DEFAULT_LLM


def names(kind: str) -> dict[str, EntryPoint]:
    """Return what is registered for a kind, by name; nothing is imported."""
    return {point.name: point for point in sorted(entry_points(group=KINDS[kind]))}


def find(kind: str, name: str) -> Callable[..., Any]:
    """Return the factory that is registered under a name, or that `module:attr` points to.

    Raises:
        UnknownComponent: With close matches.
        UsageError: When the component exists but cannot be imported, or is not callable.
    """
    _refuse_long(kind, name)
    registered = names(kind)
    if name in registered:
        point = registered[name]
    elif _is_reference(name):
        point = EntryPoint(name, name, KINDS[kind])
    elif _reads_as_reference(name):
        module = name.partition(":")[0]
        raise UsageError(
            f"the {kind} {name!r} cannot be imported: there is no module {module!r}; "
            "is its folder on PYTHONPATH?"
        )
    else:
        raise UnknownComponent(kind, name, registered)
    try:
        factory = point.load()
    except OodscenError:
        raise
    except (Exception, SystemExit) as error:
        raise UsageError(
            f"the {kind} {name!r} ({point.value}) cannot be imported: {reason(error)}"
        ) from error
    if not callable(factory):
        raise UsageError(f"the {kind} {name!r} ({point.value}) is neither a class nor a function")
    return cast(Callable[..., Any], factory)


def make_simulator(simulator: str | Simulator) -> Simulator:
    """Return a simulator by name, or the given one.

    Raises:
        UsageError: When there is none of that name (with close matches), or it cannot be made.
    """
    if not isinstance(simulator, str):
        return cast(Simulator, conforming("simulator", simulator))
    made = cast(Simulator, conforming("simulator", _made("simulator", simulator), simulator))
    with working("simulator", simulator):
        catalogue = made.catalogue()
    _as_catalogue(catalogue, simulator)
    return made


def make_catalogue(catalogue: "str | Path | Catalogue") -> "Catalogue":
    """Return what a simulator can show: by name, from a JSON file, or the given catalogue.

    A registered catalogue is data and starts nothing (`pybullet`, `carla-0.9.16`). Any other name is
    taken for a simulator's, which is asked.

    Raises:
        UsageError: When there is neither such a catalogue nor such a simulator nor such a file.
        DataError: When the file holds no catalogue.
    """
    from oodscen.data._catalogue import Catalogue

    if isinstance(catalogue, Catalogue):
        return catalogue
    name = str(catalogue)
    if name not in names("catalogue"):
        if name.endswith(".json") or _is_there(name, Path.is_file):
            return Catalogue.load(name)
        if name not in names("simulator") and not _reads_as_reference(name):
            raise UnknownComponent("catalogue", name, {*names("catalogue"), *names("simulator")})
        simulator = make_simulator(name)
        with working("simulator", name), closing(simulator):
            return simulator.catalogue()
    return _as_catalogue(_made("catalogue", name), name)


def _as_catalogue(made: object, name: str) -> "Catalogue":
    from oodscen.data._catalogue import Catalogue

    if not isinstance(made, Catalogue):
        raise UsageError(f"the catalogue of {name!r} is {described(made)}, not a Catalogue")
    return made


def make_encoder(encoder: str | Encoder) -> Encoder:
    """Return an encoder by name, or the given one.

    A registered name may carry an argument after a colon (`sentence-transformers:NAME`). The path of an
    existing folder is loaded by sentence-transformers.

    Raises:
        UsageError: When there is none of that name (with close matches), or it cannot be made.
    """
    if not isinstance(encoder, str):
        return cast(Encoder, conforming("encoder", encoder))
    if encoder and encoder not in names("encoder") and _is_there(encoder, Path.is_dir):
        encoder = f"sentence-transformers:{encoder}"
    return cast(Encoder, conforming("encoder", _made("encoder", encoder), encoder))


def driver_maker(name: str) -> Callable[[], Driver]:
    """Return what makes drivers of this name; the first is made at once, to see whether it can be.

    Raises:
        UsageError: When there is none of that name (with close matches), or it cannot be made.
    """

    def made() -> Driver:
        return cast(Driver, conforming("driver", _made("driver", name), name))

    first = [made()]
    return lambda: first.pop() if first else made()


def make_llm(
    llm: str | LLM, *, seed: int = 0, api_base: str | None = None, traffic: "Traffic | None" = None
) -> LLM:
    """Return a language model by name, or the given one.

    A registered name may carry an argument after a colon (`constant:stop`, `replay:FILE`, `builtin:FILE`). Every other name is
    passed to litellm when it names a provider or a known model (`gpt-4o`, `ollama/llama3:8b`,
    `anthropic/claude-...`), or when `api_base` is given.

    Args:
        llm: A name, `module:attr`, or an object.
        seed: Of the run.
        api_base: Address of a server, for a model that litellm asks; the others need none.
        traffic: Caps, prices and endpoints of a run, for a model that litellm asks.

    Raises:
        UsageError: When nobody knows the name (with close matches), or it cannot be made.
    """
    if not isinstance(llm, str):
        return cast(LLM, conforming("llm", llm))
    _refuse_long("llm", llm)
    registered = names("llm")
    head = llm.partition(":")[0]
    if head != "litellm" and (head in registered or _is_reference(llm)):
        shared = {} if traffic is None else {"traffic": traffic}
        return cast(LLM, conforming("llm", _made("llm", llm, seed=seed, **shared), llm))
    client = find("llm", "litellm")
    model = llm.removeprefix("litellm:")
    try:
        return cast(LLM, client(model, api_base=api_base, seed=seed, traffic=traffic))
    except (UnknownComponent, MissingExtra) as error:
        known = error.known if isinstance(error, UnknownComponent) else ()
        if close_matches(llm, registered):
            raise UnknownComponent("llm", llm, [*registered, *known]) from None
        raise


def _made(kind: str, name: str, **settings: Any) -> Any:
    """Make a component by `name`, `name:argument` or `module:attr`, with the settings that it takes.

    What comes after the colon is the first argument, or the one that the factory's `argument` names.
    """
    head, colon, argument = name.partition(":")
    given = (argument,) if colon and head in names(kind) else ()
    factory = find(kind, head if given else name)
    if given and isinstance(parameter := getattr(factory, "argument", None), str):
        given, settings = (), {**settings, parameter: argument}
    try:
        signature = inspect.signature(factory)
    except (TypeError, ValueError):
        signature = None  # Some that are written in C tell none; calling them shows what they take.
    if signature is not None:
        takes_any = any(p.kind is p.VAR_KEYWORD for p in signature.parameters.values())
        settings = {k: v for k, v in settings.items() if takes_any or k in signature.parameters}
        try:
            signature.bind(*given, **settings)
        except TypeError as error:
            hint = "it takes no argument after the colon" if given else f"try {name}:ARGUMENT"
            raise UsageError(f"the {kind} {name!r} cannot be made: {error}; {hint}") from None
    try:
        return factory(*given, **settings)
    except OodscenError:
        raise
    except (Exception, SystemExit) as error:
        is_refused = given and isinstance(error, TypeError | ValueError)
        fault = f"{head!r} does not take {argument!r}" if is_refused else f"{name!r} cannot be made"
        raise UsageError(f"the {kind} {fault}: {reason(error)}") from error


def _refuse_long(kind: str, name: str) -> None:
    """Spare whoever compares names the time that endless ones take."""
    if len(name) > _LONGEST:
        raise UsageError(f"no {kind} has a name of {len(name):,} characters: {name[:40]!r} ...")


def _is_there(name: str, kind: Callable[[Path], bool]) -> bool:
    """Whether a name is that of a file or folder; one that no file can have is none."""
    try:
        return kind(Path(name))
    except (OSError, ValueError):
        return False


def _reads_as_reference(name: str) -> bool:
    """Whether a name reads as `module:attr`."""
    module, colon, attribute = name.partition(":")
    return bool(colon) and all(part.isidentifier() for part in f"{module}.{attribute}".split("."))


def _is_reference(name: str) -> bool:
    """Whether a name reads as `module:attr` and there is such a module."""
    if not _reads_as_reference(name):
        return False
    module = name.partition(":")[0]
    try:
        return module in sys.modules or importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False
    except (Exception, SystemExit):
        return True  # There is one, and a package around it breaks down: importing it says how.


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

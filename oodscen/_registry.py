"""Makes components by name: a registered one, `module:attr`, or an object passed through unchanged."""

import inspect
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from oodscen._arguments import checked
from oodscen._entry_points import (
    is_builtin,
    is_reference,
    load_factory,
    names,
    no_module,
    reads_as_reference,
    refuse_unusable,
)
from oodscen._members import as_catalogue, conforming, is_interruption, reason, using, working
from oodscen._numbers import seed_number
from oodscen.data._catalogue import Catalogue
from oodscen.data._episode import ACTIONS
from oodscen.errors import MissingExtra, OodscenError, UnknownComponent, UsageError, close_matches
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.protocols import LLM, Driver, Encoder, Simulator

if TYPE_CHECKING:
    from oodscen.llm._remote.limits import Limits

DEFAULT_SIMULATOR = "pybullet"
DEFAULT_CATALOGUES = ("carla-0.9.16",)
"""Catalogues that a study checks in addition to its own simulator's."""
DEFAULT_ENCODER = "minilm"


def make_simulator(simulator: str | Simulator) -> Simulator:
    """Return the simulator of this name, or the given one.

    Raises:
        UsageError: If there is no such simulator (with close matches), or it cannot be created.
    """
    if not isinstance(simulator, str):
        return cast(Simulator, conforming("simulator", simulator))
    created = cast(Simulator, conforming("simulator", _create("simulator", simulator), simulator))
    with working("simulator", simulator):
        catalogue = created.catalogue()
    as_catalogue(catalogue, simulator)
    return created


@checked
def make_catalogue(catalogue: str | Path | Catalogue) -> Catalogue:
    """Return a catalogue by name, from a JSON file, or the given one.

    A registered catalogue is plain data and starts nothing (`pybullet`, `carla-0.9.16`). Any other name is
    taken as a simulator's, and that simulator is asked for its catalogue.

    Raises:
        UsageError: If there is no catalogue, simulator or file of this name.
        DataError: If the file is not a catalogue.
    """
    if isinstance(catalogue, Catalogue):
        return catalogue
    name = str(catalogue)
    if name not in names("catalogue"):
        if name.endswith(".json") or _is_there(name, Path.is_file):
            return Catalogue.load(name)
        if name not in names("simulator") and not reads_as_reference(name):
            raise UnknownComponent("catalogue", name, {*names("catalogue"), *names("simulator")})
        simulator = make_simulator(name)
        with working("simulator", name), using(simulator):
            return simulator.catalogue()
    return as_catalogue(_create("catalogue", name), name)


@checked
def make_encoder(encoder: str | Encoder, *, cache: bool | str | Path = False) -> Encoder:
    """Return the encoder of this name, or the given one.

    A registered name may carry an argument after a colon (`sentence-transformers:NAME`). A path to an
    existing folder is loaded with sentence-transformers.

    Args:
        encoder: A name, `module:attr`, a path, or an object.
        cache: Encode each distinct text once: True keeps the vectors in memory, a folder also between
            processes.

    Raises:
        UsageError: If there is no such encoder (with close matches), or it cannot be created.
    """
    if isinstance(encoder, str):
        if encoder and encoder not in names("encoder") and _is_there(encoder, Path.is_dir):
            encoder = f"sentence-transformers:{encoder}"
        plain = cast(Encoder, conforming("encoder", _create("encoder", encoder), encoder))
    else:
        plain = cast(Encoder, conforming("encoder", encoder))
    if cache is False:
        return plain
    from oodscen.encoders._cached import CachedEncoder  # Late, because locks load slowly.

    return CachedEncoder(plain, None if cache is True else cache)


@checked
def make_driver(driver: str | Driver, **settings: Any) -> Driver:
    """Return a new driver of this name, or the given one.

    The reference drivers are `rule-based`, `r157` and `rss`. The id of a discrete action (`stop`) names a driver that
    executes it in the lane in which the ego started, and ignores other road users. Drivers remember what they saw:
    every drive needs a new one.

    Args:
        driver: A name, `module:attr` of what makes a driver, or an object.
        **settings: Further settings of a named driver: `reaction_s`, s, for which an action keeps lane and speed
            first; the assumptions of `rss`, e.g. `response_s=1.0`; the numbers of `rule-based`, e.g. `headway_s=2.0`.

    Raises:
        UsageError: If there is no such driver (with close matches), it does not have such a setting, or it cannot
            be created.
    """
    if not isinstance(driver, str):
        if settings:
            raise UsageError(f"a driver that exists takes no settings: {', '.join(settings)}")
        return cast(Driver, conforming("driver", driver))
    if driver in ACTIONS:
        from oodscen.driving._motion.actions import action_driver  # Late, because it loads slowly.

        _refuse_settings(driver, partial(action_driver, driver), settings)
        return action_driver(driver, **settings)
    try:
        _refuse_settings(driver, load_factory("driver", driver), settings)
    except UnknownComponent as error:
        if error.kind != "driver":
            raise
        raise UnknownComponent("driver", driver, [*error.known, *ACTIONS]) from None
    return cast(Driver, conforming("driver", _create("driver", driver, **settings), driver))


def driver_maker(name: str) -> Callable[[], Driver]:
    """Return a factory of drivers. The first driver is created at once, so that errors appear early.

    Raises:
        UsageError: If there is no such driver (with close matches), or it cannot be created.
    """
    first = [make_driver(name)]
    return lambda: first.pop() if first else make_driver(name)


@checked
def make_llm(
    llm: str | LLM,
    *,
    seed: int = 0,
    api_base: str | None = None,
    limits: "Limits | None" = None,
    log: Callable[[Call], None] | None = None,
    record: str | Path | None = None,
    **settings: Any,
) -> LLM:
    """Return the language model of this name, or the given one.

    A registered name may carry an argument after a colon (`constant:stop`, `replay:FILE`, `builtin:FILE`). Any
    other name goes to litellm if it names a provider or a known model (`gpt-4o`, `ollama/llama3:8b`,
    `anthropic/claude-...`), or if `api_base` is given.

    Args:
        llm: A name, `module:attr`, or an object.
        seed: The run's seed.
        api_base: The address of a server, for models behind litellm; other models ignore it.
        limits: The run's caps, prices and endpoints. The built-in author, reference answerers and recordings
            count for nothing.
        log: Called with every call of the model, failed ones included, never from two threads at a time. What it
            raises is no failure of the model, and ends the work.
        record: A file that records every answer; recorded questions are answered from it. See `replay:FILE`.
        **settings: Further settings of a named model, e.g. `temperature=0.7` for models behind litellm.

    Raises:
        UsageError: If there is no such model (with close matches), it does not have such a setting, or it
            cannot be created.
    """
    seed_number(seed)
    if isinstance(llm, str):
        model = _named_llm(llm, seed, api_base, limits, settings)
    elif settings:
        raise UsageError(f"a model that exists takes no settings: {', '.join(settings)}")
    else:
        model = cast(LLM, conforming("llm", llm))
    if limits is not None and not (isinstance(llm, str) and is_builtin(llm)):
        model = _capped(model, limits, llm if isinstance(llm, str) else "")
    if log is not None:
        model = LoggedLLM(model, log)
    if record is not None:
        from oodscen.llm._replay import RecordingLLM  # Late, because locks load slowly.

        model = RecordingLLM(model, record)
    return model


def _capped(llm: LLM, limits: "Limits", label: str) -> LLM:
    """Return a model that keeps to the limits; a client that has them counts its HTTP requests itself."""
    from oodscen.judging._references import is_reference  # Late, because they load slowly.
    from oodscen.llm._capped import CappedLLM
    from oodscen.llm._replay import ReplayLLM

    is_free = is_reference(llm) or isinstance(llm, ReplayLLM)
    return llm if is_free or hasattr(llm, "limits") else CappedLLM(llm, limits, label)


def _named_llm(
    llm: str, seed: int, api_base: str | None, limits: "Limits | None", settings: Mapping[str, Any]
) -> LLM:
    refuse_unusable("llm", llm)
    if not llm.strip():
        raise UsageError("the name of a model is empty")
    if not llm.isprintable():
        raise UsageError(f"the name of a model holds a control character: {llm[:80]!r}")
    registered = names("llm")
    head = llm.partition(":")[0]
    if head != "litellm" and (head in registered or is_reference(llm)):
        shared = {} if limits is None else {"limits": limits}
        _refuse_settings(llm, load_factory("llm", head if head in registered else llm), settings)
        return cast(
            LLM, conforming("llm", _create("llm", llm, seed=seed, **shared, **settings), llm)
        )
    client = load_factory("llm", "litellm")
    _refuse_settings(llm, client, settings)
    model = llm.removeprefix("litellm:")
    try:
        return cast(LLM, client(model, api_base=api_base, seed=seed, limits=limits, **settings))
    except (UnknownComponent, MissingExtra) as error:
        known = error.known if isinstance(error, UnknownComponent) else ()
        if close_matches(llm, registered):
            raise UnknownComponent("llm", llm, [*registered, *known]) from None
        if reads_as_reference(llm):
            raise no_module("llm", llm) from None
        raise


def _create(kind: str, name: str, **settings: Any) -> Any:
    """Create a component from `name`, `name:argument` or `module:attr`, with the settings that it accepts.

    The text after the colon becomes the first argument, or the one that the factory's `argument` attribute names.
    """
    refuse_unusable(kind, name)
    head, colon, argument = name.partition(":")
    arguments = (argument,) if colon and head in names(kind) else ()
    if arguments and not argument:
        raise UsageError(f"the {kind} {name!r} has nothing after its colon")
    factory = load_factory(kind, head if arguments else name)
    if arguments and isinstance(parameter := getattr(factory, "argument", None), str):
        arguments, settings = (), {**settings, parameter: argument}
    try:
        signature = inspect.signature(factory)
    except (TypeError, ValueError):
        signature = None  # Some C callables have no signature; calling them shows what they take.
    if signature is not None:
        takes_any = any(p.kind is p.VAR_KEYWORD for p in signature.parameters.values())
        settings = {k: v for k, v in settings.items() if takes_any or k in signature.parameters}
        try:
            signature.bind(*arguments, **settings)
        except TypeError as error:
            hint = "it is called without arguments"
            if arguments:
                hint = "it takes no argument after the colon"
            elif name in names(kind):
                hint = f"try {name}:ARGUMENT"
            raise UsageError(f"the {kind} {name!r} cannot be made: {error}; {hint}") from None
    try:
        with _same_folder():
            return factory(*arguments, **settings)
    except OodscenError:
        raise
    except BaseException as error:
        if is_interruption(error):
            raise
        is_refused = arguments and isinstance(error, TypeError | ValueError)
        fault = f"{head!r} does not take {argument!r}" if is_refused else f"{name!r} cannot be made"
        raise UsageError(f"the {kind} {fault}: {reason(error)}") from error


@contextmanager
def _same_folder() -> Iterator[None]:
    """Go back to the working folder at the end: paths that a user named are relative to it."""
    try:
        here = os.getcwd()
    except FileNotFoundError:
        yield
        return
    try:
        yield
    finally:
        with suppress(OSError):
            os.chdir(here)


def _refuse_settings(name: str, factory: Callable[..., Any], settings: Mapping[str, Any]) -> None:
    """Raise an error for settings that a model does not have."""
    if not settings:
        return
    known = inspect.signature(factory).parameters
    takes_any = any(parameter.kind is parameter.VAR_KEYWORD for parameter in known.values())
    unknown = [] if takes_any else [setting for setting in settings if setting not in known]
    if unknown:
        raise UnknownComponent(f"setting of {name}", unknown[0], known)


def _is_there(name: str, kind: Callable[[Path], bool]) -> bool:
    """Return whether a path exists and is of the given kind; False for text that cannot be a path."""
    try:
        return kind(Path(name))
    except (OSError, ValueError):
        return False

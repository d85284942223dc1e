"""Check that the parts of the default run are installed and work."""

import platform
import sys
from collections.abc import Callable
from typing import NamedTuple

from oodscen.errors import DataError, OodscenError


class Finding(NamedTuple):
    """One thing that was checked."""

    what: str
    is_ok: bool
    detail: str
    """A version, or what is wrong and how to mend it."""


def examine() -> list[Finding]:
    """Check Python, the built-in author, the encoder and the simulator."""
    return [
        Finding("python", sys.version_info >= (3, 11), platform.python_version()),
        _tried("built-in author", _author),
        _tried("encoder", _encoder),
        _tried("simulator", _simulator),
        _tried("language models", _litellm),
    ]


def examine_simulator(
    name: str, *, is_quick: bool = False, progress: Callable[[str, int, int], None] | None = None
) -> list[Finding]:
    """Judge one simulator by the conformance check; one finding per fault.

    Args:
        name: Registered, or `module:attr`.
        is_quick: Leave out the parts that take long.
        progress: Told about every part.

    Raises:
        UsageError: When there is no such simulator.
    """
    from oodscen.registry import make_simulator
    from oodscen.testing.check import PARTS, QUICK, check_simulator

    make_simulator(name).close()
    parts = QUICK if is_quick else PARTS
    told = progress or (lambda stage, done, total: None)
    try:
        check_simulator(
            name, parts=parts, progress=lambda part: told("check", parts.index(part), len(parts))
        )
    except AssertionError as error:
        faults = str(error).split("\n  - ")[1:]
        return [Finding(f"simulator {name}", False, fault) for fault in faults]
    told("check", len(parts), len(parts))
    return [Finding(f"simulator {name}", True, f"keeps the protocol ({', '.join(parts)})")]


def _tried(what: str, check: Callable[[], str]) -> Finding:
    try:
        return Finding(what, True, check())
    except OodscenError as error:
        return Finding(what, False, str(error))


def _author() -> str:
    from oodscen.llms.author import load_knowledge, validate_knowledge

    issues = validate_knowledge()
    if issues:
        raise DataError("knowledge base", issues)
    return f"{len(load_knowledge().hazards)} hazards"


def _encoder() -> str:
    from oodscen.registry import DEFAULT_ENCODER, make_encoder

    encoder = make_encoder(DEFAULT_ENCODER)
    shape = encoder.encode(["A car follows a van."]).shape
    return f"{encoder.name}, {shape[1]} dimensions"


def _simulator() -> str:
    from oodscen.protocols import Camera
    from oodscen.registry import DEFAULT_SIMULATOR, make_simulator
    from oodscen.testing.scenes import example_scene

    with make_simulator(DEFAULT_SIMULATOR) as simulator:
        simulator.reset(example_scene(), seed=0)
        spread = int(simulator.render(Camera(width=160, height=120)).rgb.std())
    if spread < 4:
        raise OodscenError("the simulator renders blank frames")
    return f"{DEFAULT_SIMULATOR} renders"


def _litellm() -> str:
    from oodscen.llms.litellm import load_litellm

    load_litellm()
    return "litellm is installed; keys are read from the environment when a model is asked"

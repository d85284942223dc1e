"""Checks that the components of the default run are installed and work."""

import platform
import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from zlib import compress, crc32

from oodscen._io.files import temporary_folder
from oodscen._members import close, is_interruption, reason
from oodscen._progress import Progress
from oodscen.errors import DataError, OodscenError, UsageError
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.protocols import LLM


class CheckResult(NamedTuple):
    """The result of one check."""

    what: str
    is_ok: bool
    detail: str
    """A version, or a fault and its fix."""


def examine() -> list[CheckResult]:
    """Check Python, the built-in author, the encoder and the simulator."""
    return [
        CheckResult("python", sys.version_info >= (3, 11), platform.python_version()),
        _tried("built-in author", _author),
        _tried("encoder", _encoder),
        _tried("simulator", _simulator),
        _tried("language models", _litellm),
    ]


def examine_simulator(
    name: str,
    *,
    is_quick: bool = False,
    states_only: bool = False,
    progress: Progress | bool | None = None,
) -> list[CheckResult]:
    """Run the conformance check on one simulator.

    Args:
        name: A registered name, or `module:attr`.
        is_quick: Skip the slow parts.
        states_only: Do not compare pictures of repeated runs.
        progress: True for a progress bar, or a callable; it counts the parts.

    Returns:
        One finding per fault, or one that the protocol is kept; then what parts left out, and those that do
        not apply; without a fault, also how much its catalogue can show.

    Raises:
        UsageError: If there is no such simulator.
    """
    from oodscen._registry import make_simulator
    from oodscen.testing._check import examine_parts

    close(make_simulator(name))
    results = examine_parts(name, quick=is_quick, states_only=states_only, progress=progress)
    what = f"simulator {name}"
    check_results = [
        CheckResult(what, False, line) for result in results for line in result.lines()
    ]
    idle = {result.part: result.inapplicable for result in results if result.inapplicable}
    if not check_results:
        held = ", ".join(result.part for result in results if result.part not in idle)
        check_results.append(CheckResult(what, True, f"keeps the protocol ({held})"))
    check_results += [
        CheckResult(what, True, f"{result.part}: {result.note}")
        for result in results
        if result.note
    ]
    check_results += [
        CheckResult(what, True, f"{part} does not apply: {reason}") for part, reason in idle.items()
    ]
    if all(result.is_ok for result in check_results):
        check_results.append(CheckResult(what, True, outlook(name)[0]))
    return check_results


def outlook(name: str) -> tuple[str, bool]:
    """Return in one line how much the catalogue of a simulator can show, and whether that is less than half.

    The measure are the kinds of hazard that the built-in author stages, whichever model makes the tree.

    Raises:
        UsageError: If there is no such simulator.
    """
    from oodscen._registry import make_catalogue
    from oodscen.author._knowledge.inspection import showable_kinds

    catalogue = make_catalogue(name)
    shown, known = showable_kinds(catalogue)
    counts = {
        "maps": len(catalogue.maps),
        "assets": len(catalogue.assets),
        "behaviours": len(catalogue.behaviours),
    }
    size = ", ".join(f"{count} {noun}" for noun, count in counts.items())
    line = f"its catalogue ({size}) shows {shown} of {known} kinds of hazard that the built-in author stages"
    return line, shown < 0.5 * known


WANTED = {"hazards": 220, "families": 30, "staged": 90}
"""Minimum counts that the shipped knowledge base must have."""
_SHOWN_NOTES = 100


def examine_knowledge(path: str | Path | None = None) -> list[CheckResult]:
    """Check the built-in author's knowledge base, or a user's own file on top of it.

    Args:
        path: A TOML file, or a folder of them; `None` checks the shipped one.

    Returns:
        The counts, then one finding per fault with its file, line and hazard. Notes are findings that
        are not faults.
    """
    from oodscen._entry_points import names
    from oodscen._registry import make_catalogue
    from oodscen.author._knowledge.inspection import inspect_knowledge

    catalogues = {}
    for name in sorted(names("catalogue"), key=lambda name: (name != "pybullet", name)):
        try:
            catalogues[name] = make_catalogue(name)
        except UsageError:
            continue
    inspection = inspect_knowledge(path, catalogues)
    staged = max(inspection.shown.values(), default=0)
    counts = {"hazards": inspection.hazards, "families": inspection.families, "staged": staged}
    is_enough = path is not None or all(counts[key] >= least for key, least in WANTED.items())
    minimum = "at least {hazards} in {families}, {staged} of them shown".format_map(WANTED)
    wanted = "" if path is not None else f" ({minimum})"
    shown = ", ".join(f"{name} shows {number}" for name, number in inspection.shown.items())
    total = (
        f"{inspection.hazards} hazards in {inspection.families} families{wanted}; "
        f"{inspection.recipes} have a recipe; {shown or 'no catalogue to try them on'}"
    )
    findings = []
    if inspection.hazards or path is None:
        findings.append(CheckResult("knowledge base", is_enough, total))
    elif not inspection.faults:
        findings.append(CheckResult("knowledge base", True, "it adds no hazard"))
    findings += [
        CheckResult(fault.path or str(path), False, fault.message) for fault in inspection.faults
    ]
    findings += [
        CheckResult(f"note: {note.path}", True, note.message)
        for note in inspection.notes[:_SHOWN_NOTES]
    ]
    return findings


def examine_llm(name: str, *, api_base: str | None = None) -> list[CheckResult]:
    """Ask a language model two short questions, one of them with a picture.

    Args:
        name: A model name as for `--llm`.
        api_base: The address of an OpenAI-compatible server.

    Raises:
        UsageError: If no provider knows the name, or the network is forbidden.
    """
    from oodscen._registry import make_llm

    llm = make_llm(name, api_base=api_base)
    calls: list[Call] = []
    logged = LoggedLLM(llm, calls.append)
    match getattr(llm, "price", None):
        case (int() | float() as asked, int() | float() as answered):
            known = f"${asked:g} in and ${answered:g} out per million tokens"
        case _:
            known = f"not known; a cap on cost needs --price {name}=IN,OUT"
    findings = [_tried("answer", lambda: _answer(logged, calls))]
    if findings[0].is_ok or (calls and calls[-1].status == "ok"):
        seconds = sorted(call.seconds for call in calls)
        findings.append(_tried("image", lambda: _image(logged)))
        findings.append(
            CheckResult("latency", True, f"{seconds[len(seconds) // 2]:.2f} s per call")
        )
    return [*findings, CheckResult("price", True, known)]


def _answer(llm: LLM, calls: list[Call]) -> str:
    from oodscen.llm._ask import ask
    from oodscen.prompts._tree.imagine_scenario import ImagineScenario

    text = ask(llm, ImagineScenario(shown=("A deer crosses the road.",))).text
    repairs = len(calls) - 1
    how = "valid at once" if not repairs else f"valid after {repairs} repairs"
    return f"structured, {how}: {' '.join(text.split())[:100]}"


def _image(llm: LLM) -> str:
    from oodscen.data._messages import Image
    from oodscen.llm._ask import ask
    from oodscen.prompts._judging.describe_frame import DescribeFrame

    with temporary_folder() as folder:
        path = Path(folder) / "red.png"
        path.write_bytes(_red_png())
        text = ask(llm, DescribeFrame(frames=(Image.from_file(path),))).description
    seen = "sees it" if "red" in text.casefold() else "answers, but does not say that it is red"
    return f"{seen}: {' '.join(text.split())[:100]}"


def _red_png() -> bytes:
    """Return a red square as a PNG file."""
    size = 64

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", crc32(kind + data))

    rows = (b"\0" + b"\xff\0\0" * size) * size
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", compress(rows))
        + chunk(b"IEND", b"")
    )


def _tried(what: str, check: Callable[[], str]) -> CheckResult:
    try:
        return CheckResult(what, True, check())
    except OodscenError as error:
        return CheckResult(what, False, str(error))
    except BaseException as error:  # A broken installation may raise anything.
        if is_interruption(error):
            raise
        return CheckResult(what, False, reason(error))


def _author() -> str:
    from oodscen.author._knowledge.loading import load_knowledge
    from oodscen.author._knowledge.validation import validate_knowledge

    issues = validate_knowledge()
    if issues:
        raise DataError("knowledge base", issues)
    return f"{len(load_knowledge().hazards)} hazards"


def _encoder() -> str:
    from oodscen._registry import DEFAULT_ENCODER, make_encoder
    from oodscen.encoders._check import encode

    encoder = make_encoder(DEFAULT_ENCODER)
    shape = encode(encoder, ["A car follows a van."]).shape
    return f"{encoder.name}, {shape[1]} dimensions"


def _simulator() -> str:
    from oodscen._registry import DEFAULT_SIMULATOR, make_simulator
    from oodscen.protocols import Camera
    from oodscen.testing._scenes import example_scene

    with make_simulator(DEFAULT_SIMULATOR) as simulator:
        simulator.reset(example_scene(), seed=0)
        spread = int(simulator.render(Camera(width=160, height=120)).rgb.std())
    if spread < 4:
        raise OodscenError("the simulator renders blank frames")
    return f"{DEFAULT_SIMULATOR} renders"


def _litellm() -> str:
    from oodscen.llm._remote.sdk import load_litellm

    load_litellm()
    return "litellm is installed; keys are read from the environment when a model is asked"

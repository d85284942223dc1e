"""The conformance check that every simulator should pass."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from oodscen._arguments import checked
from oodscen._numbers import whole_number
from oodscen._parallel.processes import is_worker
from oodscen._progress import Progress, reporting
from oodscen._registry import make_simulator
from oodscen.data._scene import Scene
from oodscen.errors import UnknownComponent, UsageError
from oodscen.protocols import Simulator
from oodscen.testing._kit import (
    appearance,
    cameras,
    isolation,
    measures,
    motion,
    pictures,
    runs,
    vocabulary,
)
from oodscen.testing._kit.findings import Findings, NotApplicable, PartResult
from oodscen.testing._kit.probe import Factory, Probe, clear_day
from oodscen.testing._kit.samples import plain_scene

RESETS = 200
"""Number of resets in the `leaks` part."""
_MEMBERS = "name dt catalogue reset step render observe close __enter__ __exit__".split()
"""Members of `Simulator`."""

_PARTS: dict[str, Callable[[Probe], None]] = {
    "catalogue": vocabulary.check_catalogue,
    "maps": vocabulary.check_maps,
    "assets": vocabulary.check_assets,
    "appearance": appearance.check_appearance,
    "behaviours": vocabulary.check_behaviours,
    "weather": appearance.check_weather,
    "determinism": runs.check_determinism,
    "process": isolation.check_process,
    "controls": runs.check_controls,
    "snapshot": runs.check_snapshot,
    "rehearsal": runs.check_rehearsal,
    "measures": measures.check_measures,
    "motion": motion.check_motion,
    "frames": pictures.check_frames,
    "pictures": pictures.check_pictures,
    "turning": cameras.check_turned_cameras,
    "refusals": runs.check_refusals,
    "leaks": isolation.check_leaks,
}

PARTS = tuple(_PARTS)
"""The parts of `check_simulator`, in order.

`appearance` renders every asset in every state, `process` repeats the runs in a fresh process, and
`leaks` watches memory, files, threads and processes over many resets: these three take the longest.
"""

QUICK = tuple(part for part in PARTS if part not in ("appearance", "process", "leaks"))
"""The parts that together take only seconds."""


@checked
def check_simulator(
    simulator: Factory | str,
    *,
    scenes: Sequence[Scene] | None = None,
    quick: bool = False,
    states_only: bool = False,
    parts: Collection[str] = PARTS,
    resets: int = RESETS,
    progress: Progress | bool | None = None,
) -> None:
    """Check whether a simulator keeps the promises of the protocol.

    The checks cover:

    - an honest catalogue: every map, behaviour, weather extreme and asset in every state is available and shows;
    - one `dt` per step, and the ids, shapes and types of states and frames;
    - the same bytes for the same scene and seed, whatever ran before, also in a fresh process;
    - gaps, places, accelerations, heights, leaving the road and observations that follow from the poses;
    - motion of ego and actors, triggers and reactions as in the reference world, within tolerances, and lane changes
      without a jump;
    - pictures whose colours, ids and depth agree with each other, with the state and with the camera, also one that
      looks aside or back, and that follow many bodies, step for step and right after `restore`;
    - snapshots and rehearsals if offered, typed refusals, and a `close` that may be called twice;
    - memory, open files, threads and processes that do not grow, and none of the latter two after `close`.

    Args:
        simulator: A factory of fresh simulators, or a name as in `make_simulator`. Only names, and the
            classes and functions of importable modules, can run in a fresh process; that part does not apply to
            anything defined in a script or notebook.
        scenes: The scenes whose runs are repeated; by default one per map is made.
        quick: Skip the parts that take more than seconds: `appearance`, `process` and `leaks`.
        states_only: Compare only states where runs are repeated, for a simulator whose pixels differ from run
            to run. Its pictures are still checked one by one.
        parts: The parts to check, of `PARTS`.
        resets: Number of resets in the `leaks` part, at least 5.
        progress: True for a progress bar, or a callable; it counts the parts.

    Raises:
        AssertionError: Lists all findings, those alike on one line.
        UnknownComponent: If there is no such part.
        UsageError: If no part is left to check, or there are too few resets.
    """
    results = examine_parts(
        simulator,
        scenes=scenes,
        quick=quick,
        states_only=states_only,
        parts=parts,
        resets=resets,
        progress=progress,
    )
    _raise_findings(results)


def examine_parts(
    simulator: Factory | str,
    *,
    scenes: Sequence[Scene] | None = None,
    quick: bool = False,
    states_only: bool = False,
    parts: Collection[str] = PARTS,
    resets: int = RESETS,
    progress: Progress | bool | None = None,
) -> list[PartResult]:
    """Return what each part of `check_simulator` found; the arguments are the same.

    The last result, `close`, is that of opening and closing the simulator.
    """
    for part in parts:
        if part not in PARTS:
            raise UnknownComponent("part", part, PARTS)
    if is_worker():
        raise UsageError(isolation.NEEDS_GUARD)
    selected = [part for part in (QUICK if quick else PARTS) if part in parts]
    if not selected:
        raise UsageError("parts has no part" + (" that takes only seconds" if quick else ""))
    resets = whole_number("resets", resets, isolation.BLOCKS)
    factory = partial(make_simulator, simulator) if isinstance(simulator, str) else simulator
    results: list[PartResult] = []
    opening = Findings()
    with reporting(progress) as report:
        with opening.trying("the factory works"):
            with factory() as opened:
                make_probe = partial(
                    _probe,
                    opened,
                    scenes,
                    factory=factory,
                    source=simulator,
                    states_only=states_only,
                    resets=resets,
                )
                for done, part in enumerate(selected):
                    report("check", done, len(selected))
                    results.append(_run_part(part, make_probe))
            with opening.trying("close may be called twice"):
                opened.close()
                opened.close()
        report("check", len(selected), len(selected))
    return [*results, PartResult("close", tuple(opening.recorded))]


def _run_part(part: str, make_probe: Callable[[Findings], Probe]) -> PartResult:
    """Run one part on an open simulator."""
    findings = Findings()
    try:
        with findings.trying(""):
            _PARTS[part](make_probe(findings))
    except NotApplicable as reason:
        return PartResult(part, tuple(findings.recorded), "" if findings.recorded else str(reason))
    return PartResult(part, tuple(findings.recorded), note=findings.note)


def _probe(
    simulator: Simulator, scenes: Sequence[Scene] | None, findings: Findings, **options: Any
) -> Probe:
    """Return the input of a part; the options are further fields of `Probe`.

    Raises:
        UsageError: If the object is not a simulator, or its catalogue is empty.
    """
    missing = [name for name in _MEMBERS if not hasattr(simulator, name)]
    if missing:
        raise UsageError(f"some members of the protocol are missing: {', '.join(missing)}")
    if not simulator.name or not simulator.dt > 0.0:
        raise UsageError("name is empty, or dt is not positive")
    catalogue = simulator.catalogue()
    if not catalogue.maps or not catalogue.assets:
        raise UsageError("the catalogue has no map or no asset")
    weather = clear_day(catalogue)
    scenes = scenes or [plain_scene(catalogue, road, weather) for road in catalogue.maps]
    return Probe(
        simulator=simulator, catalogue=catalogue, scenes=scenes, findings=findings, **options
    )


def _raise_findings(results: Iterable[PartResult]) -> None:
    """Raise an error that lists all findings, if there are any.

    Raises:
        AssertionError: If a part does not hold.
    """
    lines = [line for result in results for line in result.lines()]
    if lines:
        raise AssertionError("\n  - ".join(["the simulator breaks its protocol:", *lines]))


@dataclass(frozen=True)
class SimulatorCheck:
    """One part of the conformance check; call it to run it."""

    part: str
    simulator: Factory | str
    states_only: bool = False

    def __call__(self) -> None:
        """Open the simulator, run the part, and close it.

        Raises:
            AssertionError: Lists all findings.
        """
        _raise_findings(
            examine_parts(self.simulator, states_only=self.states_only, parts=(self.part,))
        )

    def __str__(self) -> str:
        return self.part


@checked
def simulator_checks(
    simulator: Factory | str, *, quick: bool = False, states_only: bool = False
) -> tuple[SimulatorCheck, ...]:
    """Return the parts of `check_simulator` as named checks, one test each.

    Use them with pytest::

        @pytest.mark.parametrize("check", simulator_checks(MySimulator), ids=str)
        def test_simulator(check):
            check()

    Args:
        simulator: As for `check_simulator`; nothing is opened yet.
        quick: Leave out the parts that take more than seconds.
        states_only: As for `check_simulator`.
    """
    parts = QUICK if quick else PARTS
    return tuple(SimulatorCheck(part, simulator, states_only) for part in parts)

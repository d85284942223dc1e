"""Results by driver: outcomes, conflicts, headway, progress and comfort, paired with the twins."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked
from oodscen._numbers import seed_number
from oodscen.data._base import Data
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import leaf_in, scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.judging._items import last_by
from oodscen.judging._leaderboard.rows import Estimate
from oodscen.judging._rates_in_words import bracketed, lead, percent
from oodscen.statistics._intervals import (
    FEWEST_CLUSTERS,
    Interval,
    cluster_interval,
    share_interval,
)
from oodscen.statistics._resampling import Resampler
from oodscen.statistics._significance import PairedTest, paired_test

RULE_BASED = "rule-based"
"""Name of the built-in driver that the others are compared with."""
HARDLY_DRIVES = 0.5
"""The progress a stack must reach on ordinary roads to count as driving, relative to keeping the initial
speed.
"""
CRITICAL_TTC_S = 1.5
"""The time to collision below which a conflict is critical, s."""


def current_results(drives: Iterable[DriveResult], scenes: Iterable[Scene]) -> list[DriveResult]:
    """Return the results of the scenes as they are now, sorted by driver and then in the order of the scenes."""
    digests = {scene.id: scene.digest() for scene in scenes}
    order = {name: index for index, name in enumerate(digests)}
    results = [
        drive for drive in drives if digests.get(scene_of(drive.scene_id)) == drive.made_from
    ]
    return sorted(
        results,
        key=lambda result: (result.driver, order[scene_of(result.scene_id)], result.is_twin),
    )


class DriveRate(Data):
    """A count out of a number of drives."""

    hits: int = 0
    n: int = 0
    value: float | None = None
    interval: Interval | None = None
    """Resampled over whole paths; with fewer than five paths, Wilson's interval with each path as one drive."""


class Pairing(Data):
    """Scenes and their twins, driven by the same driver."""

    n: int = 0
    both: int = 0
    """Passed in the scene and in its twin."""
    scene_only: int = 0
    twin_only: int = 0
    """Passed in the twin only: failures due to the hazard."""
    neither: int = 0
    drives_and_passes: DriveRate = DriveRate()
    """Passed in both, with a progress of at least `HARDLY_DRIVES` in the twin. A driver that stands still passes
    many scenes but does not count here.
    """
    progress_lost: Estimate = Estimate()
    """Progress in the twin minus progress in the scene."""
    against_rule_based: PairedTest | None = None
    """`drives_and_passes` compared with the rule-based driver's on the same scenes."""


class DriveRow(Data):
    """One driver over all scenes, or over all twins."""

    driver: str
    kind: Literal["scenes", "twins"]
    """The drives that the row counts."""
    n: int
    """Number of drives, including failed and inconclusive ones."""
    failed: int
    """Drives that did not run; excluded from all other figures."""
    inconclusive: int = 0
    """Recorded runs that could not be judged; excluded from all other figures."""
    passed: int
    collisions: int
    """Drives that ended in a collision."""
    off_road: int
    shares: dict[str, DriveRate] = {}
    """Shares of the drives that ran: `passed`, `collisions`, `off_road`, `critical` (a collision, or a time to
    collision below `CRITICAL_TTC_S`), and for twins `needless` (`DriveResult.brakes_needlessly`).
    """
    means: dict[str, Estimate] = {}
    """Means of `min_ttc_s`, `min_headway_s`, `median_headway_s`, `progress` (1 is keeping the initial speed
    throughout), `peak_deceleration` (m/s^2) and `peak_jerk` (m/s^3).
    """
    paired: Pairing | None = None
    """The comparison with the twins; for the row of the scenes only."""


class DriveBoard(Data):
    """The results of every driver of a study."""

    rows: tuple[DriveRow, ...] = ()
    """The rows of every driver, for scenes and twins, best first by `drives_and_passes`."""
    paths: int = 0

    def of(self, driver: str, kind: Literal["scenes", "twins"] = "scenes") -> DriveRow | None:
        """Return the row of one driver, or `None`."""
        rows = (row for row in self.rows if (row.driver, row.kind) == (driver, kind))
        return next(rows, None)

    @property
    def drivers(self) -> tuple[str, ...]:
        """The drivers, best first."""
        return tuple(dict.fromkeys(row.driver for row in self.rows))

    def remarks(self) -> list[str]:
        """Return sentences that name the figures that do not show skill."""
        remarks = []
        for scenes, twins in self._pairs():
            progress, passed = twins.means["progress"].value, scenes.shares["passed"].value
            if progress is not None and passed and progress < HARDLY_DRIVES:
                remarks.append(
                    f"{scenes.driver} passes {percent(passed)} of the scenes by hardly driving: on the ordinary twins it "
                    f"comes {percent(progress)} as far as keeping the speed would. Standing still is no skill."
                )
        return remarks

    def sentences(self) -> list[str]:
        """Return a sentence per driver, best first: the main figure, and needless braking in the twins."""
        return [_sentence(scenes, twins) for scenes, twins in self._pairs()]

    def _pairs(self) -> Iterator[tuple[DriveRow, DriveRow]]:
        """Yield the rows of scenes and twins of every driver that has both, best first."""
        for driver in self.drivers:
            scenes, twins = self.of(driver), self.of(driver, "twins")
            if scenes and twins:
                yield scenes, twins


def _sentence(scenes: DriveRow, twins: DriveRow) -> str:
    pairing, needless = scenes.paired or Pairing(), twins.shares["needless"]
    share, test = pairing.drives_and_passes, pairing.against_rule_based
    if share.value is None:
        return f"{scenes.driver} has driven no scene and its twin to the end."
    ahead = f" ({lead(test.difference, RULE_BASED)})" if test else ""
    braking = ""
    if needless.n:
        hard = f"{percent(needless.value)}{bracketed(needless)}"
        braking = f", and brakes hard without need in {hard} of the twins"
    return (
        f"{scenes.driver} drives and passes {percent(share.value)}{bracketed(share)} of {share.n} scenes with their "
        f"ordinary twins{ahead}{braking}."
    )


_MEANS = (
    "min_ttc_s",
    "min_headway_s",
    "median_headway_s",
    "progress",
    "peak_deceleration",
    "peak_jerk",
)


@checked
def drive_board(
    results: Iterable[DriveResult], scenarios: Iterable[Scenario] = (), *, seed: int = 0
) -> DriveBoard:
    """Return the results of every driver, with intervals that resample whole paths.

    Args:
        results: Results of any drivers, on scenes and twins, including failed ones. The last result of a driver in a
            scene replaces earlier ones.
        scenarios: The scenarios, which give the path of each scene; without them the scene's id gives it.
        seed: Seed of the resampling.
    """
    paths = paths_of(scenarios)
    grouped: dict[str, list[DriveResult]] = {}
    for drive_result in last_by(results, lambda result: (result.driver, result.scene_id)):
        grouped.setdefault(drive_result.driver, []).append(drive_result)
    estimator = _Estimator(paths, seed_number(seed))
    yardstick = drives_and_passes(grouped.get(RULE_BASED, ()))
    pairs = []
    for driver, drives in grouped.items():
        scenes = [drive for drive in drives if not drive.is_twin]
        twins = [drive for drive in drives if drive.is_twin]
        pairing = estimator.pairing(scenes, twins, {} if driver == RULE_BASED else yardstick)
        row = estimator.row(driver, "scenes", scenes).model_copy(update={"paired": pairing})
        pairs.append((row, estimator.row(driver, "twins", twins)))
    return DriveBoard(
        rows=tuple(row for pair in sorted(pairs, key=_rank) for row in pair if row.n),
        paths=len({path_of(drive, paths) for drives in grouped.values() for drive in drives}),
    )


def _rank(pair: tuple[DriveRow, DriveRow]) -> tuple[bool, float, bool, str]:
    """Return the sort key of a driver's rows: best first, those without the main figure last."""
    scenes, _ = pair
    value = scenes.paired.drives_and_passes.value if scenes.paired else None
    return value is None, -(value or 0.0), scenes.driver != RULE_BASED, scenes.driver


def paths_of(scenarios: Iterable[Scenario]) -> dict[str, str]:
    """Return the path of every scene, by its id."""
    return {scenario.id: " > ".join(scenario.path) for scenario in scenarios}


def path_of(drive: DriveResult, paths: Mapping[str, str]) -> str:
    """Return the path of a drive's scene; if it is not known, the scene's id gives it."""
    return paths.get(scene_of(drive.scene_id)) or leaf_in(drive.scene_id)


def drives_and_passes(drives: Sequence[DriveResult]) -> dict[str, bool]:
    """Return, for every scene with a twin, whether the driver passed both and made progress in the twin."""
    twins = {
        scene_of(drive.scene_id): drive
        for drive in drives
        if drive.is_twin and drive.status == "ok"
    }
    passes = {}
    for drive in drives:
        twin = twins.get(drive.scene_id)
        if not drive.is_twin and drive.status == "ok" and twin is not None:
            moves_on = twin.progress >= HARDLY_DRIVES
            passes[drive.scene_id] = drive.passed and twin.passed and moves_on
    return passes


class _Estimator:
    """Estimates shares and means of drives, with intervals over whole paths."""

    def __init__(self, paths: dict[str, str], seed: int) -> None:
        self._paths = paths
        self._seed = seed

    def row(
        self, driver: str, kind: Literal["scenes", "twins"], drives: Sequence[DriveResult]
    ) -> DriveRow:
        ran = [drive for drive in drives if drive.status == "ok"]
        shares = {
            "passed": self.share(ran, lambda drive: drive.passed),
            "collisions": self.share(ran, lambda drive: bool(drive.collisions)),
            "off_road": self.share(ran, lambda drive: drive.off_road),
            "critical": self.share(ran, is_critical),
        }
        if kind == "twins":
            judged = [drive for drive in ran if drive.brakes_needlessly is not None]
            shares["needless"] = self.share(judged, lambda drive: bool(drive.brakes_needlessly))
        return DriveRow(
            driver=driver,
            kind=kind,
            n=len(drives),
            failed=sum(drive.status == "failed" for drive in drives),
            inconclusive=sum(drive.status == "inconclusive" for drive in drives),
            passed=shares["passed"].hits,
            collisions=shares["collisions"].hits,
            off_road=shares["off_road"].hits,
            shares=shares,
            means={name: self.mean(ran, attrgetter(name)) for name in _MEANS},
        )

    def pairing(
        self,
        scenes: Sequence[DriveResult],
        twins: Sequence[DriveResult],
        yardstick: dict[str, bool],
    ) -> Pairing:
        passes = drives_and_passes([*scenes, *twins])
        twin_passed = {
            scene_of(twin.scene_id): twin.passed for twin in twins if twin.status == "ok"
        }
        paired_scenes = [scene for scene in scenes if scene.scene_id in passes]
        counts = [(scene.passed, twin_passed[scene.scene_id]) for scene in paired_scenes]
        return Pairing(
            n=len(paired_scenes),
            both=counts.count((True, True)),
            scene_only=counts.count((True, False)),
            twin_only=counts.count((False, True)),
            neither=counts.count((False, False)),
            drives_and_passes=self.share(paired_scenes, lambda scene: passes[scene.scene_id]),
            progress_lost=self.mean(paired_scenes, lambda scene: scene.progress_lost),
            against_rule_based=self.comparison(paired_scenes, passes, yardstick),
        )

    def comparison(
        self, scenes: Sequence[DriveResult], passes: dict[str, bool], yardstick: dict[str, bool]
    ) -> PairedTest | None:
        common = [scene for scene in scenes if scene.scene_id in yardstick]
        if not common:
            return None
        return paired_test(
            np.array([passes[scene.scene_id] for scene in common], np.float64),
            np.array([yardstick[scene.scene_id] for scene in common], np.float64),
            [path_of(scene, self._paths) for scene in common],
            seed=self._seed,
        )

    def share(
        self, drives: Sequence[DriveResult], is_hit: Callable[[DriveResult], bool]
    ) -> DriveRate:
        values = np.array([is_hit(drive) for drive in drives], np.float64)
        if not len(values):
            return DriveRate()
        replicates, units = self._resampled(drives, values)
        hits = int(values.sum())
        return DriveRate(
            hits=hits,
            n=len(values),
            value=round(hits / len(values), 6),
            interval=share_interval(hits, len(values), units, replicates),
        )

    def mean(
        self, drives: Sequence[DriveResult], figure: Callable[[DriveResult], float | None]
    ) -> Estimate:
        measured = [drive for drive in drives if figure(drive) is not None]
        if not measured:
            return Estimate()
        values = np.array([figure(drive) for drive in measured], np.float64)
        replicates, units = self._resampled(measured, values)
        interval = None if replicates is None else cluster_interval(replicates, units)
        return Estimate(value=round(float(values.mean()), 6), n=len(values), interval=interval)

    def _resampled(
        self, drives: Sequence[DriveResult], values: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64] | None, int]:
        """Return [r] resampled means, or `None` with too few paths, and the number of paths."""
        clusters = [path_of(drive, self._paths) for drive in drives]
        units = len(set(clusters))
        if units < FEWEST_CLUSTERS:
            return None, units
        resampler = Resampler(clusters, seed=self._seed)
        return resampler.ratios(values[:, None], np.ones((len(values), 1)))[:, 0], units


def is_critical(drive: DriveResult) -> bool:
    """Return whether a drive ended in a collision or came close to one."""
    came_close = drive.min_ttc_s is not None and drive.min_ttc_s < CRITICAL_TTC_S
    return bool(drive.collisions) or came_close

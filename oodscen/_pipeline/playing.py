"""Drives that another player drove, in a study's table of drivers."""

from collections.abc import Mapping, Sequence

from oodscen._members import using
from oodscen._registry import make_simulator
from oodscen._words.text import first_few
from oodscen.data._drive_result import DriveResult
from oodscen.data._pairing import scene_of, twin_id
from oodscen.data._scene import Scene
from oodscen.errors import UsageError
from oodscen.interchange._moving import moving
from oodscen.judging._drive_board import current_results
from oodscen.protocols import Simulator
from oodscen.stages._drive import DrivePlan, is_needless, paired
from oodscen.study._study import Study


def enter_played(study: Study, drives: Sequence[DriveResult], *, is_replacing: bool) -> None:
    """Enter one driver's drives of scenes and twins into a study's table; the caller holds its lock.

    A scene and its twin are paired, as `drive` pairs them, also where the table had one of them before.

    Args:
        study: The study.
        drives: The results, at least one.
        is_replacing: Replace other results of the driver for the same scenes.

    Raises:
        UsageError: If there are such results, and they are not to be replaced.
    """
    driver = drives[0].driver
    scenes = {scene.id: scene for scene in study.scenes}
    before = {row.id: row for row in current_results(study.drives, study.scenes)}
    entered = {
        drive.id: drive.model_copy(update={"made_from": scenes[scene_of(drive.scene_id)].digest()})
        for drive in drives
    }
    driven = dict.fromkeys(scene_of(drive.scene_id) for drive in drives)
    with (
        using(make_simulator(study.config.simulator)) as own,
        moving(own, own.catalogue()) as simulator,
    ):
        both = _pairs(
            before | entered,
            driver,
            [scenes[name] for name in driven],
            simulator,
            study.config.seed,
        )
    table = before | entered | both
    other = [
        table[name].scene_id for name in entered if name in before and table[name] != before[name]
    ]
    if other and not is_replacing:
        raise UsageError(
            f"{driver} has another result for {first_few(other)} already, which --replace replaces"
        )
    study.store.write_lines("drives.jsonl", list(table.values()))


def _pairs(
    table: Mapping[str, DriveResult],
    driver: str,
    scenes: Sequence[Scene],
    simulator: Simulator,
    seed: int,
) -> dict[str, DriveResult]:
    """Return the results of scenes of which a driver also drove the twin, each with how it fared in the other."""
    found: dict[str, DriveResult] = {}
    for scene in scenes:
        one = table.get(f"{scene.id}@{driver}")
        other = table.get(f"{twin_id(scene.id)}@{driver}")
        if one is not None and other is not None:
            is_clear = DrivePlan(scene, simulator, seed).is_clear
            found |= {row.id: row for row in paired(one, other, is_needless(other, is_clear))}
    return found

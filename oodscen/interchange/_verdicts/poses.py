"""Reads the poses that a player wrote: CSV of our own, esmini's CSV log, and OSI traces."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from oodscen._display import Brief
from oodscen._io.files import read_regular, read_utf8
from oodscen.interchange._traces.osi_reading import BodyPose, Pose, read_osi_trace
from oodscen.interchange._verdicts.pose_tables import NOUN, csv_poses, esmini_poses, fault
from oodscen.numerics._exact import Floats

MAX_BYTES = 512 * 1024 * 1024
_MAX_POSES = 20_000_000
"""Maximum number of bodies times moments: the poses of bodies that are missing at a moment take memory, too."""


@dataclass(frozen=True, eq=False, repr=False)
class PlayedPoses(Brief):
    """The poses of the bodies in one run of a player."""

    names: tuple[str, ...]
    time: Floats
    """[n], s, increasing."""
    poses: Floats
    """[n, bodies, 4] x, y, z of the footprints' centres, m, and heading, rad; NaN where a body is missing."""
    unnamed: int = 0
    """Most bodies without a name at one time."""
    ego_sizes: tuple[tuple[float, float], ...] = ()
    """Lengths and widths of the ego that the file tells, m; the run is judged with the scene's."""
    other_host: str | None = None
    """The body that the file takes for the ego, and since when, if it is another one than `ego`."""


def read_poses(path: str | Path) -> PlayedPoses:
    """Read the poses of one run.

    A CSV file has the columns `time,name,x,y,h` and, if it likes, `z`: one row per time and body, with the centre
    of the footprint in metres and the heading in radians. esmini's own CSV log and OSI traces of ground truth
    (`.osi`, `.mcap`) are read as they are.

    Raises:
        DataError: If the file is none of these, with the line of the first fault.
    """
    source = str(path)
    if source.lower().endswith((".osi", ".mcap")):
        data = read_regular(path, NOUN, limit=MAX_BYTES)
        return _collected(read_osi_trace(data, source), source)
    text = read_utf8(path, NOUN, limit=MAX_BYTES)
    lines = text.splitlines()
    if lines and lines[0].startswith("esmini "):
        return _collected(esmini_poses(lines, source), source)
    return _collected(csv_poses(text, source), source)


def _collected(bodies: Iterable[BodyPose], source: str) -> PlayedPoses:
    """Return the poses of all bodies at all times.

    Raises:
        DataError: If there are fewer than two times, too many poses, or two poses of a body at one time.
    """
    named: list[BodyPose] = []
    unnamed: dict[float, set[Pose]] = {}
    for body in bodies:
        if body.name:
            named.append(body)
        else:
            unnamed.setdefault(body.time, set()).add(body.pose)
    names = tuple(dict.fromkeys(body.name for body in named))
    times = sorted({body.time for body in named})
    if len(times) < 2:
        raise fault("", "holds fewer than two moments", source)
    if len(times) * len(names) > _MAX_POSES:
        message = f"{len(names):,} bodies at {len(times):,} moments are too many to be judged"
        raise fault("", message, source)
    return PlayedPoses(
        names,
        np.array(times),
        _pose_array(named, names, times, source),
        max(map(len, unnamed.values()), default=0),
        tuple(dict.fromkeys(body.size for body in named if body.name == "ego" and body.size)),
        _other_host(named),
    )


def _pose_array(
    bodies: Sequence[BodyPose], names: Sequence[str], times: Sequence[float], source: str
) -> Floats:
    rows = {name: row for row, name in enumerate(names)}
    steps = {time: step for step, time in enumerate(times)}
    poses = np.full((len(times), len(names), 4), np.nan)
    for body in bodies:
        step, row = steps[body.time], rows[body.name]
        earlier = poses[step, row]
        if not np.isnan(earlier[0]) and tuple(earlier) != body.pose:
            raise fault(body.name, f"has two poses at {body.time:g} s", source)
        poses[step, row] = body.pose
    return poses


def _other_host(bodies: Sequence[BodyPose]) -> str | None:
    """Return the body that a file takes for the ego where it is not `ego`, and the first such time."""
    for body in bodies:
        if body.name == "ego" and body.is_host is False:
            hosts = [other.name for other in bodies if other.time == body.time and other.is_host]
            return f"{hosts[0] if hosts else 'no named body'} at {body.time:g} s"
    return None

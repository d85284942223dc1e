"""The ground truth of an episode: what its states imply, one row per step and body, in SI units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import state_of
from oodscen._display import Brief
from oodscen._io.files import write_named, writing
from oodscen._io.study_files import refuse_own
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.prop import FLAT_M
from oodscen.data._scene import Scene
from oodscen.driving import _trace_table as table
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, ego_strip
from oodscen.driving._roads.projection import lanes, places
from oodscen.driving._surrogate_safety import (
    Footprints,
    overlap,
    post_encroachment,
    time_headway,
    time_to_collision,
)
from oodscen.errors import MissingExtra, UsageError
from oodscen.numerics._arrays import sincos_all
from oodscen.numerics._exact import TAU, Floats
from oodscen.protocols import State

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

_ALL = slice(None)


class Encounter(Data):
    """The closest encounter of the ego with one actor in a trace."""

    actor: str
    min_gap_m: float | None = None
    """Smallest gap, m; `None` if the actor was never near."""
    min_ttc_s: float | None = None
    """Minimum time to collision, s; `None` if they were never on a collision course."""
    pet_s: float | None = None
    """Post-encroachment time, s; `None` if their paths share no ground."""
    min_time_headway_s: float | None = None
    """Minimum time headway, s; `None` if the actor was never ahead in the ego's path."""
    max_deceleration: float = 0.0
    """Hardest braking of the actor, m/s^2."""


@dataclass(frozen=True, eq=False, repr=False)
class Course(Brief):
    """The reference for all traces of a scene: its road and the sizes of its bodies."""

    corridor: Corridor
    strip: int
    """Index of the strip in which the ego starts."""
    sizes: Floats
    """[n, 3] length, width and height of every body, the ego first, m."""
    passable: NDArray[np.bool_]
    """[n] true for bodies that can be driven over or through."""

    @classmethod
    def of(cls, scene: Scene, catalogue: Catalogue) -> Self:
        """Look up the road and the sizes of all bodies."""
        bodies = catalogue.bodies(scene)
        sizes = np.array([(asset.length, asset.width, asset.height) for _, asset, _ in bodies])
        passable = np.array([asset.is_passable(state) for _, asset, state in bodies])
        corridor = load_corridor(scene.map, catalogue)
        return cls(corridor, ego_strip(corridor, scene.ego.lane), sizes, passable)


@dataclass(frozen=True, eq=False, repr=False)
class Trace(Brief):
    """The states of an episode and the measures derived from them.

    Arrays are [steps, bodies], with the ego in column 0; infinity and NaN become null in tables.
    """

    ids: tuple[str, ...]
    """`ego`, then the actors in the scene's order."""
    columns: table.Columns

    @classmethod
    def of(cls, states: Sequence[State], scene: Scene, catalogue: Catalogue) -> Self:
        """Compute the ground truth of consecutive states.

        Args:
            states: The states in order, at least one.
            scene: The scene of the states.
            catalogue: The simulator's catalogue, for sizes and the map.

        Raises:
            UsageError: If there is no state, one is of another scene, or time does not pass between two.
        """
        for state in states:
            state_of(scene, state)
        return cls.from_states(states, Course.of(scene, catalogue))

    @classmethod
    def from_states(cls, states: Sequence[State], course: Course) -> Self:
        """Compute the ground truth of consecutive states of a course's scene.

        Raises:
            UsageError: If there is no state, or time does not pass between two.
        """
        if not states:
            raise UsageError("a trace needs at least one state")
        if any(after.time <= before.time for before, after in pairwise(states)):
            raise UsageError("the states of a trace must be in the order of their times")
        bodies = _BodyTracks.of(states, course)
        s, t, road_cos, road_sin = places(course.corridor, bodies.x, bodies.y)
        vx, vy, acceleration, turn_rate = _rates(bodies)
        shape = bodies.speed.shape
        contact = bodies.gap <= 0.0
        contact[:, 0] = contact[:, 1:].any(axis=1)
        off_road = np.full(shape, np.nan)
        off_road[:, 0] = [state.off_road for state in states]
        steps = np.array([state.step for state in states])
        columns = {
            "step": np.broadcast_to(steps[:, None], shape),
            "time": np.broadcast_to(bodies.time[:, None], shape),
            "x": bodies.x,
            "y": bodies.y,
            "z": bodies.z,
            "yaw": bodies.yaw,
            "speed": bodies.speed,
            "vx": vx,
            "vy": vy,
            "acceleration": acceleration,
            "lateral_acceleration": bodies.speed * turn_rate,
            "s": s,
            "t": t,
            "lane": lanes(course.corridor, course.strip, s, t),
            "gap_m": bodies.gap,
            "ttc_s": _times_to_collision(bodies, course, vx, vy, s),
            "time_headway_s": _headways(bodies, course, s, t, road_cos, road_sin),
            "contact": contact,
            "off_road": off_road,
        }
        for index, name in enumerate(("length", "width", "height")):
            columns[name] = np.broadcast_to(course.sizes[:, index], shape)
        return cls(states[0].ids, columns)

    def __len__(self) -> int:
        return len(self.columns["time"]) * len(self.ids)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """Return one column: [steps, bodies]."""
        return self.columns[column]

    @property
    def steps(self) -> int:
        """Number of states."""
        return len(self.columns["time"])

    def summary(self) -> dict[str, Encounter]:
        """Return the closest encounter of the ego with every actor, by actor id."""
        if len(self.ids) < 2:
            return {}
        columns = self.columns
        sin, cos = sincos_all(columns["yaw"])
        footprints = Footprints(
            columns["x"], columns["y"], cos, sin, 0.5 * columns["length"], 0.5 * columns["width"]
        )
        others = footprints.at(_ALL, slice(1, None))
        pet = post_encroachment(footprints.at(_ALL, 0), others, columns["time"][:, 0])
        # An actor that is driven over, through or under shares the ego's ground without a conflict.
        pet[overlap(footprints.at(_ALL, slice(0, 1)), others).any(axis=0)] = np.inf
        pet[columns["contact"][:, 1:].any(axis=0)] = 0.0
        least = {
            name: columns[name][:, 1:].min(axis=0) for name in ("gap_m", "ttc_s", "time_headway_s")
        }
        # What speeds up in reverse accelerates against its heading, and does not brake.
        braking = -columns["acceleration"][1:, 1:] * np.sign(columns["speed"][:-1, 1:])
        hardest = braking.max(axis=0, initial=0.0)
        return {
            name: Encounter(
                actor=name,
                min_gap_m=_rounded(least["gap_m"][row]),
                min_ttc_s=_rounded(least["ttc_s"][row]),
                pet_s=_rounded(pet[row]),
                min_time_headway_s=_rounded(least["time_headway_s"][row]),
                max_deceleration=round(float(hardest[row]), 3) + 0.0,
            )
            for row, name in enumerate(self.ids[1:])
        }

    def to_arrow(self) -> "pa.Table":
        """Return an Arrow table, ordered by step and then by body.

        Raises:
            MissingExtra: If pyarrow is not installed.
        """
        return table.to_arrow(self.ids, self.columns)

    def to_pandas(self) -> "pd.DataFrame":
        """Return a data frame, ordered by step and then by body.

        Raises:
            MissingExtra: If pandas or pyarrow is not installed.
        """
        try:
            import pandas  # noqa: F401  (pyarrow imports it by itself, with a worse message)
        except ImportError:
            raise MissingExtra("a trace as a data frame", "tables", "pandas") from None
        return self.to_arrow().to_pandas()

    def save(self, path: str | Path) -> Path:
        """Write the table in the format given by the suffix.

        Args:
            path: A path ending in `.parquet`, `.arrow` (an IPC file) or `.csv`; its folder is created.

        Raises:
            UsageError: For any other suffix.
            MissingExtra: If pyarrow is not installed.
            FolderTaken: If the file would belong to a study.
            OodscenError: If the file cannot be written.
        """
        target = table.checked_path(path)
        content = table.to_bytes(self.to_arrow(), target.suffix)
        with writing(target):
            refuse_own(target)
            write_named(target, content)
        return target

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a table that `save` wrote.

        Raises:
            UsageError: For any other suffix.
            DataError: If the file is missing or is not a trace.
            MissingExtra: If pyarrow is not installed.
        """
        source = table.checked_path(path)
        return cls(*table.from_arrow(table.read(source), str(source)))


def concatenate(traces: Mapping[str, Trace]) -> "pa.Table":
    """Return several traces as one Arrow table with their names in the first column, `phase`.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    tables = [table.with_phase(trace.to_arrow(), name) for name, trace in traces.items()]
    import pyarrow as pa

    return pa.concat_tables(tables)


def least_time_to_collision(before: State | None, state: State, course: Course) -> float:
    """Return the least time to collision of the ego with any body, s; infinite without one.

    Velocities are those since the state before, and without one along the headings.
    """
    bodies = _BodyTracks.of([state], course)
    vx, vy = bodies.speed * bodies.footprints.cos, bodies.speed * bodies.footprints.sin
    if before is not None:
        velocities = (state.poses[:, :2] - before.poses[:, :2]) / (state.time - before.time)
        vx, vy = velocities.T[:, None, :]
    if state.places is not None:
        s = state.places[None, :, 0]
    else:
        s = places(course.corridor, bodies.x, bodies.y)[0]
    return float(_times_to_collision(bodies, course, vx, vy, s)[0, 1:].min(initial=np.inf))


class _BodyTracks(NamedTuple):
    """The bodies of consecutive states: arrays [steps, bodies], but for `time`."""

    time: Floats
    """[steps], s."""
    x: Floats
    y: Floats
    z: Floats
    yaw: Floats
    speed: Floats
    gap: Floats
    footprints: Footprints

    @classmethod
    def of(cls, states: Sequence[State], course: Course) -> Self:
        poses = np.array([state.poses for state in states])
        x, y, z, yaw = (np.ascontiguousarray(poses[:, :, axis]) for axis in range(4))
        sin, cos = sincos_all(yaw)
        halves = (np.broadcast_to(0.5 * course.sizes[:, axis], x.shape) for axis in (0, 1))
        return cls(
            time=np.array([state.time for state in states]),
            x=x,
            y=y,
            z=z,
            yaw=yaw,
            speed=np.array([state.speeds for state in states]),
            gap=np.array([state.gaps for state in states]),
            footprints=Footprints(x, y, cos, sin, *halves),
        )


def _rates(bodies: _BodyTracks) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the velocities along x and y, the accelerations and the rates of turn."""
    speed = bodies.speed
    vx, vy = speed * bodies.footprints.cos, speed * bodies.footprints.sin
    acceleration, turn_rate = np.zeros_like(speed), np.zeros_like(speed)
    if len(speed) > 1:
        steps_per_s = 1.0 / np.diff(bodies.time)[:, None]
        vx[1:] = np.diff(bodies.x, axis=0) * steps_per_s
        vy[1:] = np.diff(bodies.y, axis=0) * steps_per_s
        acceleration[1:] = np.diff(speed, axis=0) * steps_per_s
        turn = np.diff(bodies.yaw, axis=0)
        turn -= TAU * np.rint(turn * (1.0 / TAU))
        turn_rate[1:] = turn * steps_per_s
    return vx, vy, acceleration, turn_rate


def _times_to_collision(
    bodies: _BodyTracks, course: Course, vx: Floats, vy: Floats, s: Floats
) -> Floats:
    """Return the time to collision of every body with the ego; infinite for the ego."""
    ttc = np.full(vx.shape, np.inf)
    ego, others = (
        bodies.footprints.at(_ALL, slice(0, 1)),
        bodies.footprints.at(_ALL, slice(1, None)),
    )
    ttc[:, 1:] = time_to_collision(ego, others, vx[:, 1:] - vx[:, :1], vy[:, 1:] - vy[:, :1])
    ttc[:, 1:][bodies.gap[:, 1:] <= 0.0] = 0.0
    ground = np.interp(s, course.corridor.s, course.corridor.z)
    height = bodies.z - ground
    is_clear = (height > course.sizes[0, 2]) | (height + course.sizes[:, 2] < FLAT_M)
    ttc[is_clear | course.passable] = np.inf
    return ttc


def _headways(
    bodies: _BodyTracks, course: Course, s: Floats, t: Floats, road_cos: Floats, road_sin: Floats
) -> Floats:
    """Return the ego's time headway to every body; infinite for the ego."""
    body = bodies.footprints
    cos = np.abs(body.cos * road_cos + body.sin * road_sin)
    sin = np.abs(body.sin * road_cos - body.cos * road_sin)
    along = body.half_length * cos + body.half_width * sin
    across = body.half_length * sin + body.half_width * cos
    headway = np.full(s.shape, np.inf)
    headway[:, 1:] = time_headway(
        s[:, 1:] - s[:, :1],
        bodies.speed[:, :1],
        along[:, 1:] + along[:, :1],
        t[:, 1:] - t[:, :1],
        across[:, 1:] + across[:, :1],
    )
    headway[:, course.passable] = np.inf
    return headway


def _rounded(value: float) -> float | None:
    """Return a value to thousandths; `None` if it is not finite."""
    return round(float(value), 3) if np.isfinite(value) else None

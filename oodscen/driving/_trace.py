"""The ground truth of an episode as a table: one row per step and body, in SI units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._motion.world import ego_strip
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._surrogate_safety import (
    Floats,
    Footprints,
    overlap,
    post_encroachment,
    time_headway,
    time_to_collision,
)
from oodscen.errors import DataError, Issue, MissingExtra, UsageError
from oodscen.numerics._exact import sincos_all
from oodscen.protocols import State

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

COLUMNS: Mapping[str, str] = {
    "step": "steps since the start",
    "time": "s since the start",
    "id": "`ego`, or the actor's id",
    "x": "m, of the footprint's centre",
    "y": "m",
    "z": "m, of the footprint's underside",
    "yaw": "rad, counter-clockwise from the world's x axis",
    "speed": "m/s along the heading, negative in reverse",
    "vx": "m/s in the world: how far it came in the step; at the start, the speed along the heading",
    "vy": "m/s, likewise",
    "acceleration": "m/s^2: how much the speed changed in the step; 0 at the start",
    "lateral_acceleration": "m/s^2 to the left: speed times rate of turn in the step; 0 at the start",
    "s": "m along the road that the ego drives",
    "t": "m to the left of that road's reference line",
    "lane": "lanes to the left of the lane in which the ego started; null off these lanes",
    "gap_m": "m between its body and the ego's; null for the ego and far away",
    "ttc_s": "s until its footprint touches the ego's at constant velocities; null if never",
    "time_headway_s": "s that the ego takes to where its rear is now; null unless in the ego's path",
    "contact": "it touches the ego; for the ego: anything touches it",
    "off_road": "the ego left the drivable road; null for others",
    "length": "m, of the footprint",
    "width": "m, of the footprint",
    "height": "m, of the body",
}
"""All columns of the table in order, with their meanings."""

_INTEGERS = frozenset({"step"})
_NULLABLE = ("gap_m", "ttc_s", "time_headway_s")
_SUFFIXES = (".parquet", ".arrow", ".csv")


class Encounter(Data):
    """The closest encounter of the ego with one actor in a trace."""

    noun: ClassVar[str] = "encounter"

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


@dataclass(frozen=True, eq=False)
class Course:
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
        assets = {asset.id: asset for asset in catalogue.assets}
        cast = [catalogue.ego, *(assets[actor.asset] for actor in scene.actors)]
        sizes = np.array([(one.length, one.width, one.height) for one in cast])
        shown = ["", *(actor.state for actor in scene.actors)]
        passable = np.array(
            [one.is_passable(state) for one, state in zip(cast, shown, strict=True)]
        )
        corridor = load_corridor(find_map(scene.map, catalogue))
        return cls(corridor, ego_strip(corridor, scene.ego.lane), sizes, passable)


@dataclass(frozen=True, eq=False)
class Trace:
    """The states of an episode and the measures derived from them.

    Arrays are [steps, bodies], with the ego in column 0; infinity and NaN become null in tables.
    """

    ids: tuple[str, ...]
    """`ego`, then the actors in the scene's order."""
    columns: Mapping[str, NDArray[Any]]
    """Arrays by name of `COLUMNS`, except `id`."""

    @classmethod
    def of(cls, states: Sequence[State], scene: Scene, catalogue: Catalogue) -> Self:
        """Compute the ground truth of consecutive states.

        Args:
            states: The states in order, at least one.
            scene: The scene of the states.
            catalogue: The simulator's catalogue, for sizes and the map.

        Raises:
            UsageError: If there is no state.
        """
        return cls.measured(states, Course.of(scene, catalogue))

    @classmethod
    def measured(cls, states: Sequence[State], course: "Course") -> Self:
        """Compute the ground truth of consecutive states for a known course."""
        if not states:
            raise UsageError("a trace needs at least one state")
        corridor, sizes = course.corridor, course.sizes
        poses = np.array([state.poses for state in states])
        speed = np.array([state.speeds for state in states])
        gap = np.array([state.gaps for state in states])
        time = np.array([state.time for state in states])
        off_road = np.array([state.off_road for state in states])
        x, y, z, yaw = (np.ascontiguousarray(poses[:, :, axis]) for axis in range(4))
        sin, cos = sincos_all(yaw)
        vx, vy = speed * cos, speed * sin
        acceleration, turning = np.zeros_like(speed), np.zeros_like(speed)
        if len(states) > 1:
            rate = 1.0 / np.diff(time)[:, None]
            vx[1:], vy[1:] = np.diff(x, axis=0) * rate, np.diff(y, axis=0) * rate
            acceleration[1:] = np.diff(speed, axis=0) * rate
            turned = np.diff(yaw, axis=0)
            turned -= 6.283185307179586 * np.rint(turned * 0.15915494309189535)
            turning[1:] = turned * rate
        shape = speed.shape
        half_length, half_width = (np.broadcast_to(0.5 * sizes[:, i], shape) for i in (0, 1))
        prints = Footprints(x, y, cos, sin, half_length, half_width)
        s, t, road_cos, road_sin = places(corridor, x, y)
        ttc = np.full(shape, np.inf)
        headway = np.full(shape, np.inf)
        if shape[1] > 1:
            ego, others = (
                prints.at(slice(None), slice(0, 1)),
                prints.at(slice(None), slice(1, None)),
            )
            ttc[:, 1:] = time_to_collision(
                ego, others, vx[:, 1:] - vx[:, :1], vy[:, 1:] - vy[:, :1]
            )
            ttc[:, 1:][gap[:, 1:] <= 0.0] = 0.0
            is_above = z - np.interp(s, corridor.s, corridor.z) > sizes[0, 2]
            ttc[is_above | course.passable] = np.inf
            askew = np.abs(cos * road_cos + sin * road_sin)
            turned_away = np.abs(sin * road_cos - cos * road_sin)
            along = half_length * askew + half_width * turned_away
            across = half_length * turned_away + half_width * askew
            headway[:, 1:] = time_headway(
                s[:, 1:] - s[:, :1],
                speed[:, :1],
                along[:, 1:] + along[:, :1],
                t[:, 1:] - t[:, :1],
                across[:, 1:] + across[:, :1],
            )
            headway[:, course.passable] = np.inf
        contact = gap <= 0.0
        contact[:, 0] = contact[:, 1:].any(axis=1)
        steps = np.array([state.step for state in states])
        off = np.full(shape, np.nan)
        off[:, 0] = off_road
        columns = {
            "step": np.broadcast_to(steps[:, None], shape),
            "time": np.broadcast_to(time[:, None], shape),
            "x": x,
            "y": y,
            "z": z,
            "yaw": yaw,
            "speed": speed,
            "vx": vx,
            "vy": vy,
            "acceleration": acceleration,
            "lateral_acceleration": speed * turning,
            "s": s,
            "t": t,
            "lane": _lanes(corridor, course.strip, s, t),
            "gap_m": gap,
            "ttc_s": ttc,
            "time_headway_s": headway,
            "contact": contact,
            "off_road": off,
            **{
                name: np.broadcast_to(sizes[:, index], shape)
                for index, name in enumerate(("length", "width", "height"))
            },
        }
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
        prints = Footprints(
            columns["x"], columns["y"], cos, sin, 0.5 * columns["length"], 0.5 * columns["width"]
        )
        time = columns["time"][:, 0]
        dt = float(time[1] - time[0]) if len(time) > 1 else 0.0
        every = slice(None)
        others = prints.at(every, slice(1, None))
        pet = post_encroachment(prints.at(every, 0), others, dt)
        hit = columns["contact"][:, 1:].any(axis=0)
        # An actor that is driven over, through or under shares the ego's ground without a conflict.
        clear = overlap(prints.at(every, slice(0, 1)), others).any(axis=0)
        pet = np.where(hit, 0.0, np.where(clear, np.inf, pet))
        least = {name: columns[name][:, 1:].min(axis=0) for name in _NULLABLE}
        braking = -columns["acceleration"][:, 1:].min(axis=0)
        return {
            name: Encounter(
                actor=name,
                min_gap_m=_finite(least["gap_m"][row]),
                min_ttc_s=_finite(least["ttc_s"][row]),
                pet_s=_finite(pet[row]),
                min_time_headway_s=_finite(least["time_headway_s"][row]),
                max_deceleration=max(0.0, round(float(braking[row]), 3)),
            )
            for row, name in enumerate(self.ids[1:])
        }

    # ------------------------------------------------------------------ tables and files

    def to_arrow(self) -> "pa.Table":
        """Return an Arrow table, ordered by step and then by body.

        Raises:
            MissingExtra: If pyarrow is not installed.
        """
        pa = _pyarrow()
        data = {}
        for name in COLUMNS:
            if name == "id":
                ids = pa.array(list(self.ids), pa.string())
                rows = np.tile(np.arange(len(self.ids), dtype=np.int32), self.steps)
                data[name] = pa.DictionaryArray.from_arrays(pa.array(rows), ids)
                continue
            values = np.ascontiguousarray(self.columns[name]).reshape(-1)
            if name in _INTEGERS:
                data[name] = pa.array(values.astype(np.int32))
            elif name == "contact":
                data[name] = pa.array(values)
            elif name == "off_road":
                data[name] = pa.array(values == 1.0, mask=np.isnan(values))
            elif name == "lane":
                empty = np.isnan(values)
                data[name] = pa.array(np.where(empty, 0, values).astype(np.int32), mask=empty)
            else:
                data[name] = pa.array(values, mask=~np.isfinite(values))
        return pa.table(data)

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
            path: A path ending in `.parquet`, `.arrow` (an IPC file) or `.csv`.

        Raises:
            UsageError: For any other suffix.
            MissingExtra: If pyarrow is not installed.
        """
        target = _checked(path)
        table = self.to_arrow()
        if target.suffix == ".parquet":
            import pyarrow.parquet as parquet

            parquet.write_table(table, target)
        elif target.suffix == ".arrow":
            import pyarrow as pa

            with pa.OSFile(str(target), "wb") as sink, pa.ipc.new_file(sink, table.schema) as out:
                out.write_table(table)
        else:
            import pyarrow.csv as csv

            plain = table.set_column(2, "id", table["id"].cast("string"))
            csv.write_csv(plain, target)
        return target

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a table that `save` wrote.

        Raises:
            UsageError: For any other suffix.
            DataError: If the file is missing or is not a trace.
            MissingExtra: If pyarrow is not installed.
        """
        source, pa = _checked(path), _pyarrow()
        try:
            if source.suffix == ".parquet":
                import pyarrow.parquet as parquet

                table = parquet.read_table(source)
            elif source.suffix == ".arrow":
                with pa.OSFile(str(source), "rb") as file:
                    table = pa.ipc.open_file(file).read_all()
            else:
                import pyarrow.csv as csv

                table = csv.read_csv(
                    source,
                    convert_options=csv.ConvertOptions(column_types={"id": pa.string()}),
                )
        except (OSError, pa.ArrowException) as error:
            raise DataError("trace", [Issue("", str(error))], source=str(source)) from None
        return cls._from_table(table, str(source))

    @classmethod
    def _from_table(cls, table: "pa.Table", source: str) -> Self:
        missing = [name for name in COLUMNS if name not in table.column_names]
        if missing:
            faults = [Issue(name, "this column is missing") for name in missing]
            raise DataError("trace", faults, source=source)
        names = table["id"].cast("string").to_pylist()
        ids = tuple(dict.fromkeys(names))
        count = len(ids)
        if not count or len(names) % count or tuple(names) != ids * (len(names) // count):
            fault = Issue("id", "the rows are not every body's, step by step")
            raise DataError("trace", [fault], source=source)
        shape = (len(names) // count, count)
        columns = {
            name: _column(name, table[name].to_numpy(zero_copy_only=False)).reshape(shape)
            for name in COLUMNS
            if name != "id"
        }
        return cls(ids, columns)


def to_parquet(table: "pa.Table") -> bytes:
    """Return an Arrow table as the bytes of a Parquet file."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    sink = pa.BufferOutputStream()
    parquet.write_table(table, sink)
    return bytes(sink.getvalue())


def concatenated(traces: Mapping[str, Trace]) -> "pa.Table":
    """Return several traces as one Arrow table with their names in the first column, `phase`.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    pa = _pyarrow()
    tables = []
    for name, trace in traces.items():
        table = trace.to_arrow()
        table = table.set_column(2, "id", table["id"].cast(pa.string()))
        phase = pa.array([name] * len(trace), pa.string())
        tables.append(table.add_column(0, "phase", phase))
    return pa.concat_tables(tables)


def places(corridor: Corridor, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return s and t of many points on a road, and cosine and sine of the road's heading there.

    The places are the same as those from `Corridor.locate`.

    Args:
        corridor: The road.
        x: World x, m, of any shape.
        y: World y, m, of the same shape.
    """
    shape, px, py = x.shape, x.reshape(-1), y.reshape(-1)
    norm = np.sqrt(corridor.cos * corridor.cos + corridor.sin * corridor.sin)
    cos, sin, step = corridor.cos / norm, corridor.sin / norm, corridor.step
    last = len(corridor.s) - 2
    coarse = np.arange(0, last + 2, 16)
    square = (px[:, None] - corridor.x[coarse]) ** 2 + (py[:, None] - corridor.y[coarse]) ** 2
    index = np.minimum(coarse[square.argmin(axis=1)], last)
    for _ in range(40):
        before = (px - corridor.x[index]) * cos[index] + (py - corridor.y[index]) * sin[index]
        after = (px - corridor.x[index + 1]) * cos[index + 1]
        after += (py - corridor.y[index + 1]) * sin[index + 1]
        back = -1 - np.minimum((-before / (2.0 * step)).astype(np.intp), 16)
        on = 1 + np.minimum((after / (2.0 * step)).astype(np.intp), 16)
        shift = np.where(before < 0.0, back, np.where(after > 0.0, on, 0))
        moved = np.clip(index + shift, 0, last)
        if np.array_equal(moved, index):
            break
        index = moved
    x0, y0, c0, s0 = corridor.x[index], corridor.y[index], cos[index], sin[index]
    dx, dy = corridor.x[index + 1] - x0, corridor.y[index + 1] - y0
    dc, ds = cos[index + 1] - c0, sin[index + 1] - s0
    span = before - after
    f = np.where(span > 0.0, before / np.where(span > 0.0, span, 1.0), 0.0)
    for _ in range(4):
        ax, ay = px - x0 - f * dx, py - y0 - f * dy
        hc, hs = c0 + f * dc, s0 + f * ds
        along = ax * hc + ay * hs
        slope = ax * dc + ay * ds - dx * hc - dy * hs
        f = f - np.where(slope == 0.0, 0.0, along / np.where(slope == 0.0, 1.0, slope))
    is_before, is_after = before < 0.0, after > 0.0
    f = np.where(is_before, 0.0, np.where(is_after, 1.0, f))
    hc, hs = c0 + f * dc, s0 + f * ds
    length = np.sqrt(hc * hc + hs * hs)
    hc, hs = hc / length, hs / length
    ax, ay = px - x0 - f * dx, py - y0 - f * dy
    s = (index + f) * step
    s = np.where(is_before, before, np.where(is_after, corridor.length + after, s))
    t = ay * hc - ax * hs
    return s.reshape(shape), t.reshape(shape), hc.reshape(shape), hs.reshape(shape)


def _lanes(corridor: Corridor, strip: int, s: Floats, t: Floats) -> Floats:
    """Return the number of lanes from a strip to every place, left positive; NaN off the lanes."""
    lanes = np.full(s.shape, np.nan)
    position = np.clip(s / corridor.step, 0.0, len(corridor.s) - 1.0)
    index = np.minimum(position.astype(np.intp), len(corridor.s) - 2)
    f = position - index
    origin = corridor.driving.index(strip)
    is_along = (s >= 0.0) & (s <= corridor.length)
    for number, driving in enumerate(corridor.driving):
        one = corridor.strips[driving]
        right = one.right[index] + f * (one.right[index + 1] - one.right[index])
        left = one.left[index] + f * (one.left[index + 1] - one.left[index])
        lanes[is_along & (right <= t) & (t < left)] = number - origin
    return lanes


def _column(name: str, values: NDArray[Any]) -> NDArray[Any]:
    """Return a column in its in-memory form: null becomes infinity or NaN."""
    if name in _INTEGERS:
        return values.astype(np.int64)
    if name == "contact":
        return values.astype(bool)
    if name == "off_road":
        return np.array([np.nan if v is None or v != v else float(v) for v in values])
    array = values.astype(np.float64)
    return np.where(np.isnan(array), np.inf, array) if name in _NULLABLE else array


def _finite(value: "np.floating[Any] | float") -> float | None:
    return round(float(value), 3) if np.isfinite(value) else None


def _checked(path: str | Path) -> Path:
    target = Path(path)
    if target.suffix not in _SUFFIXES:
        raise UsageError(f"{target.name}: a trace is written as {', '.join(_SUFFIXES)}")
    return target


def _pyarrow() -> Any:
    try:
        import pyarrow
    except ImportError:
        raise MissingExtra("a trace as a table", "tables", "pyarrow") from None
    return pyarrow

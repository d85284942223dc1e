"""The form of states and frames, and the places of bodies in frames."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.data._scene import Scene
from oodscen.driving._sight.outlines import area, clipped
from oodscen.driving._sight.scene_checks import PlacedBody
from oodscen.driving._sight.visibility import Eye, UprightBox
from oodscen.protocols import Camera, Frame, State

INSIDE = 0.9
"""Least share of a body's pixels within its box's silhouette and its margin."""
MARGIN_PX = 3.0
"""Width of the margin around a silhouette in which a body's pixels may be."""
EXTENT = 0.55
"""Least extent of a box-like body's pixels across and down, as a share of its silhouette's."""
LEAST_PX = 30
"""Fewest pixels of a body that are looked at."""
_ROUNDING_S = 1e-6
"""Difference up to which a time is that of its step, s."""


def state_faults(scene: Scene, state: State, step: int, dt: float) -> Iterator[str]:
    """Yield what is wrong with the form of a state: ids, shapes, types, finite values, time."""
    ids = ("ego", *(actor.id for actor in scene.actors))
    count = len(ids)
    if not isinstance(state, State):
        yield f"returned a {type(state).__name__}, not a State"
        return
    if state.ids != ids:
        yield f"ids are {state.ids}, not {ids}"
    is_formed = True
    for name, array, shape in (
        ("poses", state.poses, (count, 4)),
        ("speeds", state.speeds, (count,)),
        ("gaps", state.gaps, (count,)),
        ("accelerations", state.accelerations, (count,)),
        ("places", state.places, (count, 2)),
    ):
        if array is None:
            if name not in ("accelerations", "places"):
                is_formed = False
                yield f"{name} is None"
            continue
        if fault := _array_fault(array, shape, np.float64):
            is_formed = False
            yield f"{name} is {fault}"
    if not is_formed:
        return
    if not (np.isfinite(state.poses).all() and np.isfinite(state.speeds).all()):
        yield "poses or speeds are not finite"
    if not (state.gaps >= 0.0).all():
        yield "a gap is negative or not a number"
    if not math.isinf(float(state.gaps[0])):
        yield "the ego's own gap must be infinite"
    if state.step != step:
        yield f"step is {state.step}, not {step}"
    if not abs(state.time - step * dt) < _ROUNDING_S:
        yield f"time is {state.time} after {step} steps"


def _array_fault(array: object, shape: tuple[int, ...], dtype: type[np.generic]) -> str:
    """Return how an array differs from a shape and type, or an empty string."""
    if not isinstance(array, np.ndarray):
        return f"a {type(array).__name__}, not {np.dtype(dtype)} {shape}"
    if array.shape != shape or array.dtype != dtype:
        return f"{array.dtype} {array.shape}, not {np.dtype(dtype)} {shape}"
    return ""


def frame_faults(frame: Frame, camera: Camera, bodies: int) -> Iterator[str]:
    """Yield what is wrong with the form of a picture of a scene with some bodies, the ego included."""
    size = (camera.height, camera.width)
    is_formed = True
    tags = np.zeros(size, np.uint8) if frame.tags is None else frame.tags
    for name, array, shape, kind in (
        ("rgb", frame.rgb, (*size, 3), np.uint8),
        ("depth", frame.depth, size, np.float32),
        ("ids", frame.ids, size, np.int32),
        ("tags", tags, size, np.uint8),
    ):
        if fault := _array_fault(array, shape, kind):
            is_formed = False
            yield f"{name} is {fault}"
    if not is_formed:
        return
    colours = colour_count(frame.rgb)
    if colours < 4:
        yield f"the picture is blank ({colours} colours)"
    if not ((frame.ids >= 0).all() and (frame.ids <= bodies).all()):
        yield "ids are not 0 (scenery), 1 (ego) or 2 + the actor's index"
    if not (frame.depth > 0.0).all():
        yield "depth must be positive, infinite for the sky"
    if not np.isfinite(frame.depth).any():
        yield "nothing has a finite depth"
    if not np.isfinite(frame.depth[frame.ids > 0]).all():
        yield "a pixel of a body has no finite depth"
    if tags[frame.ids > 0].any():
        yield "tags must be 0 at the pixels of bodies"
    if frame.unhidden is not None:
        visible = [int((frame.ids == row).sum()) for row in range(1, bodies + 1)]
        if np.shape(frame.unhidden) != (bodies,) or not np.all(frame.unhidden >= np.array(visible)):
            yield "unhidden must count at least the visible pixels of each body"


def place_faults(
    frame: Frame, camera: Camera, cast: Sequence[PlacedBody], drawn: Frame | None = None
) -> list[str]:
    """Return how the pixels and depths of bodies differ from their silhouettes.

    Without `drawn` all bodies are like their boxes, and none hides another. With it, a picture of the boxes by
    the library, a tenth of the pixels that it shows is enough, and extents are left out.
    """
    eye, faults = Eye(camera, cast[0].solid), []
    for row, body in enumerate(cast[1:], start=2):
        outline = eye.silhouette(body.solid)
        shown = clipped(outline, camera.width, camera.height)
        expected = area(shown) if drawn is None else float((drawn.ids == row).sum())
        if expected < LEAST_PX:
            continue
        mask = frame.ids == row
        if mask.sum() < (0.3 if drawn is None else 0.1) * expected:
            faults.append(f"shows {int(mask.sum())} of about {expected:.0f} pixels of {body.id!r}")
            continue
        if share_inside(mask, outline, MARGIN_PX) < INSIDE:
            faults.append(f"shows {body.id!r} beside its place or too large")
            continue
        rows, columns = np.nonzero(mask)
        for name, pixels, silhouette in (
            ("wide", columns, [u for u, _ in shown]),
            ("high", rows, [v for _, v in shown]),
        ):
            extent, full = float(np.ptp(pixels)) + 1.0, max(silhouette) - min(silhouette)
            if drawn is None and extent < EXTENT * full - 2.0:
                faults.append(f"shows {body.id!r} {extent:.0f} pixels {name}, not {full:.0f}")
                break
        low, high = depths(eye, body.solid)
        depth = float(np.median(frame.depth[mask]))
        if not low - 0.3 <= depth <= high + 0.3:
            faults.append(
                f"gives {body.id!r} a depth of {depth:.1f} m, not {low:.1f} to {high:.1f}"
            )
    return faults


def share_inside(
    mask: NDArray[np.bool_], outline: Sequence[tuple[float, float]], margin_px: float
) -> float:
    """Return the share of a body's pixels within the bounds of an outline and a margin; 0 if either is empty."""
    rows, columns = np.nonzero(mask)
    if not len(rows) or not outline:
        return 0.0
    us, vs = zip(*outline, strict=True)
    inside = (columns + 1.0 > min(us) - margin_px) & (columns < max(us) + margin_px)
    inside &= (rows + 1.0 > min(vs) - margin_px) & (rows < max(vs) + margin_px)
    return float(inside.mean())


def depths(eye: Eye, body: UprightBox) -> tuple[float, float]:
    """Return the least and the greatest depth of a body's corners, m."""
    corners = [eye.to_camera(corner)[2] for corner in body.corners()]
    return min(corners), max(corners)


def colour_count(rgb: NDArray[np.uint8]) -> int:
    """Return the number of different colours in a picture."""
    red, green, blue = (rgb[..., channel].astype(np.int64) for channel in range(3))
    return len(np.unique(red << 16 | green << 8 | blue))

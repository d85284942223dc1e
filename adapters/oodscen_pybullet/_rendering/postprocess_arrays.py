"""Postprocessing without numba: whole arrays instead of rows of pixels.

Arrays of colours are [3, height, width].
"""

import numpy as np

from oodscen_pybullet._rendering.optics import (
    CLOUD_GAIN,
    CLOUD_TINT,
    FARTHEST_M,
    HORIZON_M,
    OPAQUE,
    TINT_B,
    TINT_G,
    TINY,
    beam,
    cloud_share,
    fade,
    grain,
)
from oodscen_pybullet._rendering.plate import Plate
from oodscen_pybullet._rendering.triangles import GROUND, SHELTERED, SOFT
from oodscen_pybullet._types import F32, U8

_ONE, _HALF, _ZERO = np.float32(1.0), np.float32(0.5), np.float32(0.0)
_BEAM_TINT = np.array([1.0, TINT_G, TINT_B], np.float32).reshape(3, 1, 1)
_CLOUD_TINT = np.array(CLOUD_TINT, np.float32).reshape(3, 1, 1)


def postprocess_arrays(plate: Plate) -> U8:
    """Postprocess a picture without numba, like `postprocess_pixels` but without shadows, lamps and tunnels.

    Returns:
        [height, width, 3]
    """
    colours = plate.rgb.astype(np.float32) * _light(plate)
    if plate.wet > 0.0:
        is_wet = (plate.kinds & (GROUND | SHELTERED | SOFT)) == GROUND
        colours *= np.where(is_wet, plate.wet, _ONE)
    air = _lit_air(plate)
    if plate.air.rate > 0.0:
        colours = air + (colours - air) * _veil(plate)
    sky = _sky(plate)
    if plate.air.sky_through < _ONE:
        sky = air + (sky - air) * plate.air.sky_through
    colours += (sky - colours) * (plate.sky.astype(np.float32) * TINY)[None]
    if plate.has_grain:
        height, width = plate.reach.shape
        numbers = np.arange(height * width, dtype=np.uint32) + plate.noise
        colours += grain(numbers).reshape(height, width)
    done = np.clip(colours + _HALF, 0.0, 255.0).astype(np.uint8)
    return np.ascontiguousarray(np.moveaxis(done, 0, 2))


def _light(plate: Plate) -> F32:
    """Return the light of day and of the ego's low beams."""
    light = np.zeros((3, *plate.reach.shape), np.float32) + plate.daylight.direct.reshape(3, 1, 1)
    if plate.beam > 0.0:
        near = np.minimum(plate.reach, FARTHEST_M)
        rise = (plate.upwards * plate.axes[1, 2] + plate.axes[2, 2])[:, None]
        is_ground = (plate.kinds & (GROUND | SOFT)) == GROUND
        aloft = np.where(is_ground, _ZERO, plate.eye_height + near * rise)
        light += beam(near, aloft, plate.beam_spread[0][None, :], plate.beam)[None] * _BEAM_TINT
    return light


def _lit_air(plate: Plate) -> F32:
    """Return the colour of thick air in the ego's beams."""
    halo = plate.air.halo * plate.halo[:, None] * plate.beam_spread[1][None, :]
    return np.asarray(plate.air.colour.reshape(3, 1, 1) + halo[None])


def _veil(plate: Plate) -> F32:
    """Return the fraction of the light that the air lets through, [height, width]."""
    across, upwards = plate.across[None, :], plate.upwards[:, None]
    stretch = np.sqrt(_ONE + across * across + upwards * upwards)
    far = np.minimum(plate.reach, HORIZON_M) * stretch * plate.air.rate
    return np.asarray(fade(np.minimum(far, OPAQUE)))


def _sky(plate: Plate) -> F32:
    """Return the sky with its clouds."""
    cover, turn = plate.clouds, plate.cloud_columns
    low, between = plate.cloud_rows[:, 0].astype(np.int64), plate.cloud_rows[:, 1:]
    rows = cover.sheet[low] + (cover.sheet[low + 1] - cover.sheet[low]) * between
    column = turn.astype(np.int64)
    right = rows[:, column + 1] - rows[:, column]
    cloud = (rows[:, column] + right * (turn - column)).astype(np.float32)
    share = cloud_share(cloud, cover.edge, cover.floor)
    grey = (cloud * CLOUD_GAIN + cover.shade) * cover.bright
    blue = plate.clear_sky.T[:, :, None]
    return np.asarray(blue + (grey[None] * _CLOUD_TINT - blue) * share[None])

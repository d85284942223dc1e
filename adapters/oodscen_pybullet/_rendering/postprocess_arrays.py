"""Postprocessing without numba: whole arrays instead of rows of pixels."""

import numpy as np

from oodscen_pybullet._rendering import postprocess as d
from oodscen_pybullet._rendering.triangles import GROUND, SHELTERED, SOFT
from oodscen_pybullet._types import U8

_ONE, _HALF, _ZERO = np.float32(1.0), np.float32(0.5), np.float32(0.0)


def postprocess_arrays(plate: d.Plate) -> U8:
    """Postprocess a picture without numba, like `postprocess_pixels` but without shadows, lamps and tunnels.

    Returns:
        [height, width, 3]
    """
    settings, across, upwards = plate.settings, plate.across, plate.upwards
    reach, kinds, spread, heaven = plate.reach, plate.kinds, plate.spread, plate.heaven
    axes, halo, sheet = plate.axes, plate.halo, plate.sheet
    height, width = reach.shape
    rise = (upwards * axes[1, 2] + axes[2, 2])[:, None]
    near = np.minimum(reach, d.FARTHEST)
    aloft = np.where(
        (kinds & (GROUND | SOFT)) == GROUND, _ZERO, settings[d.EYE_HEIGHT] + near * rise
    )
    light = settings[d.DAY_R : d.DAY_B + 1].reshape(3, 1, 1) * np.ones(
        (1, height, width), np.float32
    )
    if settings[d.BEAM] > 0.0:
        bright = d.beam(near, aloft, spread[0][None, :], settings[d.BEAM])
        light += bright[None] * np.array([1.0, d.TINT_G, d.TINT_B], np.float32).reshape(3, 1, 1)
    colours = plate.rgb.astype(np.float32) * light
    if settings[d.WET] > 0.0:
        colours *= np.where((kinds & (GROUND | SHELTERED | SOFT)) == GROUND, settings[d.WET], _ONE)
    air = settings[d.AIR_R : d.AIR_B + 1].reshape(3, 1, 1)
    air = air + (settings[d.HALO] * halo[:, None] * spread[1][None, :])[None]
    if settings[d.RATE] > 0.0:
        stretch = np.sqrt(
            _ONE + across[None, :] * across[None, :] + upwards[:, None] * upwards[:, None]
        )
        far = np.minimum(reach, d.HORIZON) * stretch * settings[d.RATE]
        colours = air + (colours - air) * d.fade(np.minimum(far, d.OPAQUE))
    low, between = heaven[:, 3].astype(np.int64), heaven[:, 4:5]
    lines = sheet[low] + (sheet[low + 1] - sheet[low]) * between
    turn = spread[2].astype(np.int64)
    cloud = lines[:, turn] + (lines[:, turn + 1] - lines[:, turn]) * (spread[2] - turn)
    cloud = cloud.astype(np.float32)
    share = d.cloud_share(cloud, settings[d.CLOUD_EDGE], settings[d.CLOUD_FLOOR])
    grey = (cloud * d.CLOUD_GAIN + settings[d.CLOUD_SHADE]) * settings[d.CLOUD_BRIGHT]
    blue = heaven[:, :3].T[:, :, None]
    tones = np.array(d.CLOUD_TINT, np.float32).reshape(3, 1, 1)
    behind = blue + (grey[None] * tones - blue) * share[None]
    if settings[d.SKY_THROUGH] < _ONE:
        behind = air + (behind - air) * settings[d.SKY_THROUGH]
    colours += (behind - colours) * (plate.sky.astype(np.float32) * d.TINY)[None]
    if settings[d.GRAIN] > 0.0:
        numbers = np.arange(height * width, dtype=np.uint32) + np.uint32(settings[d.NOISE])
        colours += d.grain(numbers).reshape(height, width)
    done = np.clip(colours + _HALF, 0.0, 255.0).astype(np.uint8)
    return np.ascontiguousarray(np.moveaxis(done, 0, 2))

"""The ego's headlamps in a picture: their beams, and the glow of fog in front of them."""

import numpy as np

from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._rendering.optics import OPAQUE, fade
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32

FULL_DAY = 0.99
"""Daylight from which beams are not seen."""
_SPREADS = (0.42, 0.75)
"""Slopes to the side at which the ego's beams have fallen to 1 / e: on surfaces, and in the air."""
_HALO, _HALO_M = 104.0, 30.0
"""Brightness of thick fog in front of the ego's lamps, and the length at which fog of extinction 1 / length is thick, m."""
_HALO_ENDS = 0.6
"""Daylight above which fog has no halo."""
_HALO_BELOW, _HALO_HEIGHT = np.float32(0.06), np.float32(1.0 / 0.3)
"""Slope below the horizon up to which the halo is full, and 1 / the slope above that at which it is half."""
_HIGHEST = 8.0
"""Height above the halo, in units of that slope, from which the halo no longer falls."""
_BEAM = 1.15
"""Brightness of the ego's beams in the dark."""
_ONE = np.float32(1.0)


def beam(view: CameraView, light: Light) -> np.float32:
    """Return the brightness of the beams."""
    is_seen = view.is_lit and light.daylight < FULL_DAY
    return np.float32(_BEAM * (1.0 - light.daylight) if is_seen else 0.0)


def beam_spreads(across: F32) -> F32:
    """Return the lateral falloff of the beams by column, on surfaces and in the air: [2, width]."""
    return np.stack([_beam_spread(across, slope) for slope in _SPREADS])


def _beam_spread(across: F32, slope: float) -> F32:
    """Return the lateral falloff of the beams, [width]."""
    aside = across * np.float32(1.0 / slope)
    return np.asarray(fade(np.minimum(aside * aside, OPAQUE)), np.float32)


def halo(view: CameraView, light: Light, rate: float) -> np.float32:
    """Return the brightness of fog in front of the lamps, for air of an extinction in 1/m."""
    is_seen = light.daylight <= _HALO_ENDS and rate > 0.0 and view.is_lit
    thickness = min(1.0, rate * _HALO_M)
    return np.float32(_HALO * (1.0 - light.daylight) * thickness if is_seen else 0.0)


def halo_rows(upwards: F32) -> F32:
    """Return the share of the halo by row: [height]."""
    high = np.clip((upwards + _HALO_BELOW) * _HALO_HEIGHT, 0.0, _HIGHEST)
    return np.asarray(_ONE / (_ONE + high * high), np.float32)

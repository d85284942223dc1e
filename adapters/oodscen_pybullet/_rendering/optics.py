"""The arithmetic of light, air, clouds and grain, on 32-bit numbers: the bits do not depend on the processor.

Kernels call these functions with scalars; written with `np.minimum` and the like, they take arrays as well.
"""

from typing import Any

import numpy as np

from oodscen.numerics._kernels import inlined

_ONE, _HALF, _ZERO = np.float32(1.0), np.float32(0.5), np.float32(0.0)
TINT_G, TINT_B = np.float32(0.97), np.float32(0.88)
"""Green and blue of the ego's beams, relative to red."""
CLOUD_TINT = (np.float32(0.971), np.float32(0.984), _ONE)
"""Colour of clouds."""
FARTHEST_M = np.float32(400.0)
"""Distance beyond which lamps are alike, m."""
HORIZON_M = np.float32(1e6)
"""Distance that stands for none: of the sky, and of a portal that is not ahead, m."""
OPAQUE = np.float32(40.0)
"""Optical depth beyond which nothing is seen; the limit of `fade`."""
CLOUD_GAIN = np.float32(0.22)
"""Growth of a cloud's brightness with its density."""
_CLOUD_STEEP = np.float32(3.2)
"""1 / density above its beginning at which a cloud hides the sky."""
_LAMPS_M = np.float32(1.5)
"""Distance from the camera at which the ego's beams begin, and a metre before they are whole, m."""
_BEAM_HALVED = np.float32(1.0 / 36.0)
"""1 / distance at which the ego's beams are half as bright, 1/m."""
_CUT_OFF, _CUT_SOFT, _CUT_SPREAD = np.float32(0.9), np.float32(0.25), np.float32(0.03)
"""Height of the beams' cut-off, m; the width of its edge, m, and its growth per metre of distance."""
_STRAY, _BELOW = np.float32(0.42), np.float32(0.58)
"""Fractions of the beams that reach above their cut-off, and only below it."""
_GRAIN = 4
"""Largest grain, of 255."""
TINY = np.float32(1.0 / 255.0)
"""One step of a byte as a fraction."""
_LOW_BITS = np.uint64(0xFFFF_FFFF)


@inlined
def fade(optical_depth: Any) -> Any:
    """Return exp(-x) for 0 <= x <= 40, accurate to about 0.1 % where it matters."""
    y = optical_depth * np.float32(1.0 / 16.0)
    grown = _ONE + y * (
        _ONE + y * (_HALF + y * (np.float32(1.0 / 6.0) + y * np.float32(1.0 / 24.0)))
    )
    two = grown * grown
    four = two * two
    eight = four * four
    return _ONE / (eight * eight)


@inlined
def beam(near: Any, height: Any, spread: Any, strength: Any) -> Any:
    """Return the ego's low-beam light on a surface; the beams have a soft cut-off in height, and miss the bonnet."""
    reach = near * _BEAM_HALVED
    cut = (_CUT_OFF - height) / (_CUT_SOFT + near * _CUT_SPREAD)
    cut = np.minimum(np.maximum(cut, _ZERO), _ONE)
    before = np.minimum(np.maximum(near - _LAMPS_M, _ZERO), _ONE)
    return before * strength * spread / (_ONE + reach * reach) * (_STRAY + _BELOW * cut)


@inlined
def cloud_share(cloud: Any, edge: Any, floor: Any) -> Any:
    """Return the fraction of the blue sky hidden by a cloud of some density."""
    share = (cloud - edge) * _CLOUD_STEEP
    return np.maximum(np.minimum(np.maximum(share, _ZERO), _ONE), floor)


@inlined
def mixed(number: Any) -> Any:
    """Return 32 random bits as uint64, the same for the same number; uint32 in."""
    bits = np.uint64(number) * np.uint64(2654435761) & _LOW_BITS
    bits = (bits ^ (bits >> np.uint64(15))) * np.uint64(2246822519) & _LOW_BITS
    return bits ^ (bits >> np.uint64(13))


@inlined
def grain(number: Any) -> Any:
    """Return noise between -4 and 4 from a pixel's index; uint32 in."""
    return np.float32(mixed(number) % np.uint64(2 * _GRAIN + 1)) - np.float32(_GRAIN)

"""Meshes of bodies that pitch and roll."""

import numpy as np

from oodscen.numerics._exact import PI, sincos
from oodscen_pybullet._meshes.mesh import Mesh

Tilt = tuple[int, int, float]
"""Pitch and roll, degrees, and the height above the underside about which a body turns, m."""
UPRIGHT: Tilt = (0, 0, 0.0)
_STEP = 3
"""Degrees to which angles are rounded, so that meshes repeat."""


def tilt_of(pitch: float, roll: float, pivot: float) -> Tilt:
    """Return the tilt to draw for angles in rad; turns by less than a step stay upright."""
    degrees = [_STEP * round(angle * 180.0 / PI / _STEP) % 360 for angle in (pitch, roll)]
    return (degrees[0], degrees[1], pivot) if any(degrees) else UPRIGHT


def tilted(mesh: Mesh, tilt: Tilt) -> Mesh:
    """Return a mesh that is first rolled, then pitched (ISO 8855)."""
    sp, cp = sincos(tilt[0] * PI / 180.0)
    sr, cr = sincos(tilt[1] * PI / 180.0)
    rows = np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])
    pivot = (0.0, 0.0, tilt[2])
    return mesh.moved(rows, about=pivot, to=pivot)

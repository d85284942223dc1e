"""The table of drawn triangles, a row each: the depth kernel writes it, the shading kernel reads it.

Kernels take the columns as `rec.RED`: numba freezes the numbers at compile time.
"""

from typing import NamedTuple

from oodscen_pybullet._types import F32, I32

# Columns of `DrawnTriangles.records`. A value over depth is linear on the screen: it is stored at one point, with
# its slopes along the columns of pixels and the rows of samples.
COLUMN, ROW = 0, 1
"""That point on the grid of samples."""
NEARNESS, NEARNESS_X, NEARNESS_Y = 2, 3, 4
"""1 / depth, 1/m."""
U, U_X, U_Y = 5, 6, 7
"""Column of the texture, over depth."""
V, V_X, V_Y = 8, 9, 10
"""Row of the texture, over depth."""
LIGHT, LIGHT_X, LIGHT_Y = 11, 12, 13
"""Cosine between the normal and the light, over depth; only of unevenly lit triangles."""
RED, GREEN, BLUE = 14, 15, 16
"""Colour, 0 to 255, times the strength of the light; of textured triangles that strength alone."""
IS_UNEVEN = 17
"""1 if the light changes across the triangle, else 0."""
LIT = 18
"""Incidence of the sun on an evenly lit triangle, 0 (grazing) to 255 (perpendicular)."""
RECORD_WIDTH = 19

# Columns of `DrawnTriangles.labels`.
TEXTURE = 0
"""Region of the atlas, -1 for none."""
BODY = 1
"""Row of the actor, -1 for scenery."""
SURFACE = 2
"""Neighbours of one surface show no edge: a number for each look, or for each triangle that has its own."""
KIND = 3
"""Surface flags, `triangles.SHINING` and so on."""
CLASS = 4
"""Semantic class, `oodscen_pybullet._meshes.tags.Tag`."""
LABELS_WIDTH = 5

TUNNEL_AMBIENT, TUNNEL_DIFFUSE = 0.78, 0.22
"""Fractions of a tunnel's light that are ambient, and from the ceiling."""


class DrawnTriangles(NamedTuple):
    """The triangles that were drawn."""

    records: F32
    """[k, RECORD_WIDTH]"""
    labels: I32
    """[k, LABELS_WIDTH]"""

"""Round things made of bars or tubes: spoked wheels and tyres."""

import itertools

from oodscen.data._designs.colours import Colour
from oodscen.data._designs.shapes import Length, Point
from oodscen.numerics._exact import TAU, cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.parts import DrawnPart, Placing
from oodscen_pybullet._meshes.look import Appearance

_BARS = 14
"""Bars of the tyre of a spoked wheel; every other corner has a spoke."""
_RIM = 0.95
"""Radius of the middle of the tyre, as a share of the wheel's."""
_AROUND, _ACROSS = 18, 8
"""Faces of a torus around its axis and around its tube."""


class SpokedWheel(DrawnPart):
    """A thin wheel with spokes that rolls along x."""

    spoked_wheel: Point
    """Its centre."""
    radius: Length

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the tyre and the spokes."""
        add_spoked_wheel(mesh, place.point(self.spoked_wheel), _RIM * self.radius)


def add_spoked_wheel(
    mesh: MeshBuilder,
    centre: Point,
    radius: float,
    *,
    tyre: float = 0.05,
    spoke: float = 0.014,
    turned: float = 0.0,
) -> None:
    """Add the tyre and the spokes of an upright wheel that rolls along x.

    Args:
        mesh: The mesh.
        centre: The wheel's centre.
        radius: Radius of the middle of the tyre, m.
        tyre: Width of the tyre, m.
        spoke: Width of a spoke, m.
        turned: Fraction of a turn that it has rolled forwards.
    """
    x, y, z = centre
    turns = [TAU * k / _BARS - TAU * turned for k in range(_BARS)]
    rim = [(x + radius * cos(turn), y, z + radius * sin(turn)) for turn in turns]
    for start, end in itertools.pairwise([*rim, rim[0]]):
        mesh.beam(start, end, tyre, "tyre")
    for end in rim[::2]:
        mesh.beam(centre, end, spoke, "silver")


class Torus(DrawnPart):
    """A ring with a round cross-section that lies flat."""

    torus: Point
    """Its centre."""
    radius: Length
    """Radius of the circle in the middle of its tube."""
    thick: Length
    """Radius of the tube."""
    colour: Colour

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the faces."""
        centre, colour = place.point(self.torus), shown.colour(self.colour)
        circles = [self._circle(centre, TAU * k / _AROUND) for k in range(_AROUND)]
        for near, far in itertools.pairwise([*circles, circles[0]]):
            for k in range(_ACROSS):
                after = (k + 1) % _ACROSS
                mesh.polygon([near[k], far[k], far[after], near[after]], colour)

    def _circle(self, centre: Point, turn: float) -> list[Point]:
        """Return the corners of the cross-section at an angle."""
        x, y, z = centre
        corners = []
        for tilt in (TAU * k / _ACROSS for k in range(_ACROSS)):
            reach = self.radius + self.thick * cos(tilt)
            corners.append(
                (x + reach * cos(turn), y + reach * sin(turn), z + self.thick * sin(tilt))
            )
        return corners

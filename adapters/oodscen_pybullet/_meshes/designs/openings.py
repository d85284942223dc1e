"""Parts of vehicles that only details show: open doors, bonnet and boot, a tail lift, words on the sides."""

from oodscen.data._designs import shapes
from oodscen.data._designs.colours import Colour
from oodscen.data._designs.shapes import Length, Pair
from oodscen.numerics._exact import PI, cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.fittings import Fitting
from oodscen_pybullet._meshes.designs.parts import Placing, add
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.shapes import across, upright
from oodscen_pybullet._types import Point

_LINING = "light_grey"
_OFF_M = 0.012
"""Distance of a dark opening from the body that it is in, m."""
_DOOR_DEG, _BONNET_DEG, _HATCH_DEG, _REAR_DEG = 58.0, 58.0, 22.0, 12.0
"""Angles by which doors, a bonnet, a tailgate and rear doors are open."""


def _add_panel(mesh: MeshBuilder, corners: list[Point], outer: str, inner: str) -> None:
    """Add a thin panel; its corners are counter-clockwise seen from the outer side."""
    mesh.polygon(corners, outer).polygon(corners[::-1], inner)


def _on_side(side: float, corners: list[Point]) -> list[Point]:
    """Return the corners of the left side, or of its mirror image on the right."""
    return corners if side > 0 else [(x, -y, z) for x, y, z in corners[::-1]]


class FrontDoors(Fitting):
    """Both front doors, open."""

    front_doors: tuple[float, float, float]
    """x of the hinges, of the rear edge, and of the hinge-side end of the window's top."""
    y: Pair
    """Half the width at the belt and at the top of the windows."""
    z: tuple[float, float, float]
    """Sill, belt and top of the windows."""
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the dark openings, the seats in them, and the doors."""
        if not shown.has("doors_open"):
            return
        front, rear, tip = self.front_doors
        belt_y, top_y = self.y
        sill, belt, top = self.z
        paint, out = shown.colour(self.colour), belt_y + _OFF_M
        seat = front - 0.72 * (front - rear)
        for side in (1.0, -1.0):
            low = upright((front, out), (rear, out), sill, belt)
            high = [
                (front, out, belt), (rear, out, belt),
                (rear, top_y + 2 * _OFF_M, top), (tip, top_y + 2 * _OFF_M, top),
            ]  # fmt: skip
            for opening in (low, high):
                mesh.polygon(_on_side(side, opening), "black")
            back = [
                (seat + 0.3, out + _OFF_M, sill + 0.1), (seat, out + _OFF_M, sill + 0.1),
                (seat - 0.12, out + _OFF_M, belt), (seat + 0.06, out + _OFF_M, belt),
            ]  # fmt: skip
            mesh.polygon(_on_side(side, back), "grey")
            self._add_door(mesh, side, paint)

    def _add_door(self, mesh: MeshBuilder, side: float, paint: str) -> None:
        """Add the open door of a side: its panel, its window in a frame, and a red reflector."""
        front, rear, tip = self.front_doors
        sill, belt, top = self.z
        out, length = self.y[0], front - rear
        c, s = cos(PI * _DOOR_DEG / 180.0), sin(PI * _DOOR_DEG / 180.0)

        def at(share: float, height: float) -> Point:
            return front - share * length * c, out + share * length * s, height

        panel = [at(0, sill), at(0, belt), at(1, belt), at(1, sill)]
        _add_panel(mesh, _on_side(side, panel), paint, _LINING)
        inset = (front - tip) / length
        window = [at(0.02, belt), at(inset, top), at(0.98, top), at(0.98, belt)]
        _add_panel(mesh, _on_side(side, window), "glass_light", "glass_light")
        frame = [(at(0, belt), at(inset, top)), (at(inset, top), at(1, top))]
        frame += [(at(1, top), at(1, belt))]
        for start, end in frame:
            near, far = (_on_side(side, [point])[0] for point in (start, end))
            mesh.beam(near, far, 0.05, paint)
        edge = _on_side(side, [at(1, (sill + belt) / 2)])[0]
        mesh.box(edge, (0.03, 0.03, belt - sill), "red")


class OpenBonnet(Fitting):
    """A bonnet that stands open above its engine."""

    open_bonnet: Pair
    """x and z of the hinge."""
    front: Pair
    """x and z of the front edge of the closed bonnet."""
    half: Length
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the bonnet, the engine bay and a stay."""
        if not shown.has("bonnet_open"):
            return
        (x, z), (tip, low), half = self.open_bonnet, self.front, self.half
        length = tip - x
        c, s = cos(PI * _BONNET_DEG / 180.0), sin(PI * _BONNET_DEG / 180.0)
        far, high = x + length * c, z + length * s
        panel = [(x, half, z), (x, -half, z), (far, -0.9 * half, high), (far, 0.9 * half, high)]
        _add_panel(mesh, panel, shown.colour(self.colour), "dark_grey")
        bay = [
            (x, half, z + 0.015), (x, -half, z + 0.015),
            (tip, -0.9 * half, low + 0.015), (tip, 0.9 * half, low + 0.015),
        ]  # fmt: skip
        mesh.polygon(bay[::-1], "black")
        mesh.box((x + 0.5 * length, 0.0, low + 0.06), (0.5, 0.6, 0.2), "metal")
        mesh.box((x + 0.3 * length, -0.6 * half, z - 0.02), (0.3, 0.28, 0.14), "light_grey")
        mesh.box((x + 0.6 * length, 0.6 * half, low + 0.1), (0.2, 0.2, 0.14), "blue")
        mesh.beam(
            (tip - 0.1, 0.7 * half, low), (x + 0.8 * (far - x), 0.7 * half, z + 0.8 * (high - z)),
            0.03, "silver",
        )  # fmt: skip


class OpenHatch(Fitting):
    """A tailgate that is swung up over a full boot."""

    open_hatch: Pair
    """x and z of the hinge."""
    belt: tuple[float, float, float]
    """x, half the width and z of the rear window's lower edge."""
    sill: tuple[float, float, float]
    top_half: Length
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the gate, the dark boot and what is in it."""
        if not shown.has("boot_open"):
            return
        (x, z), top = self.open_hatch, self.top_half
        (bx, belt, bz), (sx, sill, sz) = self.belt, self.sill
        paint, off = shown.colour(self.colour), 2 * _OFF_M
        window = [
            (bx - off, belt, bz),
            (bx - off, -belt, bz),
            (x - off, -top, z),
            (x - off, top, z),
        ]
        mesh.polygon(window, "black")
        below = [
            (sx - off, sill, sz),
            (sx - off, -sill, sz),
            (bx - off, -belt, bz),
            (bx - off, belt, bz),
        ]
        mesh.polygon(below, "black")
        for y, wide, high, colour in (
            (0.3, 0.5, 0.42, "cardboard"), (-0.28, 0.46, 0.3, "blue"), (0.02, 0.14, 0.56, "red"),
        ):  # fmt: skip
            at = (sx + 0.02, y * sill / 0.7, sz + high / 2)
            mesh.box(at, (0.14, wide * sill / 0.7, high), colour)
        glass = self._length((x, z), (bx, bz))
        whole = glass + self._length((bx, bz), (sx, sz))
        c, s = -cos(PI * _HATCH_DEG / 180.0), sin(PI * _HATCH_DEG / 180.0)

        def panel(start: float, end: float, start_half: float, end_half: float) -> list[Point]:
            near_x, near_z, far_x, far_z = x + start * c, z + start * s, x + end * c, z + end * s
            return [
                (far_x, end_half, far_z), (far_x, -end_half, far_z),
                (near_x, -start_half, near_z), (near_x, start_half, near_z),
            ]  # fmt: skip

        _add_panel(mesh, panel(0.0, glass, top, belt), "glass", "glass")
        _add_panel(mesh, panel(glass, whole, belt, sill), paint, _LINING)
        for side in (1.0, -1.0):
            mesh.beam((x, side * top, z), (x + glass * c, side * belt, z + glass * s), 0.08, paint)
            mesh.beam(
                (bx, side * 0.95 * belt, bz), (x + 0.6 * glass * c, side * top, z + 0.6 * glass * s),
                0.035, "silver",
            )  # fmt: skip

    @staticmethod
    def _length(start: Pair, end: Pair) -> float:
        dx, dz = start[0] - end[0], start[1] - end[1]
        return float((dx * dx + dz * dz) ** 0.5)


class RearDoors(Fitting):
    """Both doors at the rear of a van or a lorry, wide open."""

    rear_doors: float
    """x of the rear."""
    half: Length
    z: Pair
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the dark hold, its load, and the doors."""
        if not shown.has("boot_open"):
            return
        x, half, (low, high) = self.rear_doors, self.half, self.z
        hold = across(x, half, low, high)
        mesh.polygon(hold, "black")
        size = 0.36 * (high - low)
        for y, z, colour in ((0.45, 0.0, "cardboard"), (-0.4, 0.0, "wood"), (0.35, 1.0, "sack")):
            at = (x - 0.01, y * half, low + (z + 0.5) * size)
            mesh.box(at, (0.04, 0.8 * half, 0.94 * size), colour)
        c, s = -cos(PI * _REAR_DEG / 180.0), sin(PI * _REAR_DEG / 180.0)
        for side in (1.0, -1.0):
            edge = (x + half * c, half + half * s)
            door = [
                (x, half, low), (x, half, high), (edge[0], edge[1], high), (edge[0], edge[1], low)
            ]  # fmt: skip
            _add_panel(mesh, _on_side(side, door), shown.colour(self.colour), _LINING)


class TailLift(Fitting):
    """A platform at the rear of a lorry, half lowered."""

    tail_lift: Pair
    """x of the rear, and z of the platform."""
    half: Length

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the platform with its striped edge, its arms and a load."""
        if not shown.has("tail_lift"):
            return
        (x, z), half = self.tail_lift, self.half
        mesh.box((x - 0.8, 0.0, z), (1.5, 2 * half, 0.09), "metal")
        edge = across(x - 1.56, half, z - 0.05, z + 0.05)
        mesh.textured_quad(edge, "stripes")
        for side in (1.0, -1.0):
            mesh.beam(
                (x + 0.1, side * 0.7 * half, 0.8), (x - 0.5, side * 0.7 * half, z), 0.1, "dark_grey"
            )
            mesh.box((x - 1.5, side * (half - 0.06), z + 0.06), (0.1, 0.1, 0.08), "red")
        mesh.box((x - 0.75, 0.3 * half, z + 0.4), (0.7, 0.8, 0.7), "cardboard")


class SideText(Fitting):
    """The words of the details on both sides."""

    side_text: Pair
    """Rear and front end."""
    y: Pair
    """Half the width at the lower and the upper edge."""
    z: Pair

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the words on white ground, readable from each side."""
        text = shown.details.text if shown.details else ""
        if not text:
            return
        (back, fore), (lower, upper), (low, high) = self.side_text, self.y, self.z
        for start, end, side in ((back, fore, -1.0), (fore, back, 1.0)):
            corners = (
                (start, side * lower, low), (end, side * lower, low),
                (end, side * upper, high), (start, side * upper, high),
            )  # fmt: skip
            sign = shapes.Text(text=text, on=corners, ink="black", paper="white")
            add(sign, mesh, shown, Placing())

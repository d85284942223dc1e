"""Parts of vehicles and animals that follow the look: shells, lamps, plates, prints, legs."""

from typing import Annotated

from pydantic import Field

from oodscen.data._designs.colours import Colour
from oodscen.data._designs.shapes import Length, Pair, Point
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs.parts import DrawnPart, Placing, Region, add_picture
from oodscen_pybullet._meshes.living.limbs import joint, limb, stride
from oodscen_pybullet._meshes.look import AMBER, BLUE, RED, WHITE, Appearance
from oodscen_pybullet._meshes.objects.signs import face
from oodscen_pybullet._meshes.shapes import across, upright

_AMBER_LAMP = ("amber", "amber_lit", "amber_core")
"""Colours of an indicator: dark, lit, and lit in its core."""
_WALK = {(-1.0, 0): 0.0, (-1.0, 1): 0.25, (1.0, 0): 0.5, (1.0, 1): 0.75}
"""Fraction of the stride at which a foot touches down, by side and pair, hind legs first."""
_GALLOP = {(-1.0, 0): 0.0, (1.0, 0): 0.12, (-1.0, 1): 0.5, (1.0, 1): 0.62}
"""The same in a gallop."""

_Section = tuple[float, Pair, Pair] | tuple[float, Pair, Pair, Pair]
"""x, then the right outline upwards as (half width, z)."""


class Fitting(DrawnPart):
    """A part with a place of its own in the whole, which is neither moved nor mirrored."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the part where it says."""
        self.fit(mesh, shown)

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the part to a mesh."""
        raise NotImplementedError


class Shell(Fitting):
    """A body that is symmetric about the x axis."""

    shell: Annotated[tuple[_Section, ...], Field(min_length=2)]
    """From rear to front."""
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the panels and both ends."""
        colour = shown.colour(self.colour)
        outlines: list[list[Point]] = []
        for x, *outline in self.shell:
            right = [(x, -width, z) for width, z in outline]
            left = [(x, width, z) for width, z in reversed(outline)]
            outlines.append(right + left)
        mesh.loft(outlines, [colour] * (len(outlines[0]) - 1))
        mesh.polygon(outlines[0], colour)
        mesh.polygon(outlines[-1][::-1], colour)


class Cab(Fitting):
    """A cab-over-engine cab of a lorry."""

    cab: float
    """x of its front."""
    depth: Length
    top: Length
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the cab with its windows, bumper and headlamps."""
        front, top, paint = self.cab, self.top, shown.colour(self.colour)
        rear, half = front - self.depth, 1.18
        mesh.hull((rear, front, -half, half, 0.5), (rear, front, -half, half, 1.45), paint)
        mesh.hull(
            (rear, front - 0.02, -half, half, 1.45),
            (rear, front - 0.22, -half + 0.05, half - 0.05, top - 0.3),
            paint,
            caps="",
            sides=("glass", "glass", "glass", paint),
        )
        mesh.hull(
            (rear, front - 0.2, -half + 0.04, half - 0.04, top - 0.32),
            (rear, front - 0.45, -half + 0.12, half - 0.12, top),
            paint,
            caps="t",
        )
        for x, tip, lean, width in (
            (front - 0.04, front - 0.22, 0.07, 0.1),
            (rear + 0.3, rear + 0.3, 0.05, 0.3),
        ):
            for side in (1.0, -1.0):
                foot = (x, side * (half - 0.02), 1.45)
                mesh.beam(foot, (tip, side * (half - lean), top - 0.28), width, paint)
        mesh.box((front - 0.05, 0, 0.55), (0.2, 2.34, 0.34), "dark_grey")
        mesh.textured_quad(across(front + 0.012, -0.7, 0.95, 1.35), "grille")
        HeadLamps(head_lamps=(front + 0.03, 0.82, 0.78), size=(0.34, 0.2)).fit(mesh, shown)
        for side in (-1.0, 1.0):
            mesh.box((front - 0.1, side * 1.28, 1.95), (0.1, 0.14, 0.5), "black")


class Chassis(Fitting):
    """The frame of a lorry between two x, with a striped bumper at the rear."""

    chassis: Pair

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the frame and the bumper."""
        rear, front = self.chassis
        mesh.box(((rear + front) / 2, 0, 0.74), (front - rear, 0.9, 0.3), "dark_grey")
        mesh.box((rear + 0.06, 0, 0.55), (0.1, 2.3, 0.16), "dark_grey")
        mesh.textured_quad(across(rear + 0.005, 1.1, 0.49, 0.61), "stripes")


class Underside(Fitting):
    """The underside of a car, which shows when it is overturned: axles, exhaust, tank, sump."""

    underside: Pair
    """x of the front and of the rear axle."""
    half: Length
    z: float

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the underside."""
        (front, rear), half, z = self.underside, self.half, self.z
        for x in (front, rear):
            mesh.beam((x, -half, z + 0.02), (x, half, z + 0.02), 0.09, "rust")
        mesh.beam((front, 0.12, z), (rear, 0.12, z), 0.08, "metal")
        mesh.beam((front - 0.3, -0.35, z), (rear - 0.7, -0.35, z), 0.08, "exhaust")
        mesh.box((rear - 0.45, -0.4, z + 0.06), (0.5, 0.3, 0.1), "dirty_hub")
        mesh.box((rear + 0.6, 0.35, z + 0.03), (0.7, 0.5, 0.1), "black")
        mesh.box((front + 0.15, 0, z + 0.03), (0.6, 0.5, 0.12), "dark_grey")


class Arches(DrawnPart):
    """The dark openings of two wheel arches."""

    arches: float
    """x of their middle."""
    half: Length
    """Half the width of the body."""
    radius: Length

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add both openings."""
        for side in (-1.0, 1.0):
            inner = (self.arches, side * (self.half - 0.15), self.radius + 0.01)
            outer = (self.arches, side * (self.half + 0.004), self.radius + 0.01)
            start, end = place.point(inner), place.point(outer)
            mesh.cylinder(start, end, self.radius, "black", sides=14)


class RearLamps(Fitting):
    """The tail, brake and indicator lamps on both sides of the rear."""

    rear_lamps: Point
    """The centre of the left tail lamp."""
    size: Pair
    """Width and height."""

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the lamps, lit or not."""
        lights, (x, y, z), (width, height) = shown.lights, self.rear_lamps, self.size
        low = z - height / 2 - 0.05
        for side in (-1.0, 1.0):
            at = (x, side * y, z)
            mesh.box((x + 0.006, side * y, z - 0.05), (0.05, width + 0.05, height + 0.15), "black")
            lit = ("brake_lit", "brake_core") if lights.brake else ("tail_lit", "tail_lit")
            is_lit = lights.brake or lights.running
            _lit_box(mesh, at, (0.06, width, height), ("tail", *lit), is_lit=is_lit)
            blinks = lights.left if side > 0 else lights.right
            _lit_box(mesh, (x, side * y, low), (0.06, width, 0.09), _AMBER_LAMP, is_lit=blinks)
            if is_lit:
                mesh.lamp(at, RED, (-1, 0, 0), 3.0 if lights.brake else 1.0)
            if blinks:
                mesh.lamp((x, side * (y + 0.05), low), AMBER, (-1, 0, 0), 3.0)


class HeadLamps(Fitting):
    """The headlamps and front indicators on both sides."""

    head_lamps: Point
    """The centre of the left headlamp."""
    size: Pair
    """Width and height."""

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the lamps, lit or not."""
        lights, (x, y, z), (width, height) = shown.lights, self.head_lamps, self.size
        for side in (-1.0, 1.0):
            is_lit = lights.running and not (side > 0 and shown.has("one_headlamp"))
            mesh.box((x, side * y, z), (0.06, width, height), "head_lit" if is_lit else "head")
            blinks = lights.left if side > 0 else lights.right
            outer = (x - 0.02, side * (y + width / 2 + 0.03), z)
            _lit_box(mesh, outer, (0.06, 0.07, height), _AMBER_LAMP, is_lit=blinks)
            if is_lit:
                mesh.lamp((x, side * y, z), WHITE, (1, 0, 0), 4.0)
            if blinks:
                mesh.lamp((x, outer[1], z), AMBER, (1, 0, 0), 3.0)


def _lit_box(
    mesh: MeshBuilder, at: Point, size: Point, names: tuple[str, str, str], *, is_lit: bool
) -> None:
    """Add a lamp with dark, lit and core colours; a lit one is larger and has a bright core."""
    dark, lit, core = names
    depth, width, height = size
    if not is_lit:
        mesh.box(at, size, dark)
        return
    mesh.box(at, (depth + 0.008, width + 0.03, height + 0.03), lit)
    mesh.box(at, (depth + 0.02, 0.6 * width, 0.6 * height), core)


class Beacon(DrawnPart):
    """An amber lamp that flashes while the beacon or the hazard lamps are on."""

    beacon: Point

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the lamp, lit or not."""
        lights, (x, y, z) = shown.lights, place.point(self.beacon)
        is_lit = (lights.left and lights.right) or (lights.beacon and not lights.is_second)
        mesh.cylinder((x, y, z), (x, y, z + 0.2), 0.1, "amber_lit" if is_lit else "amber", sides=8)
        if is_lit:
            mesh.lamp((x, y, z + 0.12), AMBER, (0, 0, 0), 3.0)


class LightBar(Fitting):
    """A beacon bar across the roof: blue on the right, red on the left."""

    light_bar: Pair
    """x and z of its foot."""
    half: Length
    """Half its width."""

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the bar; its halves are lit in turn."""
        lights, (x, z), half = shown.lights, self.light_bar, self.half
        mesh.box((x, 0, z + 0.02), (0.3, 2 * half, 0.05), "dark_grey")
        for side, dark, bright, glow in (
            (-1.0, "beacon", "beacon_lit", BLUE),
            (1.0, "beacon_red", "beacon_red_lit", RED),
        ):
            is_lit = lights.beacon and (side > 0) == lights.is_second
            centre = side * half * 0.56
            colour = bright if is_lit else dark
            mesh.box((x, centre, z + 0.105), (0.26, half * 0.85, 0.13), colour)
            if is_lit:
                mesh.lamp((x, centre, z + 0.1), glow, (0, 0, 0), 4.0)
        mesh.box((x, 0, z + 0.105), (0.22, half * 0.22, 0.11), "light_grey")


class Plates(Fitting):
    """Both number plates, each at its x and z."""

    plates: Pair
    """The rear one."""
    front: Pair | None = None

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the plates."""
        x, z = self.plates
        mesh.textured_quad(across(x, 0.27, z - 0.065, z + 0.065), "plate_rear")
        if self.front:
            x, z = self.front
            mesh.textured_quad(across(x, -0.27, z - 0.065, z + 0.065), "plate")


class RearPrint(DrawnPart):
    """A region printed on the rear, from -y to y."""

    rear_print: Region
    x: float
    y: Length
    z: Pair

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the print."""
        add_picture(mesh, across(self.x, self.y, *self.z), self.rear_print, place)


class FrontPrint(DrawnPart):
    """A region printed on the front, from -y to y."""

    front_print: Region
    x: float
    y: Length
    z: Pair

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the print."""
        add_picture(mesh, across(self.x, -self.y, *self.z), self.front_print, place)


class Octagon(DrawnPart):
    """The octagonal face of a sign, which looks along -x."""

    octagon: Region
    centre: Point
    half: Length
    """Half the height of the region's square."""
    forward: bool = False
    """True if it looks along x instead."""

    def add(self, mesh: MeshBuilder, shown: Appearance, place: Placing) -> None:
        """Add the face."""
        centre = place.point(self.centre)
        face(mesh, centre, self.half, self.octagon, corners=8, is_forward=self.forward)


class SidePrint(Fitting):
    """A region printed on both sides, readable from each."""

    side_print: Region
    x: Pair
    """Rear and front end."""
    y: Length
    z: Pair

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the prints."""
        (back, fore), y, (low, high) = self.x, self.y, self.z
        for start, end, side in ((back, fore, -y), (fore, back, y)):
            mesh.textured_quad(upright((start, side), (end, side), low, high), self.side_print)


class Legs(Fitting):
    """Four legs that stand, walk or gallop."""

    legs: Pair
    """x of the hind and of the fore legs."""
    y: Length
    """Half the distance between left and right legs."""
    top: Length
    """Height of the joints at the body."""
    thick: Length
    """Radius at the top."""
    colours: tuple[Colour, Colour]
    """Colours of the legs, and of the hooves or paws."""
    half_stride: Length = 0.26
    """Distance ahead of its joint at which a walking foot lands, as a fraction of `top`."""

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the legs in the phase of the stride."""
        top, thick, hoof = self.top, self.thick, 0.07 * self.top
        drop = 0.0 if shown.gait is None else 0.06 * top
        for pair, hip in enumerate(self.legs):
            for side in (-1.0, 1.0):
                ahead, up = self._step(shown, side, pair)
                start = (hip, side * self.y, top - drop)
                end = (hip + ahead, side * self.y, hoof + up)
                bend = (-1.0 if pair == 0 else 0.6, 0.0, 0.0)
                knee, foot = joint(start, end, 0.48 * (top - hoof), 0.53 * (top - hoof), bend)
                leg, paw = self.colours
                radii = (thick, 0.6 * thick, 0.45 * thick)
                limb(mesh, (start, knee, foot), radii, (leg, leg))
                mesh.box(
                    (foot[0] + 0.2 * thick, foot[1], foot[2] - 0.5 * hoof),
                    (1.5 * thick, 1.1 * thick, hoof),
                    paw,
                )

    def _step(self, shown: Appearance, side: float, pair: int) -> tuple[float, float]:
        """Return how far a foot is ahead of its joint, and above the ground, m."""
        if shown.gait is None:
            return (0.05 if pair == 0 else 0.0) * side * self.top, 0.0
        touch_down, reach, lift, stance = (
            (_GALLOP, 1.5, 0.3, 0.4) if shown.gait.runs else (_WALK, 1.0, 0.14, 0.6)
        )
        phase = shown.gait.phase - touch_down[side, pair]
        return stride(phase, reach * self.half_stride * self.top, lift * self.top, stance)


class WebbedFeet(Fitting):
    """The two legs of a water bird."""

    webbed_feet: Length
    """Half the distance between the legs."""
    top: Length
    """Height of the joints at the body."""
    colour: Colour

    def fit(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the legs in the phase of the stride."""
        phase, _ = shown.gait or (0.0, False)
        for side in (-1.0, 1.0):
            y, ahead, up = side * self.webbed_feet, side * 0.02, 0.0
            if shown.gait is not None:
                ahead, up = stride(phase + 0.25 * (1 + side), 0.1, 0.06, 0.6)
            mesh.cylinder((0, y, self.top), (ahead, y, 0.03 + up), 0.022, self.colour, sides=6)
            mesh.hull(
                (ahead - 0.03, ahead + 0.12, y - 0.06, y + 0.06, up),
                (ahead - 0.02, ahead + 0.06, y - 0.02, y + 0.02, up + 0.04),
                self.colour,
            )

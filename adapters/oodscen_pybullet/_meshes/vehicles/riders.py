"""People on two wheels, facing x; cyclists pedal."""

from oodscen.numerics._exact import PI, TAU, cos, sin
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import add_design
from oodscen_pybullet._meshes.living.body import Clothes
from oodscen_pybullet._meshes.living.figure import Posture, figure
from oodscen_pybullet._meshes.living.seated import Riding, add_rider
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._types import Point

_CRANK_M = 0.16
"""Length of a crank, m."""
_STANCE_M = 0.14
"""Distance of a pedal from the bicycle's middle, m."""
_BEHIND_M, _ABOVE_M = 0.03, 0.1
"""Place of the ankle relative to the pedal, m."""
_FIRST_TURN = 0.6
"""Angle of the right crank at the start of the cycle, rad; the left one is opposite."""
_BICYCLES = ("blue", "red", "teal")


def _pedalling(shown: Appearance, hub: Point) -> tuple[Point, Point]:
    """Return the positions of the ankles on the pedals, right first."""
    phase, _ = shown.gait or (0.0, False)
    turn = _FIRST_TURN - TAU * phase
    return _ankle(hub, -_STANCE_M, turn), _ankle(hub, _STANCE_M, turn + PI)


def _ankle(hub: Point, aside: float, turn: float) -> Point:
    """Return the position of an ankle, given the angle of its crank."""
    x, _, z = hub
    return (
        x - _BEHIND_M + _CRANK_M * cos(turn),
        aside,
        z + _ABOVE_M + _CRANK_M * sin(turn),
    )


def cyclist(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person with a helmet on a bicycle."""
    add_design(mesh, "_bicycle", shown.painted(_BICYCLES[shown.index]))
    top = ("fluor_yellow", "shirt_red", "shirt_white")[shown.index]
    riding = Riding((-0.22, 0, 1.0), (0.34, 0.26, 1.05))
    feet = _pedalling(shown, (-0.12, 0, 0.32))
    add_rider(mesh, Clothes(top, "trousers", hat="white"), riding, feet)


def cargo_bike(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person on a long bicycle with a big wooden box in front."""
    add_design(mesh, "_cargo_bike", shown)
    riding = Riding((-0.62, 0, 0.98), (-0.14, 0.28, 1.05), lean=0.12)
    feet = _pedalling(shown, (-0.5, 0, 0.30))
    add_rider(mesh, Clothes("shirt_green", "jeans", hat="white"), riding, feet)


def e_scooter(mesh: MeshBuilder, shown: Appearance) -> None:
    """A person standing on an electric scooter."""
    top = ("shirt_red", "shirt", "fluor_yellow")[shown.index]
    clothes = Clothes(top, "jeans", hat=("", "white", "black")[shown.index])
    posture = Posture((0.40, 0.22, 1.0), (0.40, -0.22, 1.0), lean=0.04)
    figure(mesh, clothes, Appearance(), posture)
    mesh.shift((-0.1, 0, 0.17))
    add_design(mesh, "_e_scooter", shown)


def motorcycle(mesh: MeshBuilder, shown: Appearance) -> None:
    """A motorcycle with its rider."""
    add_design(mesh, "_motorcycle", shown)
    riding = Riding((-0.3, 0, 0.94), (0.42, 0.34, 1.04), lean=0.34)
    feet = ((-0.06, -0.17, 0.44), (-0.06, 0.17, 0.44))
    add_rider(mesh, Clothes("black", "trousers", hat=shown.paint), riding, feet)


VARIED = (cyclist, cargo_bike, e_scooter, motorcycle)

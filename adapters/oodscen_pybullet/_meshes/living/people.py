"""People on foot, as `people.toml` describes them, and what only looks like one."""

import math
import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import add_design
from oodscen_pybullet._meshes.designs.parts import Placing
from oodscen_pybullet._meshes.living.body import Clothes
from oodscen_pybullet._meshes.living.figure import UPRIGHT, Posture, figure
from oodscen_pybullet._meshes.living.poses import pose_of
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._types import Point


class Person(BaseModel):
    """A person of the catalogue; what it wears, holds and pushes are names of designs."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    looks: Annotated[tuple[Clothes, ...], Field(min_length=1)]
    """Clothes by the index of the look, which starts again after the last."""
    posture: Posture = UPRIGHT
    worn: Annotated[tuple[str, ...], Field(min_length=1)] = ("",)
    """Worn on the body, measured from the ground; by the index of the look, as clothes are."""
    at_head: str = ""
    """Worn on the trunk, measured from the centre of the head."""
    on_head: str = ""
    """Worn on the head; its paint is the hair."""
    holds: str = ""
    """In the hands, unless a pose needs them."""
    pushes: str = ""
    behind: float = 0.0
    """Distance behind what is pushed, m."""
    scale: Annotated[float, Field(gt=0)] = 1.0
    """Height relative to an adult."""

    def add(self, mesh: MeshBuilder, shown: Appearance) -> None:
        """Add the person in a look, in the step and the pose of its details."""
        clothes = self.looks[shown.index % len(self.looks)]
        worn = self.worn[shown.index % len(self.worn)]

        def on_trunk(body: MeshBuilder, head: Point) -> None:
            _add(body, worn)
            _add(body, self.at_head, head)

        def on_head(body: MeshBuilder, head: Point) -> None:
            _add(body, self.on_head, head, clothes.hair)

        figure(mesh, clothes, shown, self.posture, worn=on_trunk, on_head=on_head)
        if pose_of(shown.details) is None:
            _add(mesh, self.holds)
        mesh.grounded().shift((-self.behind, 0.0, 0.0), scale=self.scale)
        _add(mesh, self.pushes)


def _add(mesh: MeshBuilder, design: str, to: Point = (0.0, 0.0, 0.0), paint: str = "") -> None:
    """Add a design, if there is one."""
    if design:
        add_design(mesh, design, Appearance(paint=paint), Placing(to))


@cache
def load_people() -> dict[str, Person]:
    """Return all people by the ids of their assets."""
    text = files(__package__).joinpath("people.toml").read_text("utf-8")
    return TypeAdapter(dict[str, Person]).validate_python(tomllib.loads(text))


def person_lying(mesh: MeshBuilder) -> None:
    """A person lying on their back on the road, arms and legs apart."""
    body = MeshBuilder()
    clothes = Clothes("shirt", "jeans", sleeves="skin")
    figure(body, clothes, Appearance(), Posture((0.06, 0.62, 1.5), (0.06, -0.62, 1.08)))
    facing_left = MeshBuilder().add_surface(body.build(), yaw=math.pi / 2).build()
    mesh.add_surface(facing_left, (0.0, 0.0, 0.14), roll=math.pi / 2).flatten(0.0)


def mannequin(mesh: MeshBuilder) -> None:
    """A white, faceless shop-window dummy on a stand, facing -x."""
    doll, white = MeshBuilder(), "plastic"
    clothes = Clothes("purple", white, sleeves=white, hair=white, skin=white, shoes=white)
    figure(doll, clothes, Appearance(), Posture((0.3, 0.36, 1.2), (0.1, -0.42, 0.98)))
    doll.grounded().shift((0.0, 0.0, 0.04))
    add_design(doll, "_mannequin")
    mesh.add_surface(doll.build(), yaw=math.pi)


STILL = (person_lying, mannequin)

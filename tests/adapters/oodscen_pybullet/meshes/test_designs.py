import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oodscen_pybullet._meshes import _STILL, _VARIED, paints_of
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.designs import CONTEXT, Design, assemble, load_designs
from oodscen_pybullet._meshes.living.people import load_people
from oodscen_pybullet._meshes.look import Appearance
from oodscen_pybullet._meshes.mesh import Mesh
from pydantic import ValidationError

places = st.tuples(*[st.integers(-40, 40).map(lambda tenths: tenths / 10)] * 3)
sizes = st.integers(1, 20).map(lambda tenths: tenths / 10)


@st.composite
def parts(draw: st.DrawFn) -> dict[str, Any]:
    """Draw a part that is a closed body."""
    start, size, colour = draw(places), draw(sizes), draw(st.sampled_from(["red", "paint"]))
    end = tuple(value + draw(sizes) for value in start)
    kind = draw(st.sampled_from(["box", "beam", "cylinder", "ball", "hull"]))
    return {
        "box": {"box": start, "size": (size, 1, 2 * size)},
        "beam": {"beam": start, "to": end, "width": size},
        "cylinder": {"cylinder": start, "to": end, "radius": size, "sides": 8},
        "ball": {"ball": start, "radii": (size, 1, 2 * size)},
        "hull": {
            "hull": (start[0], end[0], start[1], end[1], start[2]),
            "top": (start[0], end[0], start[1], end[1], end[2]),
        },
    }[kind] | {"colour": colour}


def built(monkeypatch: pytest.MonkeyPatch, *some: dict[str, Any], **options: object) -> Mesh:
    """Return the mesh of a design that is made of some parts."""
    design = Design.model_validate({"parts": some, **options}, context=CONTEXT)
    monkeypatch.setattr("oodscen_pybullet._meshes.designs.load_designs", lambda: {"made": design})
    return assemble("made", Appearance(paint="blue")).build()


def corners(vertices: NDArray[np.float64]) -> set[tuple[float, ...]]:
    """Return the distinct vertices to the micrometre."""
    return {tuple(row) for row in (vertices.round(6) + 0.0).tolist()}


def volume(mesh: Mesh) -> float:
    """Return the volume inside a closed mesh whose triangles face outwards."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


@given(parts())
def test_both_sides_are_mirror_images_that_face_outwards(part: dict[str, Any]) -> None:
    with pytest.MonkeyPatch.context() as patch:
        one, two = built(patch, part), built(patch, {"both_sides": [part]})
    right = two.vertices[: len(one.vertices)]
    assert corners(right * (1, -1, 1)) == corners(one.vertices)
    assert volume(one) > 0.0
    assert volume(two) == pytest.approx(2.0 * volume(one), rel=1e-6)
    assert (two.normals**2).sum(axis=1) == pytest.approx(1.0)


@given(parts(), places, st.integers(2, 4))
def test_a_row_is_a_list_of_copies_and_each_is_the_part_moved(
    part: dict[str, Any], step: tuple[float, float, float], count: int
) -> None:
    offsets = [tuple(k * value for value in step) for k in range(count)]
    with pytest.MonkeyPatch.context() as patch:
        one = built(patch, part)
        row = built(patch, {"repeat": count, "step": step, "parts": [part]})
        copies = built(patch, {"at": offsets, "parts": [part]})
        moved = built(patch, {"at": offsets[-1:], "parts": [{"at": [(0, 0, 0)], "parts": [part]}]})
    assert np.array_equal(row.vertices, copies.vertices)
    assert np.array_equal(row.vertices[-len(one.vertices) :], moved.vertices)
    assert moved.vertices == pytest.approx(one.vertices + offsets[-1], abs=1e-9)


def test_a_condition_chooses_by_state_and_by_the_lamp_of_the_own_side() -> None:
    lamp = {"lamp": (0, 1, 1), "light": (1, 1, 1)}
    with pytest.MonkeyPatch.context() as patch:
        part = {"both_sides": [{"when": "indicator", "parts": [lamp]}]}
        design = Design.model_validate({"parts": [part]}, context=CONTEXT)
        patch.setattr("oodscen_pybullet._meshes.designs.load_designs", lambda: {"made": design})
        for state, frame, sides in (
            ("indicate_left", 0, [1.0]),
            ("indicate_right", 0, [-1.0]),
            ("hazard+brake", 0, [-1.0, 1.0]),
            ("hazard", 1, []),
            ("", 0, []),
        ):
            mesh = assemble("made", Appearance(state, frame=frame))
            assert [
                one.position[1] for one in mesh.box((0, 0, 0), (1, 1, 1), "red").build().lamps
            ] == sides


@pytest.mark.parametrize(
    ("part", "place"),
    [
        ({"box": (0, 0, 0), "size": (1, 1, 0), "colour": "red"}, "size"),
        ({"box": (0, 0, 0), "size": (1, 1, 1), "colour": "reddish"}, "colour"),
        ({"box": (0, 0, 0), "size": (1, 1, 1), "colour": "red", "tilt": 3}, "tilt"),
        ({"box": (0, 0), "size": (1, 1, 1), "colour": "red"}, "box"),
        ({"both_sides": [{"plates": (0, 0)}]}, "both_sides"),
        ({"rear_print": "sign", "x": 0, "y": 1, "z": (0, 1)}, "rear_print"),
        ({"sphere": (0, 0, 0)}, "parts"),
        ({"lathe": ((0, 0, 0, 1), (0, 0, 1, 1)), "colours": ("red", "blue")}, "lathe"),
        ({"column": ((0, 0, 0, 1, 1), (0, 0, 1, 1, 1))}, "column"),
    ],
)
def test_what_the_schema_does_not_know_is_refused_with_its_place(
    part: dict[str, Any], place: str
) -> None:
    with pytest.raises(ValidationError) as caught:
        Design.model_validate({"parts": [part]}, context=CONTEXT)
    assert place in caught.value.errors()[0]["loc"]


class Recorded(dict[str, Design]):
    """Designs that note which of them are asked for."""

    asked: set[str]

    def __getitem__(self, name: str) -> Design:
        self.asked.add(name)
        return super().__getitem__(name)


def asked_by_code(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the designs that assets made by code consist of."""
    designs = Recorded(load_designs())
    designs.asked = set()
    monkeypatch.setattr("oodscen_pybullet._meshes.designs.load_designs", lambda: designs)
    for still in _STILL.values():
        still(MeshBuilder())
    for asset, varied in _VARIED.items():
        varied(MeshBuilder(), Appearance(paint=paints_of(asset)[0]))
    return designs.asked


def test_components_exist_and_are_used(monkeypatch: pytest.MonkeyPatch) -> None:
    designs = load_designs()
    text = "".join(design.model_dump_json() for design in designs.values())
    named = {*re.findall(r'"asset":"([^"]+)"', text), *asked_by_code(monkeypatch)}
    for person in load_people().values():
        worn = (*person.worn, person.at_head, person.on_head, person.holds, person.pushes)
        named |= {*worn} - {""}
    assert named <= set(designs)
    assert {name for name in designs if name.startswith("_")} <= named

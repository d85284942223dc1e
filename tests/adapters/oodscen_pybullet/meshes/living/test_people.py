import numpy as np
import pytest
from oodscen_pybullet._meshes import paints_of
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.living.people import Person, load_people
from oodscen_pybullet._meshes.look import Appearance
from pydantic import ValidationError

LOOK = {"top": "shirt", "legs": "jeans"}


def extent(person: Person) -> list[float]:
    mesh = MeshBuilder()
    person.add(mesh, Appearance())
    low, high = mesh.bounds
    return [*low.tolist(), *high.tolist()]


@pytest.mark.parametrize(
    "table",
    [
        {"looks": []},
        {"looks": [LOOK | {"cape": "red"}]},
        {"looks": [LOOK], "posture": {"left_foot": [0, 0, 0]}},
        {"looks": [LOOK], "hat": "red"},
        {"looks": [LOOK], "worn": []},
        {"looks": [LOOK], "scale": 0.0},
    ],
)
def test_a_table_that_describes_no_person_is_refused(table: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Person.model_validate(table)


def test_every_look_of_a_person_has_clothes_of_its_own() -> None:
    for asset, person in load_people().items():
        assert len(person.looks) == len(set(person.looks)) == len(paints_of(asset))


def test_people_stand_on_the_ground_at_their_scale() -> None:
    adult, small = Person.model_validate({"looks": [LOOK]}), {"looks": [LOOK], "scale": 0.5}
    whole, half = extent(adult), extent(Person.model_validate(small))
    assert whole[2] == half[2] == 0.0
    assert np.allclose(np.array(whole) / 2, half)

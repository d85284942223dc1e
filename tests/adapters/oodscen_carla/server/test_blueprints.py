import pytest
from oodscen_carla._catalogue import load_catalogue
from oodscen_carla.server import _blueprints
from oodscen_carla.server._blueprints import BlueprintLibrary
from oodscen_pybullet._catalogue import load_catalogue as load_drawn

CARLA, DRAWN = load_catalogue(), load_drawn()
LIBRARY = BlueprintLibrary(CARLA, DRAWN)
TRUCKS, BUSES = {"lorry", "pickup_truck"}, {"public_transport"}
BODIES = [one for one in (DRAWN.ego, *DRAWN.assets) if one.category == "vehicle"]


def base_type(name: str) -> str:
    return next(one[2] for one in LIBRARY[name].attributes if one[0] == "base_type")


@pytest.mark.parametrize("asset", BODIES, ids=lambda asset: asset.id)
def test_lorries_are_trucks_and_those_that_carry_the_public_are_none(asset) -> None:
    name, tags = f"vehicle.oodscen.{asset.id}", {*asset.tags}
    if tags & TRUCKS:
        assert (LIBRARY[name].tag, base_type(name)) == (15, "truck")
    elif tags & BUSES:
        assert LIBRARY[name].tag in (16, 17)
    elif "automobile" in tags:
        assert (LIBRARY[name].tag, base_type(name)) == (14, "car")


def test_vehicles_of_every_base_type_have_its_class_and_wheels() -> None:
    for name in [name for _, name, _, _ in LIBRARY.definitions if name.startswith("vehicle.")]:
        kind = base_type(name)
        wheels = next(one[2] for one in LIBRARY[name].attributes if one[0] == "number_of_wheels")
        assert kind in ("", _blueprints._BASE_TYPES.get(LIBRARY[name].tag))
        assert wheels == ("2" if kind in ("motorcycle", "bicycle") else "4")


def test_classes_are_those_of_the_client() -> None:
    carla = pytest.importorskip("carla")
    labels = {int(one) for one in carla.CityObjectLabel.names.values()}
    assert {*_blueprints._TAGS.values(), *_blueprints._TAG_OF_WORD.values()} <= labels

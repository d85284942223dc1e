"""The catalogue of `FlatSimulator`: every shared asset id as a coloured box."""

from oodscen.data._catalogue import Asset, Catalogue, WeatherRange
from oodscen.data._category import Category
from oodscen.data._weather import PRECIPITATIONS
from oodscen.driving._motion.behaviours.table import BEHAVIOURS
from oodscen.driving.maps._shipped import SHIPPED_MAPS

_LIGHTS = ("off", "brake", "hazard", "indicate_left", "indicate_right", "unlit")
_BEACON = (*_LIGHTS, "beacon")
_ARROWS = ("left", "right")

_ASSETS: tuple[tuple[Category, str, str, float, float, float, tuple[str, ...]], ...] = (
    ("vehicle", "car", "a compact car", 4.3, 1.8, 1.5, _LIGHTS),
    ("vehicle", "van", "a delivery van", 5.6, 2.0, 2.4, _LIGHTS),
    ("vehicle", "truck", "a lorry with a box body", 9.0, 2.5, 3.6, _LIGHTS),
    ("vehicle", "bus", "a city bus", 12.0, 2.55, 3.1, _LIGHTS),
    ("vehicle", "police_car", "a police car", 4.7, 1.85, 1.6, _BEACON),
    ("vehicle", "ambulance", "an ambulance", 6.0, 2.1, 2.6, _BEACON),
    ("vehicle", "fire_truck", "a fire engine", 8.5, 2.5, 3.3, _BEACON),
    ("vehicle", "motorcycle", "a motorcycle with a rider", 2.2, 0.8, 1.6, _LIGHTS),
    ("vehicle", "tractor", "a farm tractor", 4.5, 2.3, 2.8, _LIGHTS),
    ("vehicle", "overturned_car", "a car that lies on its roof", 4.3, 1.8, 1.4, _LIGHTS),
    ("vehicle", "overturned_truck", "a lorry that lies on its side", 9.0, 3.6, 2.5, _LIGHTS),
    ("vehicle", "excavator", "an excavator", 7.0, 2.6, 3.0, _LIGHTS),
    ("vehicle", "trailer", "a caravan with its drawbar", 5.5, 2.2, 2.4, ()),
    ("cyclist", "cyclist", "a person on a bicycle", 1.8, 0.6, 1.75, ()),
    ("pedestrian", "adult", "an adult on foot", 0.5, 0.55, 1.75, ()),
    ("pedestrian", "child", "a child on foot", 0.35, 0.4, 1.2, ()),
    ("pedestrian", "worker", "a road worker in a bright vest", 0.5, 0.55, 1.8, ()),
    ("pedestrian", "police_officer", "a police officer on foot", 0.5, 0.55, 1.8, ()),
    ("animal", "deer", "a deer", 1.8, 0.5, 1.5, ()),
    ("animal", "dog", "a dog", 0.9, 0.3, 0.6, ()),
    ("animal", "cow", "a cow", 2.3, 0.8, 1.5, ()),
    ("object", "cardboard_box", "a large cardboard box", 1.0, 1.0, 0.9, ()),
    ("object", "plant_pot", "a big plant pot", 0.7, 0.7, 1.1, ()),
    ("object", "tyre", "a lost tyre", 0.7, 0.7, 0.25, ()),
    ("object", "mattress", "a mattress", 2.0, 1.4, 0.25, ()),
    ("object", "sofa", "a sofa", 0.9, 2.0, 0.85, ()),
    ("object", "pallet", "a wooden pallet", 1.2, 0.8, 0.15, ()),
    ("object", "ladder", "an aluminium ladder", 3.0, 0.45, 0.12, ()),
    ("object", "rock", "a fallen rock", 1.1, 0.9, 0.8, ()),
    ("object", "debris", "scattered debris", 1.6, 1.2, 0.3, ()),
    ("object", "shopping_cart", "a shopping cart", 1.0, 0.6, 1.0, ()),
    ("object", "suitcase", "a suitcase", 0.75, 0.5, 0.3, ()),
    ("object", "wheelie_bin", "a wheelie bin", 0.7, 0.6, 1.1, ()),
    ("object", "snow_pile", "a pile of snow", 2.5, 2.0, 1.0, ()),
    ("object", "puddle", "a large puddle", 4.0, 2.5, 0.02, ()),
    ("object", "car_door", "a car's door", 1.1, 0.12, 1.1, ()),
    ("object", "ball", "a ball", 0.3, 0.3, 0.3, ()),
    ("object", "plastic_bag", "a plastic bag", 0.4, 0.3, 0.3, ()),
    ("work_zone", "cone", "a traffic cone", 0.4, 0.4, 0.75, ()),
    ("work_zone", "barrier", "a red and white barrier", 0.5, 2.0, 1.0, ()),
    ("work_zone", "arrow_board", "an arrow board on a trailer", 1.5, 2.2, 2.8, _ARROWS),
    ("work_zone", "road_closed_sign", "a road closed sign", 0.4, 1.2, 1.6, ()),
    ("work_zone", "detour_sign", "a detour sign", 0.4, 1.0, 1.6, ()),
    ("vegetation", "fallen_tree", "a fallen tree", 1.6, 7.0, 1.3, ()),
    ("vegetation", "branch", "a broken branch", 0.8, 2.6, 0.5, ()),
)
"""Columns: category, id, description, length, width, height, states."""

FLAT_CATALOGUE = Catalogue(
    simulator="flat",
    version="1",
    ego=Asset(
        id="ego_car",
        category="vehicle",
        description="the vehicle under test",
        length=4.5,
        width=1.85,
        height=1.5,
    ),
    assets=tuple(
        Asset(
            id=name,
            category=category,
            description=description,
            length=length,
            width=width,
            height=height,
            tags=("caravan",) if name == "trailer" else (),
            states=states,
        )
        for category, name, description, length, width, height, states in _ASSETS
    ),
    behaviours=BEHAVIOURS,
    maps=SHIPPED_MAPS,
    weather=WeatherRange(
        min_sun_elevation_deg=-90.0,
        min_fog_visual_range_m=20.0,
        precipitation=PRECIPITATIONS,
        max_precipitation_mm_h=50.0,
        min_friction=0.1,
    ),
)
"""The catalogue of `FlatSimulator`."""

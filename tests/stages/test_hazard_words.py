"""The visible part of a hazard: thing, place and motion, each told once."""

from oodscen_pybullet._catalogue import load_catalogue

from oodscen.data._scene import Actor
from oodscen.driving._roads.building import read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.stages._hazard_words import visible_of
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene
from tests.mirrors import mirrored_map, swapped


def seen(map=None, ego=None, **changes):
    scene = example_scene()
    (box,) = scene.actors
    place = box.placement.model_copy(update=changes)
    actors = (box.model_copy(update={"placement": place}),)
    return visible_of(
        actors,
        scene.hazard,
        scene.weather,
        ego or scene.ego,
        map or scene.map,
        FlatSimulator().catalogue(),
    )


def test_places_are_told_as_the_ego_sees_them():
    wheres = {
        "in the ego's lane": {},
        "beside the ego's lane on the right": {"offset_m": -3.0},
        "beside the ego's lane on the left": {"offset_m": 2.0},
        "in the oncoming lane": {"lane": 1},
        "behind the ego vehicle": {"ahead_m": -20.0},
    }
    for where, changes in wheres.items():
        (one,) = seen(**changes)
        assert (one.what, one.where) == ("large cardboard box", where)
        assert one.doing == "standing still"


def test_poses_are_told_as_what_somebody_does_and_parts_as_what_is_seen():
    scene, catalogue = example_scene(), load_catalogue()
    told = []
    for asset, details in (
        ("adult", {"pose": "kneel", "holds": "cone"}),
        ("car", {"parts": ["bonnet_open"], "colour": "pink"}),
    ):
        actors = tuple(
            Actor.parse({**actor.model_dump(), "asset": asset, "details": details})
            for actor in scene.actors
        )
        told += visible_of(actors, scene.hazard, scene.weather, scene.ego, scene.map, catalogue)
    assert [(one.what, one.doing) for one in told] == [
        (
            "adult on foot, holding an orange traffic cone with white bands",
            "kneeling on the ground",
        ),
        ("passenger car, painted pink, with its bonnet open", "standing still"),
    ]


def test_lanes_of_an_own_map_and_of_left_hand_traffic_are_told_by_their_direction(tmp_path):
    scene = example_scene()
    one_way, avenue = (
        next(road for road in SHIPPED_MAPS if road.id == name)
        for name in ("urban_three_lane", "urban_avenue")
    )
    for road, lanes in (
        (one_way, {1: "in a lane to the left"}),
        (avenue, {1: "in a lane to the left", 2: "in the oncoming lane"}),
    ):
        plain, mirrored = tmp_path / f"{road.id}.xodr", tmp_path / f"{road.id}-mirrored.xodr"
        plain.write_bytes(read_map(road.file))
        mirrored.write_bytes(mirrored_map(read_map(road.file)))
        for lane, where in lanes.items():
            told = [
                seen(
                    map=str(path), ego=scene.ego.model_copy(update={"lane": ego}), lane=side * lane
                )
                for path, ego, side in ((plain, 0, 1), (mirrored, road.lanes - 1, -1))
            ]
            assert [one.where for (one,) in told] == [
                where,
                swapped(where),
            ]

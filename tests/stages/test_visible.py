"""The visible part of a hazard: thing, place and motion, each told once."""

from oodscen.stages._visible import visible_of
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene


def seen(**changes):
    scene = example_scene()
    (box,) = scene.actors
    place = box.placement.model_copy(update=changes)
    actors = (box.model_copy(update={"placement": place}),)
    return visible_of(
        actors,
        scene.hazard,
        scene.weather,
        (scene.ego.lane, scene.ego.speed),
        scene.map,
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

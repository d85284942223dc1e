import pytest

from oodscen.data import Scene
from oodscen.errors import UnknownComponent, UsageError
from oodscen.gymnasium._scene_set import SceneSet
from oodscen.testing import example_scene


def named(name: str) -> Scene:
    return example_scene().model_copy(update={"id": name})


def test_twins_follow_their_scenes_and_are_found_even_if_they_are_not_drawn():
    scenes = [named("a"), named("b")]
    assert SceneSet(scenes, twins=True).ids == ("a", "a~twin", "b", "b~twin")
    drawn = SceneSet(scenes, twins=False)
    assert drawn.ids == ("a", "b")
    assert drawn.find("b") == (scenes[1], False)
    assert drawn.find("b~twin") == (scenes[1], True)


def test_a_twin_among_the_scenes_is_a_scene_without_a_twin():
    twin = example_scene().twin(2.0)
    scenes = SceneSet([twin], twins=True)
    assert scenes.ids == (twin.id,)
    assert scenes.find(twin.id) == (twin, False)
    with pytest.raises(UnknownComponent):
        scenes.find(f"{twin.id}~twin")


@pytest.mark.parametrize("name", ["", "c", "c~twin", "a~demand", "a~twin~twin", "x" * 500])
def test_other_ids_are_refused_with_those_that_there_are(name):
    with pytest.raises(UnknownComponent, match="a~twin") as caught:
        SceneSet([named("a")], twins=True).find(name)
    assert len(str(caught.value)) < 200


def test_a_scene_with_the_id_of_a_twin_is_refused_where_twins_are_drawn():
    scenes = [named("a"), named("a~twin")]
    assert SceneSet(scenes, twins=False).find("a~twin") == (scenes[1], False)
    for order in (scenes, scenes[::-1]):
        with pytest.raises(UsageError, match="a~twin"):
            SceneSet(order, twins=True)


def test_scenes_are_copied():
    scene = named("a")
    assert SceneSet([scene], twins=False).find("a")[0] is not scene

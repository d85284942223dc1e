import pytest

from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.errors import SceneError
from oodscen.interchange._tags import KNOWN_TAGS, count_tags, openlabel, scene_tags
from tests.driving.networks import file, lane, road
from tests.interchange.staging import SCENES, catalogue, doing


def test_tags_agree_with_the_scene():
    for scene in SCENES:
        tags, weather = scene_tags(scene, catalogue()), scene.weather
        assert ("LowLightNight" in tags) == (weather.sun_elevation_deg < -6)
        assert ("WeatherRain" in tags) == (weather.precipitation == "rain")
        assert tags.get("weatherSnowValue", 0.0) == (
            weather.precipitation_mm_h if weather.precipitation == "snow" else 0.0
        )
        assert ("RoadTypeMotorway" in tags) == (scene.map == "highway")
        assert ("LongitudinalUpSlope" in tags) == (scene.map == "rural_hill")
        assert ("SpecialStructureTunnel" in tags) == (scene.map == "tunnel")
        categories = {catalogue().asset(actor.asset).category for actor in scene.actors}
        assert ("RoadUserAnimal" in tags) == ("animal" in categories)
        assert sum(tag in tags for tag in ("HorizontalCurves", "HorizontalStraights")) == 1


@pytest.mark.parametrize(
    "lacking", ["assets", "behaviours"], ids=["without assets", "without behaviours"]
)
def test_a_simulator_that_lacks_something_of_the_scene_is_told(lacking):
    scene = next(scene for scene in SCENES if scene.actors)
    with pytest.raises(SceneError, match=r"actors\[0\]: the simulator has no '"):
        scene_tags(scene, catalogue().model_copy(update={lacking: ()}))


@pytest.mark.parametrize(("rule", "direction"), [("RHT", "Right"), ("LHT", "Left")])
def test_the_side_of_traffic_is_that_of_the_road(tmp_path, rule, direction):
    data = file(road("1", 400.0, right=lane(-1), left=lane(1)))
    path = tmp_path / "own.xodr"
    path.write_bytes(data.replace(b"<road ", f'<road rule="{rule}" '.encode()))
    scene = SCENES[0].model_copy(update={"map": str(path), "actors": ()})
    tags = [tag for tag in scene_tags(scene, catalogue()) if tag.startswith("TravelDirection")]
    assert tags == [f"TravelDirection{direction}"]


def test_an_actor_that_keeps_its_lane_changes_none():
    kept = doing(BUILT_IN["cut_in"].kind)
    behaviour = kept.actors[0].behaviour.model_copy(update={"parameters": {"lanes": 0.0}})
    actor = kept.actors[0].model_copy(update={"behaviour": behaviour})
    tags = scene_tags(kept.model_copy(update={"actors": (actor,)}), catalogue())
    assert not [tag for tag in tags if tag.startswith("MotionLaneChange")]


def test_every_behaviour_that_moves_a_road_user_has_its_tags():
    assert {name for name, row in BUILT_IN.items() if not row.tags} == {"open_door"}


def test_a_document_has_every_tag_once_with_its_value():
    for scene in SCENES:
        body = openlabel(scene, catalogue())["openlabel"]
        tags = {tag["type"]: tag for tag in body["tags"].values()}
        assert len(tags) == len(body["tags"])
        assert {tag["ontology_uid"] for tag in tags.values()} == set(body["ontologies"])
        for name, value in scene_tags(scene, catalogue()).items():
            assert name[0].isupper() == (value is None)
            assert name[0].isupper() or name[0].upper() + name[1:].removesuffix("Value") in tags
            data = tags[name].get("tag_data", {"num": [{"val": None}]})
            assert data["num"][0]["val"] == value


def test_every_tag_is_known_and_counted_once_per_scene():
    tags_of_scenes = [scene_tags(scene, catalogue()) for scene in SCENES]
    known = [tag for tags in KNOWN_TAGS.values() for tag in tags]
    assert len(known) == len(set(known))
    assert {tag for tags in tags_of_scenes for tag in tags if tag[0].isupper()} <= set(known)
    counted = count_tags(SCENES, catalogue())
    assert counted.scenes == len(SCENES)
    for row in counted.rows:
        assert row.scenes == sum(row.tag in tags for tags in tags_of_scenes)
    missing = {row.tag for row in counted.holes}
    assert all((f"  {tag} " in str(counted)) != (tag in missing) for tag in known)

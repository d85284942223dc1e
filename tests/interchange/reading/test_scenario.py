import json
from dataclasses import replace
from functools import cache
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from oodscen import make_llm
from oodscen._words.text import whole
from oodscen.errors import AnswerError, DataError, OodscenError, UsageError
from oodscen.interchange import read_openscenario
from oodscen.interchange._reading.scenario import foresee
from oodscen.interchange._recording import ordinary_twin
from oodscen.interchange._writing.scenario import MODES, to_openscenario
from oodscen.testing import ScriptedLLM
from tests.interchange.reading.files import IN_FOLDER, entity, file, lane, notes, read, start
from tests.interchange.staging import SCENES, catalogue

FOREIGN = """<OpenSCENARIO>
  <FileHeader revMajor="1" revMinor="0" date="2020-01-01T00:00:00" author="x" description="x"/>
  <ParameterDeclarations>
    <ParameterDeclaration name="kph" parameterType="double" value="54"/>
    <ParameterDeclaration name="speed" parameterType="double" value="${$kph / 3.6}"/>
    PARAMETERS
  </ParameterDeclarations>
  <CatalogLocations/>
  <RoadNetwork><LogicFile filepath="road.xodr"/></RoadNetwork>
  <Entities>
    <ScenarioObject name="Ego"><Vehicle name="a" vehicleCategory="car"/></ScenarioObject>
    <ScenarioObject name="Other">ENTITY</ScenarioObject>
  </Entities>
  <Storyboard>
    <Init><Actions>
      <GlobalAction><EnvironmentAction><Environment name="e">
        <TimeOfDay animation="false" dateTime="2020-01-01T12:00:00"/>
        <Weather cloudState="overcast"><Sun azimuth="0" elevation="0.5" intensity="1"/>
          <Fog visualRange="150"/><Precipitation precipitationType="rain" intensity="0.1"/></Weather>
        <RoadCondition frictionScaleFactor="0.7"/>
      </Environment></EnvironmentAction></GlobalAction>
      <Private entityRef="Ego">
        <PrivateAction><TeleportAction><Position>
          <LanePosition roadId="1" laneId="-1" s="210"/></Position></TeleportAction></PrivateAction>
        <PrivateAction><LongitudinalAction><SpeedAction>
          <SpeedActionDynamics dynamicsShape="step" dynamicsDimension="time" value="0"/>
          <SpeedActionTarget><AbsoluteTargetSpeed value="$speed"/></SpeedActionTarget>
        </SpeedAction></LongitudinalAction></PrivateAction>
      </Private>
      <Private entityRef="Other">
        <PrivateAction><TeleportAction><Position>PLACE</Position></TeleportAction></PrivateAction>
        <PrivateAction><LongitudinalAction><SpeedAction>
          <SpeedActionDynamics dynamicsShape="step" dynamicsDimension="time" value="0"/>
          <SpeedActionTarget><AbsoluteTargetSpeed value="START"/></SpeedActionTarget>
        </SpeedAction></LongitudinalAction></PrivateAction>
      </Private>
    </Actions></Init>
    <Story name="s"><Act name="a"><ManeuverGroup maximumExecutionCount="1" name="g">
      <Actors selectTriggeringEntities="false"><EntityRef entityRef="Other"/></Actors>
      <Maneuver name="m"><Event name="e" priority="overwrite">
        <Action name="x"><PrivateAction>ACTION</PrivateAction></Action>
        <StartTrigger><ConditionGroup>
          <Condition name="c" delay="0" conditionEdge="rising">CONDITION</Condition>
        </ConditionGroup></StartTrigger>
      </Event></Maneuver></ManeuverGroup></Act></Story>
    <StopTrigger/>
  </Storyboard>
</OpenSCENARIO>
"""
DEFAULTS = {
    "PARAMETERS": "",
    "ENTITY": '<Vehicle name="b" vehicleCategory="car"/>',
    "PLACE": '<LanePosition roadId="1" laneId="-1" s="240"/>',
    "START": "10",
    "ACTION": """<LongitudinalAction><SpeedAction>
        <SpeedActionDynamics dynamicsShape="linear" dynamicsDimension="rate" value="6"/>
        <SpeedActionTarget><AbsoluteTargetSpeed value="0"/></SpeedActionTarget>
      </SpeedAction></LongitudinalAction>""",
    "CONDITION": """<ByValueCondition>
        <SimulationTimeCondition value="2" rule="greaterThan"/></ByValueCondition>""",
}


@pytest.fixture
def foreign(tmp_path):
    """Return a function that reads a file of somebody else with parts replaced."""
    road = to_openscenario(
        next(scene for scene in SCENES if scene.map == "urban_three_lane"), catalogue()
    ).road
    (tmp_path / "road.xodr").write_bytes(road.content)

    def read(text=FOREIGN, **parts):
        for name, value in {**DEFAULTS, **parts}.items():
            text = text.replace(name, value)
        path = tmp_path / "Some File.xosc"
        path.write_text(text)
        return read_openscenario(path, catalogue())

    return read


@pytest.mark.parametrize("mode", MODES)
def test_an_export_gives_back_its_scene(mode, tmp_path):
    for scene in SCENES[:: {"replay": 2, "reactive": 3, "logical": 10}[mode]]:
        found = read_openscenario(
            to_openscenario(scene, catalogue(), mode=mode).save(tmp_path), catalogue()
        )
        assert found.scene == scene
        assert found.scene.to_json() == scene.to_json()
        assert not found.omissions


@cache
def exported(mode):
    return to_openscenario(SCENES[0], catalogue(), mode=mode)


@given(st.data())
@IN_FOLDER
@pytest.mark.parametrize("mode", MODES)
def test_an_export_with_any_changed_attribute_is_no_unchanged_one(mode, tmp_path, data):
    file = exported(mode)
    root = etree.fromstring(file.xosc)
    header = set(root.find("FileHeader").iter())
    places = [(one, name) for one in root.iter() if one not in header for name in one.attrib]
    element, name = data.draw(st.sampled_from(places))
    element.set(name, f"{element.get(name)}1")
    path = replace(file, xosc=etree.tostring(root)).save(tmp_path)
    assert foresee(path, catalogue())[1] is False


@given(st.text(max_size=40))
@settings(max_examples=20)
def test_any_words_of_a_scene_come_back(words):
    scene = SCENES[0].model_copy(update={"scenario_id": whole(words)})
    with TemporaryDirectory() as folder:
        file = to_openscenario(scene, catalogue(), properties={"text": words})
        assert read_openscenario(file.save(folder), catalogue()).scene == scene


def test_a_twin_gives_back_its_scene(tmp_path):
    twin = ordinary_twin(SCENES[0], catalogue())
    path = to_openscenario(twin, catalogue(), action="stop").save(tmp_path)
    assert read_openscenario(path, catalogue()).scene == twin


@pytest.mark.parametrize(
    "told", [{"road": "urban_avenue"}, {"road": "nowhere"}, {"hazards": ["a"]}, {"ego": "ego"}]
)
def test_an_unchanged_export_takes_no_other_map_hazard_or_ego(told, tmp_path):
    path = to_openscenario(SCENES[0], catalogue()).save(tmp_path)
    with pytest.raises(UsageError, match="is an unchanged export"):
        read_openscenario(path, catalogue(), **told)


def test_the_scene_of_a_file_is_foreseen(tmp_path):
    path = to_openscenario(SCENES[0], catalogue()).save(tmp_path)
    assert foresee(path, catalogue()) == (SCENES[0].id, True)
    other = path.rename(tmp_path / "Some File.xosc")
    assert foresee(other, catalogue()) == (SCENES[0].id, True)
    other.write_text(other.read_text().replace('"oodscen.scene"', '"other.scene"'))
    assert foresee(other, catalogue()) == ("some-file", False)
    assert read_openscenario(other, catalogue()).scene.id == "some-file"


def test_a_changed_export_is_read_by_its_elements(tmp_path):
    scene = next(one for one in SCENES if one.weather.friction < 1.0)
    path = to_openscenario(scene, catalogue()).save(tmp_path)
    text = path.read_text()
    was = f'frictionScaleFactor="{scene.weather.friction:g}"'
    path.write_text(text.replace(was, 'frictionScaleFactor="0.5"'))
    found = read_openscenario(path, catalogue())
    assert found.scene.weather.friction == 0.5
    assert [actor.asset for actor in found.scene.actors] == [actor.asset for actor in scene.actors]
    for mine, its in zip(scene.actors, found.scene.actors, strict=True):
        assert its.placement.ahead_m == pytest.approx(mine.placement.ahead_m, abs=2.5)
    assert any("changed" in issue.message for issue in found.omissions)


@pytest.mark.parametrize("target", ["generic", "esmini"])
def test_a_changed_export_keeps_the_states_of_its_entities(target, tmp_path):
    scenes = [one for one in SCENES if any(actor.state for actor in one.actors)]
    assert scenes
    for scene in scenes:
        path = to_openscenario(scene, catalogue(), target=target).save(tmp_path)
        path.write_text(
            path.read_text().replace('TimeOfDay animation="false"', 'TimeOfDay animation="true"')
        )
        found = read_openscenario(path, catalogue())
        first = {asset.id: asset.states[0] for asset in catalogue().assets if asset.states}
        states = [actor.state or first.get(actor.asset, "") for actor in found.scene.actors]
        assert states == [actor.state or first.get(actor.asset, "") for actor in scene.actors]
        assert all("oodscen" not in issue.message for issue in found.omissions)
        assert any("not by the header's properties" in one.message for one in found.omissions)


def test_a_state_that_an_asset_has_not_is_noted(foreign):
    state = '<Properties><Property name="oodscen.state" value="STATE"/></Properties>'
    body = f'<Vehicle name="car" vehicleCategory="car">{state}</Vehicle>'
    states = catalogue().by_name["car"].states
    assert len(states) > 1
    for known in states:
        found = foreign(ENTITY=body.replace("STATE", known))
        assert found.scene.actors[0].state == ("" if known == states[0] else known)
        assert not [one for one in found.omissions if "Propert" in one.path]
    found = foreign(ENTITY=body.replace("STATE", "odd"))
    assert found.scene.actors[0].state == ""
    assert any("car has no state 'odd'" in issue.message for issue in found.omissions)


@pytest.mark.parametrize(
    "part", ['<Property name="lights" value="off"/>', '<File filepath="x.glb"/>']
)
def test_properties_of_others_are_noted(part, foreign):
    properties = f"<Properties>{part}</Properties>"
    box = '<BoundingBox><Center x="1.4" y="0" z="0.7"/></BoundingBox>'
    texts = [
        FOREIGN.replace(f"{start}/>", f"{start}>{box}{properties}</{start.split()[0][1:]}>")
        for start in (
            '<Vehicle name="a" vehicleCategory="car"',
            '<FileHeader revMajor="1" revMinor="0" date="2020-01-01T00:00:00" author="x" description="x"',
        )
    ]
    texts.append(
        FOREIGN.replace(
            "ENTITY", f'<Vehicle name="b" vehicleCategory="car">{box}{properties}</Vehicle>'
        )
    )
    for text in texts:
        issues = [
            one
            for one in foreign(text).omissions
            if one.path.split(": ")[-1] in ("Properties", "Property", "File")
        ]
        assert len(issues) == 1
        assert issues[0].message.endswith("is not read")


def test_a_changed_scene_in_the_header_is_not_taken(tmp_path):
    scene = SCENES[0]
    path = to_openscenario(scene, catalogue()).save(tmp_path)
    text = path.read_text()
    was = f"&quot;speed&quot;:{scene.ego.speed}"
    assert was in text
    path.write_text(text.replace(was, "&quot;speed&quot;:44.0"))
    found = read_openscenario(path, catalogue())
    assert found.scene.ego.speed == pytest.approx(scene.ego.speed, abs=0.01)
    assert any("changed" in issue.message for issue in found.omissions)


@pytest.mark.parametrize("major", ["", "0", "2", "7", "one"])
def test_another_major_version_is_refused(major, foreign):
    with pytest.raises(DataError) as caught:
        foreign(FOREIGN.replace('revMajor="1"', f'revMajor="{major}"'))
    assert "revMajor" in caught.value.issues[0].path


def test_two_entities_of_one_name_are_refused(foreign):
    with pytest.raises(DataError, match="'Ego' occurs more than once"):
        foreign(FOREIGN.replace('name="Other"', 'name="Ego"'))


@pytest.mark.parametrize("minor", ["", "-1", "x", "2.5", "1e0", "٢"])
def test_what_is_no_minor_version_is_refused(minor, foreign):
    with pytest.raises(DataError, match="is no minor version") as caught:
        foreign(FOREIGN.replace('revMinor="0"', f'revMinor="{minor}"'))
    assert "revMinor" in caught.value.issues[0].path


@pytest.mark.parametrize("minor", ["4", "99"])
def test_an_unknown_minor_version_is_noted(minor, foreign):
    found = foreign(FOREIGN.replace('revMinor="0"', f'revMinor="{minor}"'))
    assert any("version" in omission.message for omission in found.omissions)
    assert not any("version" in omission.message for omission in foreign().omissions)


def test_a_file_of_others_is_read_as_far_as_the_vocabulary_goes(foreign):
    scene = foreign().scene
    (actor,) = scene.actors
    assert scene.ego.speed == 15.0
    assert (actor.id, actor.asset, actor.placement.lane) == ("other", "car", 0)
    assert actor.placement.ahead_m == pytest.approx(30.0, abs=0.01)
    assert actor.behaviour.name == "hard_brake"
    assert actor.behaviour.parameters == {"deceleration": 6.0, "speed": 10.0}
    assert (actor.behaviour.trigger.kind, actor.behaviour.trigger.value) == ("time", 2.0)
    assert scene.weather.friction == 0.7
    assert scene.weather.precipitation_mm_h == 5.0
    assert (scene.weather.cloud_cover, scene.weather.fog_visual_range_m) == (1.0, 150.0)


def test_lane_changes_and_crossings_are_read(foreign):
    change = """<LateralAction><LaneChangeAction>
        <LaneChangeActionDynamics dynamicsShape="sinusoidal" dynamicsDimension="time" value="2.5"/>
        <LaneChangeTarget><AbsoluteTargetLane value="-1"/></LaneChangeTarget>
      </LaneChangeAction></LateralAction>"""
    near = """<ByEntityCondition>
        <TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="Ego"/>
        </TriggeringEntities>
        <EntityCondition><RelativeDistanceCondition entityRef="Other" value="12"
          relativeDistanceType="longitudinal" freespace="false" rule="lessThan"/>
        </EntityCondition></ByEntityCondition>"""
    beside = '<LanePosition roadId="1" laneId="-2" s="240"/>'
    (actor,) = foreign(ACTION=change, CONDITION=near, PLACE=beside).scene.actors
    assert actor.behaviour.name == "cut_in"
    assert actor.behaviour.parameters == {"lanes": 1.0, "duration": 2.5, "speed": 10.0}
    assert (actor.behaviour.trigger.kind, actor.behaviour.trigger.value) == ("distance", 12.0)

    vertices = "".join(
        f'<Vertex time="{time}"><Position><LanePosition roadId="1" laneId="-1" s="250" '
        f'offset="{offset}"/></Position></Vertex>'
        for time, offset in ((0, -4), (4, 4))
    )
    course = f"""<RoutingAction><FollowTrajectoryAction>
        <Trajectory name="t" closed="false"><Shape><Polyline>{vertices}</Polyline></Shape></Trajectory>
        <TimeReference><None/></TimeReference><TrajectoryFollowingMode followingMode="follow"/>
      </FollowTrajectoryAction></RoutingAction>"""
    walker = '<Pedestrian name="p" model="p" mass="70" pedestrianCategory="pedestrian"/>'
    place = '<LanePosition roadId="1" laneId="-1" s="250" offset="-4"/>'
    found = foreign(ACTION=course, ENTITY=walker, PLACE=place, START="0")
    (actor,) = found.scene.actors
    assert actor.behaviour.name == "cross_road"
    assert actor.behaviour.parameters == {"distance": 8.0, "speed": 2.0}
    assert actor.placement.heading_deg == pytest.approx(90.0, abs=0.1)


def test_what_is_left_out_has_its_line_and_element(foreign):
    odd = "<LateralAction><LaneOffsetAction continuous='true'/></LateralAction>"
    found = foreign(ACTION=odd)
    assert any(
        omission.path.startswith("line ") and omission.path.endswith("LaneOffsetAction")
        for omission in found.omissions
    )


@pytest.mark.parametrize(
    ("parts", "where"),
    [
        ({"START": "fast"}, "AbsoluteTargetSpeed @value"),
        ({"START": "1e400"}, "AbsoluteTargetSpeed @value"),
        ({"START": "$unknown"}, "AbsoluteTargetSpeed @value"),
        ({"START": "${1 / 0}"}, "AbsoluteTargetSpeed @value"),
        ({"ENTITY": '<CatalogReference catalogName="c" entryName="none"/>'}, "CatalogReference"),
        ({"PLACE": '<LanePosition roadId="9" laneId="-1" s="1"/>'}, "LanePosition"),
        ({"PLACE": '<LanePosition roadId="1" laneId="-99" s="1"/>'}, "LanePosition"),
        (
            {
                "START": "$a",
                "PARAMETERS": '<ParameterDeclaration name="a" value="$b"/>'
                '<ParameterDeclaration name="b" value="$a"/>',
            },
            "AbsoluteTargetSpeed @value",
        ),
    ],
)
def test_faults_are_refused_with_line_and_element(foreign, parts, where):
    with pytest.raises(DataError) as caught:
        foreign(**parts)
    (issue,) = caught.value.issues
    assert issue.path.startswith("line ")
    assert issue.path.endswith(where)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<OpenDRIVE/>",
        "<OpenSCENARIO/>",
        "<OpenSCENARIO><Storyboard/></OpenSCENARIO>",
        "<OpenSCENARIO>" + "<a>" * 100 + "</a>" * 100 + "</OpenSCENARIO>",
        '<!DOCTYPE a [<!ENTITY b "c">]><OpenSCENARIO><Storyboard/></OpenSCENARIO>',
        '<!DOCTYPE a SYSTEM "file:///etc/passwd"><OpenSCENARIO><Storyboard/></OpenSCENARIO>',
        FOREIGN.replace("Ego", "Nobody", 1),
        FOREIGN.replace("road.xodr", "/etc/passwd"),
    ],
)
def test_hostile_files_are_refused(foreign, text):
    with pytest.raises(OodscenError):
        foreign(text)


def foreign_crowd(folder):
    """Write an export of several actors that no longer says which scene it is."""
    scene = next(one for one in SCENES if len(one.actors) > 1 and not one.made)
    path = to_openscenario(scene, catalogue()).save(folder)
    path.write_text(path.read_text().replace('"oodscen.scene"', '"other.scene"'))
    return path


def test_a_model_names_the_hazard_that_nobody_named(tmp_path):
    path = foreign_crowd(tmp_path)
    actors = [actor.id for actor in read_openscenario(path, catalogue()).scene.actors]
    for name in actors:
        answers = [{"reasoning": "", "actors": ["nobody"]}, {"reasoning": "", "actors": [name]}]
        model = ScriptedLLM([json.dumps(answer) for answer in answers])
        found = read_openscenario(path, catalogue(), llm=model)
        assert list(found.scene.hazard.actors) == [name]
        assert any(name in issue.message for issue in found.omissions)
    named = read_openscenario(path, catalogue(), hazards=actors[:1], llm=ScriptedLLM([]))
    assert list(named.scene.hazard.actors) == actors[:1]
    builtin = read_openscenario(path, catalogue(), llm=make_llm("builtin"))
    assert set(builtin.scene.hazard.actors) <= set(actors)


@given(known=st.sets(st.sampled_from(["stand", "follow_lane", "hard_brake", "cross_road"])))
@IN_FOLDER
def test_a_catalogue_may_lack_any_behaviour(known, tmp_path):
    behaviours = tuple(kind for kind in catalogue().behaviours if kind.id in known)
    own = catalogue().model_copy(update={"behaviours": behaviours})
    found = read_openscenario(foreign_crowd(tmp_path), own, llm=make_llm("builtin"))
    assert {actor.behaviour.name for actor in found.scene.actors} <= known | {"stand"}
    told = [issue.message for issue in found.omissions]
    assert ("unknown behaviour 'stand'" in " ".join(told)) == ("stand" not in known)


def test_an_export_is_told_to_lack_what_a_catalogue_lacks(tmp_path):
    path = to_openscenario(SCENES[0], catalogue()).save(tmp_path)
    found = read_openscenario(path, catalogue().model_copy(update={"assets": ()}))
    assert found.scene == SCENES[0]
    assert any("unknown asset" in issue.message for issue in found.omissions)


def test_a_model_without_a_usable_answer_is_an_error(tmp_path):
    model = ScriptedLLM(["no idea"] * 5)
    with pytest.raises(AnswerError):
        read_openscenario(foreign_crowd(tmp_path), catalogue(), llm=model)


@pytest.mark.parametrize(
    ("change", "note"),
    [
        (lambda path, road: road.write_bytes(road.read_bytes()), ""),
        (lambda path, road: road.unlink(), ""),
        (lambda path, road: road.write_text(road.read_text() + " "), "the road file was changed"),
        (lambda path, road: put(path, 'revMinor="2"', 'revMinor="99"'), "version 1.99"),
    ],
)
def test_a_changed_road_or_version_is_no_unchanged_export(tmp_path, change, note):
    path = to_openscenario(SCENES[0], catalogue()).save(tmp_path)
    (road,) = tmp_path.glob("*.xodr")
    change(path, road)
    found = read_openscenario(path, catalogue())
    assert (found.scene == SCENES[0]) is not bool(note)
    assert any(note in omission.message for omission in found.omissions) is bool(note)
    if note:
        assert found.scene.map == str(road.resolve())


def put(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


NAMES = {
    ("Lego", "Ego1"): "Ego1",
    ("TargetEgo", "Ego"): "Ego",
    ("Diego", "Ego"): "Ego",
    ("Ego_Target", "Ego"): "Ego",
    ("adversary", "HERO"): "HERO",
    ("TargetEgo", "ego_vehicle"): "ego_vehicle",
    ("ego", "Ego"): "ego",
    ("a", "b"): "a",
}


@pytest.mark.parametrize("names", NAMES, ids="-".join)
def test_the_ego_is_the_entity_of_that_name(names, tmp_path):
    starts = [start(name, lane(s), 5) for name, s in zip(names, (200, 250), strict=True)]
    found = read(tmp_path, file([entity(name) for name in names], starts))
    (actor,) = found.scene.actors
    assert (actor.placement.ahead_m > 0) is (NAMES[names] == names[0])
    assert actor.id != "ego"
    told = any("is taken to be" in note and "hazard" not in note for note in notes(found))
    assert told is (
        names in {("Lego", "Ego1"), ("TargetEgo", "ego_vehicle"), ("ego", "Ego"), ("a", "b")}
    )


def test_the_hazard_is_named_by_its_name_or_its_id_and_is_not_the_ego(tmp_path):
    places = {"Car": 200, "car": 250, "CAR": 280}
    starts = [start(name, lane(s), 5) for name, s in places.items()]
    text = file([entity(name) for name in places], starts)
    for name, actor in (("car", "car"), ("CAR", "car-2"), ("car-2", "car-2")):
        found = read(tmp_path, text, ego="Car", hazards=[name])
        assert list(found.scene.hazard.actors) == [actor]
    with pytest.raises(DataError, match="no entity 'Car' beside the ego"):
        read(tmp_path, text, ego="Car", hazards=["Car"])


@pytest.mark.parametrize("name", ["ego", "VUT", "a.b c"])
def test_the_ego_is_the_entity_that_is_named(name, tmp_path):
    names = ("ego", "VUT", "a.b c")
    starts = [start(one, lane(200 + 30 * index), 5 + index) for index, one in enumerate(names)]
    found = read(tmp_path, file([entity(one) for one in names], starts), ego=name)
    assert found.scene.ego.speed == 5 + names.index(name)
    aheads = {round(actor.placement.ahead_m, 2) for actor in found.scene.actors}
    place = 30 * names.index(name)
    assert aheads == {30.0 * index - place for index in range(3)} - {0.0}
    assert not any("is taken to be the ego" in note for note in notes(found))


@pytest.mark.parametrize("name", ["", "EGO", "nobody"])
def test_an_ego_that_the_file_has_not_is_refused_with_those_there_are(name, tmp_path):
    starts = [start("ego", lane(200), 5), start("a", lane(250), 5)]
    with pytest.raises(
        DataError, match=f"ego: there is no entity '{name}'; the file has: 'ego', 'a'"
    ):
        read(tmp_path, file([entity("ego"), entity("a")], starts), ego=name)


def test_entities_become_assets_by_their_other_names(foreign, monkeypatch):
    plain = catalogue()
    own = plain.model_copy(
        update={
            "assets": tuple(
                asset.model_copy(update={"id": f"my_{number}", "names": (asset.id,)})
                for number, asset in enumerate(plain.assets)
            )
        }
    )
    for name in ("van", "small tractor", "x"):
        entity = f'<Vehicle name="{name}" vehicleCategory="car"/>'
        monkeypatch.setitem(foreign.__globals__, "catalogue", lambda: plain)
        (expected,) = foreign(ENTITY=entity).scene.actors
        monkeypatch.setitem(foreign.__globals__, "catalogue", lambda: own)
        (found,) = foreign(ENTITY=entity).scene.actors
        assert own.asset(found.asset).names == (expected.asset,)

"""Laws of the reader of other tools' files: it reads them as they are written, or notes that it does not."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from oodscen.driving._roads.opendrive import read_network
from oodscen.errors import OodscenError
from oodscen.interchange._reading.positions import MappedRoads
from oodscen.interchange._reading.starts import _Order
from tests.interchange.reading.files import (
    IN_FOLDER,
    ROAD,
    at,
    by_entity,
    cars,
    entity,
    event,
    file,
    lane,
    near,
    notes,
    read,
    speed,
    start,
    weather,
    world,
)

STOP = speed(0, "linear", 6, "rate")
_PLACE = f"<Position>{lane(250)}</Position>"
CONDITIONS = {
    "time": at(3),
    "distance": by_entity(near(20)),
    "ttc": by_entity(
        '<TimeToCollisionCondition value="2" freespace="false" rule="lessThan" alongRoute="true" '
        'coordinateSystem="lane" relativeDistanceType="longitudinal">'
        '<TimeToCollisionConditionTarget><EntityRef entityRef="a"/></TimeToCollisionConditionTarget>'
        "</TimeToCollisionCondition>"
    ),
    "headway": by_entity(
        '<TimeHeadwayCondition entityRef="a" value="2" freespace="false" rule="lessThan" '
        'coordinateSystem="lane" relativeDistanceType="longitudinal"/>'
    ),
    "travelled": by_entity('<TraveledDistanceCondition value="30"/>'),
    "place": by_entity(
        f'<DistanceCondition value="20" freespace="false" rule="lessThan" coordinateSystem="road" '
        f'relativeDistanceType="longitudinal">{_PLACE}</DistanceCondition>'
    ),
    "reach": by_entity(f'<ReachPositionCondition tolerance="5">{_PLACE}</ReachPositionCondition>'),
    "state": '<ByValueCondition><StoryboardElementStateCondition storyboardElementType="story" '
    'storyboardElementRef="s" state="runningState"/></ByValueCondition>',
}
OTHERS = {
    "rule": ["greaterThan", "equalTo", "notEqualTo", "purple", ""],
    "conditionEdge": ["falling", "risingOrFalling"],
    "delay": ["2.5"],
    "value": ["7", "-7"],
    "tolerance": ["2"],
    "freespace": ["true", "purple"],
    "relativeDistanceType": ["lateral", "purple"],
    "coordinateSystem": ["trajectory", "purple"],
    "entityRef": ["b", "zz"],
    "triggeringEntitiesRule": ["none"],
    "maximumExecutionCount": ["0", "3"],
    "priority": ["skip"],
    "selectTriggeringEntities": ["true"],
    "state": ["endTransition"],
    "storyboardElementType": ["event"],
    "s": ["260"],
    "laneId": ["9"],
    "roadId": ["2"],
}
SAME = {("SimulationTimeCondition", "equalTo")}
"""Elements and values that start an event at the same moment."""


def three(condition):
    """Return a file of the ego, a car that stops by a condition, and another car."""
    starts = [start("ego", lane(200), 10), start("a", lane(250), 5), start("b", lane(290), 4)]
    return file([entity("ego"), entity("a"), entity("b")], starts, event(STOP, condition))


def told(folder, text):
    """Return all that is told of a file: its scene and notes, or why it is refused."""
    try:
        found = read(folder, text)
    except OodscenError as error:
        return str(error)
    return found.scene, notes(found)


@pytest.mark.parametrize("name", CONDITIONS)
def test_every_attribute_of_a_condition_matters_or_is_noted(name, tmp_path):
    text = three(CONDITIONS[name])
    before = told(tmp_path, text)
    assert not isinstance(before, str)
    tree = etree.fromstring(text)
    changes = list(changes_of(tree.find(".//Story")))
    assert len(changes) > 3
    for element, attribute, other in changes:
        value = element.get(attribute)
        element.set(attribute, other)
        after = told(tmp_path, etree.tostring(tree, encoding="unicode"))
        element.set(attribute, value)
        assert after != before, f"{element.tag} @{attribute}: {value} -> {other}"


def changes_of(story):
    """Yield the attributes of a story that start its event, with other values that mean something else."""
    actions = {one for action in story.iter("Action") for one in action.iter()}
    for element in story.iter():
        for attribute, value in element.attrib.items():
            for other in OTHERS.get(attribute, []):
                if element not in actions and other != value and (element.tag, other) not in SAME:
                    yield element, attribute, other


ELEMENTS = [
    index
    for index, one in enumerate(etree.fromstring(three(CONDITIONS["distance"])).iter())
    if not {"FileHeader", "ParameterDeclarations", "CatalogLocations", "BoundingBox", "Vehicle"}
    & {one.tag, *(above.tag for above in one.iterancestors())}
]


@pytest.mark.parametrize("index", ELEMENTS)
def test_what_nobody_reads_is_noted_with_line_and_element(index, tmp_path):
    for change in ("attribute", "element"):
        tree = etree.fromstring(three(CONDITIONS["distance"]))
        one = list(tree.iter())[index]
        if change == "attribute":
            one.set("odd", "9")
        else:
            etree.SubElement(one, "Odd", odd="9")
        found = notes(read(tmp_path, etree.tostring(tree, encoding="unicode")))
        names = ("odd=", ": Odd: ", f"{one.tag}: is not read")
        assert any(name in note for name in names for note in found), one.tag
        assert all(note.startswith("line ") for note in found)


def test_a_plain_file_has_nothing_to_note(tmp_path):
    found = notes(read(tmp_path, cars(event(STOP, at(3)), place=lane(212), ego_place=lane(158.6))))
    assert len(found) == 1
    assert "no hazard was named" in found[0]


# ------------------------------------------------------------------ places


@given(st.floats(0.0, 200.0), st.floats(5.0, 100.0), st.floats(-1.0, 1.0))
@IN_FOLDER
def test_shifting_all_bodies_leaves_their_distances(tmp_path, shift, apart, beside):
    own, its = world(160 + shift, -1.7), world(160 + shift + apart, -1.7 + beside)
    placed = read(tmp_path, cars(ego_place=own, place=its)).scene.actors[0].placement
    assert placed.ahead_m == pytest.approx(apart, abs=0.0011)
    assert placed.offset_m == pytest.approx(beside, abs=0.0011)


@given(st.floats(160.0, 900.0), st.sampled_from([-2, -1, 1, 2]))
@IN_FOLDER
def test_a_place_in_the_world_is_the_same_as_on_its_road(tmp_path, s, number):
    """Also in bends, where the nearest point of the reference line has to be found."""
    roads = MappedRoads(read_network(ROAD, source="road"))
    poses = [roads.at(None, "1", one, number, 0.0) for one in (s, s + 40)]
    own, its = (world(pose.x, pose.y, pose.heading) for pose in poses)
    there = read(tmp_path, cars(ego_place=own, place=its)).scene
    along = read(tmp_path, cars(ego_place=lane(s, number), place=lane(s + 40, number))).scene
    assert there.ego == along.ego
    ahead = [one.actors[0].placement.ahead_m for one in (there, along)]
    assert ahead[0] == pytest.approx(ahead[1], abs=0.0021)


def to_lane(target):
    return (
        '<PrivateAction><LateralAction><LaneChangeAction><LaneChangeActionDynamics value="3" '
        f'dynamicsShape="sinusoidal" dynamicsDimension="time"/><LaneChangeTarget>{target}'
        "</LaneChangeTarget></LaneChangeAction></LateralAction></PrivateAction>"
    )


BESIDE = st.integers(-1, 1).map(
    lambda count: f'<RelativeTargetLane entityRef="ego" value="{count}"/>'
)
NUMBERED = st.sampled_from([-2, -1, 1, 2]).map(lambda lane: f'<AbsoluteTargetLane value="{lane}"/>')


@given(
    st.floats(170.0, 800.0),
    *[st.sampled_from([-2, -1, 1, 2])] * 2,
    st.floats(-1.2, 1.2),
    st.one_of(BESIDE, NUMBERED),
)
@IN_FOLDER
def test_a_lane_change_is_the_same_from_a_place_in_the_world_and_on_the_road(
    tmp_path, s, own, its, offset, target
):
    roads = MappedRoads(read_network(ROAD, source="road"))
    ego = roads.at(None, "1", s, own, 0.0)
    pose = roads.at(None, "1", s + 40, its, offset)
    change = event(to_lane(target), at(2))
    t = pose.offset_from(roads.at(None, "1", s + 40, 0, 0.0))[1]
    turned = f'<Orientation h="{pose.heading}" type="absolute"/>'
    by_road = f'<RoadPosition roadId="1" s="{s + 40}" t="{t}">{turned}</RoadPosition>'
    found = [
        read(tmp_path, cars(change, ego_place=one, place=other)).scene
        for one, other in (
            (lane(s, own), lane(s + 40, its, offset)),
            (lane(s, own), world(pose.x, pose.y, pose.heading)),
            (world(ego.x, ego.y, ego.heading), world(pose.x, pose.y, pose.heading)),
            (world(ego.x, ego.y, ego.heading), by_road),
        )
    ]
    first, *others = [(one.ego, one.actors[0].behaviour) for one in found]
    assert all(one == first for one in others)


@pytest.mark.parametrize(
    ("place", "is_known"),
    [(world(90, 60), False), (world(-20, -1.75), False), (world(90, -1.75), True)],
)
def test_a_lane_change_from_off_all_lanes_is_left_out(place, is_known, tmp_path):
    change = event(to_lane('<AbsoluteTargetLane value="-2"/>'), at(2))
    found = read(tmp_path, cars(change, place=place, ego_place=lane(60)))
    assert (found.scene.actors[0].behaviour.name == "cut_in") is is_known
    told = any("LaneChangeAction: the lane is not known" in note for note in notes(found))
    assert told is not is_known


@pytest.mark.parametrize(
    "target",
    [
        '<AbsoluteTargetLane value="2"/>',
        '<RelativeTargetLane entityRef="a" value="2"/>',
    ],
)
def test_a_change_by_two_lanes_at_a_rate_takes_twice_as_long(target, tmp_path):
    change = to_lane(target).replace('"time"', '"rate"')
    found = read(tmp_path, cars(event(change, at(2)), place=lane(250, -1)))
    behaviour = found.scene.actors[0].behaviour
    assert behaviour.parameters["lanes"] == 2.0
    assert behaviour.parameters["duration"] == pytest.approx(7.0 / 3.0, abs=1e-3)


@pytest.mark.parametrize("action", [speed(0, "step", -2, "none"), speed(0, "step", 2, "speed")])
def test_how_long_a_step_takes_is_not_noted(action, tmp_path):
    found = notes(read(tmp_path, cars(event(action, at(2)))))
    assert not any("SpeedActionDynamics" in note for note in found)


def mirrored_road():
    """Return the road, whose cross-section is symmetric, as in a mirror: its traffic keeps to the left."""
    tree = etree.fromstring(ROAD)
    for one in tree.iter():
        for name in ("y", "hdg", "curvature", "curvStart", "curvEnd"):
            if name in one.attrib:
                one.set(name, str(-float(one.get(name))))
        if one.get("rule"):
            one.set("rule", "LHT")
    return etree.tostring(tree)


@given(
    st.floats(170.0, 800.0),
    st.floats(-40.0, 60.0),
    *[st.sampled_from([-2, -1, 1, 2])] * 2,
    st.floats(-1.0, 1.0),
)
@IN_FOLDER
def test_a_mirrored_road_gives_the_mirrored_scene(tmp_path, s, apart, own, its, offset):
    scenes = []
    for side, road in ((1, ROAD), (-1, mirrored_road())):
        target = side * (3 - abs(its)) * (1 if its > 0 else -1)
        change = to_lane(f'<AbsoluteTargetLane value="{target}"/>')
        text = cars(
            event(change, at(2)),
            ego_place=lane(s, side * own),
            place=lane(s + apart, side * its, side * offset),
        )
        scenes.append(read(tmp_path, text, road).scene)
    (plain,), (mirrored,) = (scene.actors for scene in scenes)
    assert mirrored.placement.ahead_m == pytest.approx(plain.placement.ahead_m, abs=0.0011)
    assert mirrored.placement.lane == -plain.placement.lane
    assert mirrored.placement.offset_m == pytest.approx(-plain.placement.offset_m, abs=0.0011)
    assert math.remainder(
        mirrored.placement.heading_deg + plain.placement.heading_deg, 360.0
    ) == pytest.approx(0.0, abs=0.01)
    turned = {**plain.behaviour.parameters}
    turned["lanes"] = -turned["lanes"]
    assert mirrored.behaviour.parameters == turned


@given(st.floats(-40.0, 60.0), *[st.sampled_from([-2, -1, 1, 2])] * 2, st.floats(-1.0, 1.0))
@IN_FOLDER
def test_a_mirrored_map_in_place_of_the_files_own_gives_the_mirrored_scene(
    tmp_path, apart, own, its, offset
):
    found = []
    for side, road in ((1, ROAD), (-1, mirrored_road())):
        (tmp_path / f"map{side}.xodr").write_bytes(road)
        text = cars(
            ego_place=lane(500, side * own), place=lane(500 + apart, side * its, side * offset)
        )
        scene = read(tmp_path, text, road=str(tmp_path / f"map{side}.xodr")).scene
        found.append((scene.ego.lane, scene.actors[0]))
    (kerb, plain), (other, mirrored) = found
    assert (kerb, other) == (0, 1)
    assert mirrored.placement.ahead_m == pytest.approx(plain.placement.ahead_m, abs=0.0011)
    assert mirrored.placement.lane == -plain.placement.lane
    assert mirrored.placement.offset_m == pytest.approx(-plain.placement.offset_m, abs=0.0011)
    assert mirrored.behaviour == plain.behaviour


@pytest.mark.parametrize(
    "place",
    [world(200, -1.2), world(200, -1.7, 0.4), lane(200, offset=0.8), lane(200, offset=-0.8)],
)
def test_how_the_ego_stands_in_its_lane_is_noted(place, tmp_path):
    found = read(tmp_path, cars(ego_place=place))
    assert any("the ego starts in the middle of its lane" in note for note in notes(found))
    assert not any("in the middle" in note for note in notes(read(tmp_path, cars())))


@pytest.mark.parametrize("s", [-20, 1050, 2500])
def test_a_place_beyond_its_road_is_refused(s, tmp_path):
    with pytest.raises(OodscenError, match="road '1' goes from 0 to 1000 m"):
        read(tmp_path, cars(place=lane(s)))


def test_a_start_that_waits_for_itself_is_named_as_the_cause(tmp_path):
    place = '<RelativeObjectPosition entityRef="a" dx="50" dy="0"/>'
    with pytest.raises(OodscenError, match="relative to 'a', whose place is not known"):
        read(tmp_path, cars(place=place))


def placed(*places):
    """Return the actions that place an entity at one place after another."""
    return "\n".join(
        f"<PrivateAction><TeleportAction><Position>{place}</Position></TeleportAction></PrivateAction>"
        for place in places
    )


@given(st.lists(st.floats(210.0, 300.0), min_size=1, max_size=4), st.integers(0, 3))
@IN_FOLDER
def test_the_last_of_several_starts_counts(tmp_path, places, split):
    """In one element or in several of the entity."""
    lanes = [lane(s) for s in places]
    held = [placed(*lanes[:split]) + "\n", placed(*lanes[split:]) + speed(5)]
    others = [f'<Private entityRef="a">{one}</Private>' for one in held]
    text = file([entity("ego"), entity("a")], [start("ego", lane(200), 10), *others])
    found = read(tmp_path, text)
    assert found.scene.actors[0].placement.ahead_m == pytest.approx(places[-1] - 200, abs=0.0011)
    again = [note for note in notes(found) if "'a' is placed again later" in note]
    assert len(again) == len(places) - 1
    assert all(one.startswith("line ") and ": Position: " in one for one in again)


GEO = '<GeoPosition latitude="1" longitude="1"/>'


def beside(name, dx):
    return f'<RelativeObjectPosition entityRef="{name}" dx="{dx}" dy="0"/>'


@pytest.mark.parametrize(
    ("places", "ahead"),
    [
        ([("a", lane(220)), ("b", beside("a", 10)), ("a", lane(280))], {"a": 80, "b": 30}),
        ([("a", lane(220)), ("a", lane(280)), ("b", beside("a", 10))], {"a": 80, "b": 90}),
        ([("a", lane(220)), ("b", beside("a", 10)), ("a", beside("b", 5))], {"a": 35, "b": 30}),
        ([("a", lane(220)), ("b", beside("a", 10)), ("a", beside("a", 5))], {"a": 25, "b": 30}),
        ([("b", beside("a", 10)), ("a", lane(220))], {"a": 20, "b": 30}),
        ([("b", beside("a", 10)), ("a", beside("b", 5)), ("a", lane(220))], {"a": 20, "b": 30}),
        ([("b", beside("a", 10)), ("b", lane(260)), ("a", lane(220))], {"a": 20, "b": 60}),
        ([("a", beside("a", 10)), ("a", lane(220)), ("b", lane(240))], {"a": 20, "b": 40}),
        ([("a", lane(5000)), ("a", lane(220)), ("b", beside("a", 10))], {"a": 20, "b": 30}),
        ([("b", beside("a", 20)), ("a", lane(220)), ("a", lane(280))], {"a": 80, "b": 40}),
        (
            [("a", beside("c", 5)), ("b", beside("a", 20)), ("a", lane(220)), ("a", lane(280))],
            {"a": 80, "b": 40},
        ),
        (
            [("a", beside("a", 5)), ("b", beside("a", 20)), ("a", lane(220)), ("a", lane(280))],
            {"a": 80, "b": 40},
        ),
        (
            [("a", GEO), ("b", beside("a", 20)), ("a", lane(220)), ("a", lane(280))],
            {"a": 80, "b": 40},
        ),
        (
            [
                ("b", beside("a", 20)),
                ("a", beside("c", 10)),
                ("a", lane(220)),
                ("a", beside("b", 10)),
                ("a", beside("b", 15)),
            ],
            {"a": 55, "b": 40},
        ),
        (
            [("a", lane(5000)), ("b", beside("a", 5)), ("b", lane(230)), ("a", lane(220))],
            {"a": 20, "b": 30},
        ),
    ],
)
def test_starts_are_taken_in_order(places, ahead, tmp_path):
    starts = [start("ego", lane(200), 10), *(start(*place) for place in places)]
    found = read(tmp_path, file([entity("ego"), entity("a"), entity("b")], starts))
    assert {one.id: one.placement.ahead_m for one in found.scene.actors} == ahead


def test_two_starts_that_wait_for_each_other_are_named_as_the_cause(tmp_path):
    starts = [start("ego", lane(200), 10), start("a", lane(220))]
    starts += [start("a", beside("b", 5)), start("b", beside("a", 10))]
    with pytest.raises(OodscenError, match="relative to 'b', whose place is not known") as caught:
        read(tmp_path, file([entity("ego"), entity("a"), entity("b")], starts))
    assert "relative to 'a', whose place is not known" in str(caught.value)


@pytest.mark.parametrize("last", [lane(220), ""])
def test_starts_that_wait_for_the_last_one_are_looked_at_a_few_times_each(
    last, tmp_path, monkeypatch
):
    looks, is_ready = [], _Order._is_ready
    monkeypatch.setattr(
        _Order, "_is_ready", lambda self, own: looks.append(own) or is_ready(self, own)
    )
    starts = [start("ego", lane(200), 10), start("a", lane(250))]
    starts += [start(f"e{n}", beside(f"e{n + 1}", 1)) for n in range(200)] + [start("e200", last)]
    read(tmp_path, file([entity("ego"), entity("a")], starts))
    assert len(looks) < 4 * len(starts)


def test_an_empty_start_is_named_as_the_cause(tmp_path):
    starts = [start("ego", lane(200), 10), start("a", ""), start("b", lane(240))]
    found = read(tmp_path, file([entity("ego"), entity("a"), entity("b")], starts))
    assert any("Position: is empty" in note for note in notes(found))


def test_a_last_start_that_cannot_be_read_is_not_replaced_by_an_earlier_one(tmp_path):
    again = placed(GEO)
    text = cars().replace(
        "</Actions></Init>", f'<Private entityRef="a">{again}</Private></Actions></Init>'
    )
    with pytest.raises(OodscenError, match="GeoPosition: this kind of position is not read"):
        read(tmp_path, text)


# ------------------------------------------------------------------ values beyond what a scene holds


@given(st.floats(-1e6, 1e6, allow_nan=False))
@IN_FOLDER
def test_a_speed_is_kept_or_noted(tmp_path, value):
    found = read(tmp_path, cars(first=value))
    kept = found.scene.actors[0].behaviour.parameters.get("speed", 0.0)
    assert kept == pytest.approx(value, abs=0.1) or any(
        "is read as" in note for note in notes(found)
    )


SKIES = {
    'fractionalCloudCover="eightOktas"': ("cloud_cover", 1.0, None),
    'fractionalCloudCover="nineOktas"': ("cloud_cover", 1.0, "nineOktas"),
    'fractionalCloudCover="purple"': ("cloud_cover", 0.1, "purple"),
    'cloudState="skyOff"': ("cloud_cover", 0.0, "skyOff"),
    'cloudState="overcast"': ("cloud_cover", 1.0, None),
}


@pytest.mark.parametrize("said", SKIES)
def test_clouds_are_read_or_noted(said, tmp_path):
    name, value, note = SKIES[said]
    found = read(tmp_path, cars(environment=weather(f"<Weather {said}/>")))
    assert getattr(found.scene.weather, name) == value
    assert any("clouds" in one for one in notes(found)) is bool(note)


@pytest.mark.parametrize(
    ("sky", "friction", "note"),
    [
        ("<Weather/>", 5, "a friction of 5 is read as 1.5"),
        ("<Weather/>", -1, "a friction of -1 is read as 0.01"),
        ('<Weather><Fog visualRange="-3"/></Weather>', 1, "a visual range of -3 is read as 1"),
        ('<Weather><Sun elevation="30"/></Weather>', 1, "1718.87 is read as 90"),
        ('<Weather temperature="250"/>', 1, "temperature='250' is not read"),
        (
            '<Weather><Precipitation precipitationType="hail" precipitationIntensity="9"/></Weather>',
            1,
            "'hail'",
        ),
        (
            '<Weather><Precipitation precipitationType="rain" precipitationIntensity="-9"/></Weather>',
            1,
            "-9",
        ),
        (
            '<Weather><Precipitation precipitationType="rain" precipitationIntensity="900"/></Weather>',
            1,
            "900",
        ),
    ],
)
def test_weather_beyond_a_scene_is_noted(sky, friction, note, tmp_path):
    assert any(
        note in one for one in notes(read(tmp_path, cars(environment=weather(sky, friction))))
    )


def test_friction_without_weather_is_read(tmp_path):
    assert read(tmp_path, cars(environment=weather("", 0.4))).scene.weather.friction == 0.4


@pytest.mark.parametrize(
    ("parameters", "note"),
    [
        (
            '<ParameterDeclaration name="p" value="7"/><ParameterDeclaration name="p" value="8"/>',
            "declared again",
        ),
        (
            '<ParameterDeclaration name="p" parameterType="integer" value="7.9"/>',
            "though no integer",
        ),
    ],
)
def test_odd_parameters_are_noted(parameters, note, tmp_path):
    assert any(
        note in one for one in notes(read(tmp_path, cars(first="$p", parameters=parameters)))
    )


def test_a_parameter_of_a_story_changes_none_around_it(tmp_path):
    outer = '<ParameterDeclaration name="a" value="${$b * 2}"/><ParameterDeclaration name="b" value="5"/>'
    inner = '<ParameterDeclaration name="b" value="8"/>'

    def scene(value):  # In which the car brakes at a time.
        story = event(speed(0, "linear", 2), at(value)).replace(
            "<Act ", f"<ParameterDeclarations>{inner}</ParameterDeclarations><Act ", 1
        )
        return read(tmp_path, cars(story, parameters=outer)).scene

    assert scene("$a") == scene("10") != scene("$b") == scene("8")


@pytest.mark.parametrize("first", ["${2$v}", "${$v$v}", "${1e$v}", "${$v * $n}", "${1e400}"])
def test_a_malformed_expression_is_refused(first, tmp_path):
    parameters = (
        '<ParameterDeclaration name="v" value="3"/><ParameterDeclaration name="n" value="e"/>'
    )
    with pytest.raises(OodscenError, match="AbsoluteTargetSpeed @value: "):
        read(tmp_path, cars(first=first, parameters=parameters))


def test_a_lane_with_a_fraction_is_refused(tmp_path):
    with pytest.raises(OodscenError, match=r"LanePosition @laneId: -1\.5 is not an integer"):
        read(tmp_path, cars(place=lane(250, -1.5)))


WORDS = {
    '<RelativeTargetSpeed entityRef="ego" value="-10" speedTargetValueType="purple"/>': "'delta'",
    '<RelativeTargetSpeed entityRef="zz" value="-10" speedTargetValueType="delta"/>': "no entity 'zz'",
}


@pytest.mark.parametrize("target", WORDS)
def test_unknown_words_of_a_speed_are_noted(target, tmp_path):
    stop = STOP.replace('<AbsoluteTargetSpeed value="0"/>', target)
    found = notes(read(tmp_path, cars(event(stop, at(3)))))
    assert any(WORDS[target] in one for one in found)


def test_unknown_words_of_a_place_or_a_person_are_noted(tmp_path):
    place = lane(250).replace("/>", '><Orientation type="purple" h="0.1"/></LanePosition>')
    assert any("type='purple'" in note for note in notes(read(tmp_path, cars(place=place))))
    starts = [start("ego", lane(200), 10), start("a", lane(250))]
    person = entity("a", "pedestrian", 0.0, 0.5, 0.6).replace('="pedestrian"', '="purple"')
    found = notes(read(tmp_path, file([entity("ego"), person], starts)))
    assert any("pedestrianCategory='purple' is read as 'pedestrian'" in one for one in found)


@given(st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=3))
@IN_FOLDER
def test_a_place_relative_to_itself_moves_an_entity_from_where_it_was(tmp_path, steps):
    moved = [f'<RelativeObjectPosition entityRef="a" dx="{dx}" dy="0"/>' for dx in steps]
    again = f'<Private entityRef="a">{placed(lane(260.0), *moved)}{speed(5)}</Private>'
    text = file([entity("ego"), entity("a")], [start("ego", lane(200), 10), again])
    found = read(tmp_path, text)
    expected = pytest.approx(60.0 + sum(steps), abs=0.01)
    assert found.scene.actors[0].placement.ahead_m == expected
    assert not [note for note in notes(found) if "placed again" in note]


@pytest.mark.parametrize("name", ["NA", "null", "nan", "no", "Nothing"])
def test_entities_may_have_the_name_of_a_missing_value(tmp_path, name):
    starts = [start("ego", lane(200), 10), start(name, lane(250), 5)]
    found = read(tmp_path, file([entity("ego"), entity(name)], starts))
    assert [actor.id for actor in found.scene.actors] == [f"{name.lower()}-2"]


@pytest.mark.parametrize("first", [-5.0, -0.5, 0.0])
def test_the_notes_on_an_ego_that_does_not_go_ahead_agree(first, tmp_path):
    """What is read as 0 and what is driven instead are two steps, not two readings of one speed."""
    found = read(tmp_path, cars(ego=first))
    told = [note.rpartition(": ")[2] for note in notes(found) if "speed" in note]
    limit = f"without a first speed above 0 the ego starts at the limit of its road, {found.scene.ego.speed:g} m/s"
    assert told == [f"a speed of {first:g} is read as 0"] * (first < 0.0) + [limit]

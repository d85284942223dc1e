"""Conditions, acts and the times of courses as triggers of a scene."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._scene import Trigger
from oodscen.errors import OodscenError
from tests.interchange.reading.files import (
    IN_FOLDER,
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
    world,
)

STOP = speed(0, "linear", 6, "rate")


def trigger(found):
    one = found.scene.actors[0].behaviour.trigger
    return one.kind, one.value, one.actor


def crowd(condition, lengths=(4.5, 4.5, 4.5), ahead=(1.4, 1.4, 1.4)):
    names, places = ("ego", "a", "b"), (lane(200), lane(250), lane(300, -2))
    bodies = [
        entity(name, ahead=far, length=length)
        for name, far, length in zip(names, ahead, lengths, strict=True)
    ]
    starts = [start(name, place, 5) for name, place in zip(names, places, strict=True)]
    return file(bodies, starts, event(STOP, condition))


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        (by_entity(near(20)), ("distance", 20.0, None)),
        (by_entity(near(20, "ego"), "a"), ("distance", 20.0, None)),
        (by_entity(near(20, "b")), ("distance", 20.0, "b")),
        (by_entity(near(20, freespace="true")), ("distance", 25.5, None)),
    ],
)
def test_a_distance_is_that_of_the_entities_which_it_names(condition, expected, tmp_path):
    found = read(tmp_path, crowd(condition, lengths=(4.5, 6.5, 4.5)))
    assert trigger(found) == expected


def test_the_box_of_a_vehicle_is_not_that_of_its_trailer(tmp_path):
    """Where the trailer stands before the box, too, as the schema allows."""
    trailer = entity("t", ahead=-7.0, length=9.0)
    towing = entity("a").replace("<BoundingBox>", f"<Trailer>{trailer}</Trailer><BoundingBox>", 1)
    story = event(speed(0), by_entity(near(20, freespace="true")))
    starts = [start("ego", lane(200), 10), start("a", lane(250), 5)]
    alone, pair = (
        read(tmp_path, file([entity("ego"), one], starts, story)).scene.actors
        for one in (entity("a"), towing)
    )
    assert alone == pair


def test_a_distance_of_reference_points_is_read_as_that_of_centres(tmp_path):
    found = read(tmp_path, crowd(by_entity(near(20)), ahead=(1.4, 3.4, 1.4)))
    assert trigger(found) == ("distance", 22.0, None)


@pytest.mark.parametrize(
    ("condition", "note"),
    [
        (by_entity(near(20, "b"), "a"), "a condition of a and b, not of the ego"),
        (by_entity(near(20, "zz")), "there is no entity 'zz'"),
        (by_entity(near(20), "zz"), "there is no entity 'zz'"),
        (by_entity(near(20), "ego", "b"), "a condition of several entities"),
        (by_entity(near(20, kind="lateral")), "a lateral distance is not read"),
        (by_entity(near(20, rule="greaterThan")), "rule='greaterThan' is not read"),
    ],
)
def test_a_condition_that_no_trigger_says_is_noted(condition, note, tmp_path):
    found = read(tmp_path, crowd(condition))
    assert any(note in one for one in notes(found))
    assert any("Event: when it starts is not known" in one for one in notes(found))
    does = found.scene.actors[0].behaviour
    assert (does.name, does.parameters) == ("follow_lane", {"speed": 5.0})


def test_what_stands_and_does_nothing_else_starts_at_once(tmp_path):
    found = read(tmp_path, cars(event(speed(7), by_entity(near(20, "zz"))), first=0.0))
    does = found.scene.actors[0].behaviour
    assert (does.name, does.parameters) == ("follow_lane", {"speed": 7.0})
    assert any("a does this at once" in note for note in notes(found))


def state(name, what, kind="event"):
    return (
        f'<ByValueCondition><StoryboardElementStateCondition storyboardElementType="{kind}" '
        f'storyboardElementRef="{name}" state="{what}"/></ByValueCondition>'
    )


def chain(condition, first, action=STOP):
    """Return a file in which `a` does something by a condition, and `b` brakes for 2 s by another."""
    brake = event(speed(1, "linear", 2), first, name="b").replace('name="e"', 'name="f"')
    starts = [start(name, lane(s), 5) for name, s in (("ego", 200), ("a", 250), ("b", 290))]
    bodies = [entity(name) for name in ("ego", "a", "b")]
    return file(bodies, starts, brake + event(action, condition))


@given(st.floats(1.0, 100.0), st.floats(0.0, 20.0))
@IN_FOLDER
def test_waiting_for_an_event_is_waiting_for_its_time(tmp_path, seconds, delay):
    began = event(STOP, state("f", "startTransition"), delay=delay)
    found = read(tmp_path, chain("", at(seconds)).replace(event(STOP, ""), began))
    assert trigger(found) == ("time", pytest.approx(seconds + delay, abs=0.0011), None)
    found = read(tmp_path, chain(state("f", "completeState"), at(seconds)))
    assert trigger(found) == ("time", pytest.approx(seconds + 2, abs=0.0011), None)
    assert any("its end is read as the time" in note for note in notes(found))


@pytest.mark.parametrize(
    ("before", "after", "seconds"), [(5, 0, 4.0), (5, 15, 1.0), (0.6, 0, 10.0), (0, -10, 2.0)]
)
def test_an_event_over_a_distance_takes_its_time_at_the_mean_speed(
    before, after, seconds, tmp_path
):
    held = event(speed(after, "linear", 10, "distance"), at(3), name="b").replace(
        'name="e"', 'name="f"'
    )
    bodies = [entity(name) for name in ("ego", "a", "b")]
    starts = [start("ego", lane(200), 10), start("a", lane(250), 5), start("b", lane(270), before)]
    text = file(bodies, starts, held + event(STOP, state("f", "completeState")))
    assert trigger(read(tmp_path, text)) == ("time", 3 + seconds, None)


def test_waiting_for_an_event_by_distance_is_waiting_for_that_distance(tmp_path):
    found = read(tmp_path, chain(state("f", "startTransition"), by_entity(near(20, "b"))))
    assert trigger(found) == ("distance", 20.0, "b")


@pytest.mark.parametrize(
    "text",
    [
        chain(state("e", "startTransition"), at(3)),
        chain(state("e", "endTransition"), at(3)),
        chain(state("zz", "endTransition"), at(3)),
        chain(state("f", "endTransition"), by_entity(near(20, "b"))),
        chain(state("f", "endTransition"), state("e", "endTransition")),
        chain(state("f", "skipTransition"), at(3)),
    ],
)
def test_an_event_that_waits_for_nothing_known_is_left_out(text, tmp_path):
    found = read(tmp_path, text)
    assert found.scene.actors[0].behaviour.name == "follow_lane"
    assert any("a does not do this" in note for note in notes(found))


def test_waiting_for_an_event_of_nobody_is_left_out(tmp_path):
    text = chain(state("f", "startTransition"), at(3))
    found = read(tmp_path, text.replace('<EntityRef entityRef="b"/></Actors>', "</Actors>"))
    assert found.scene.actors[0].behaviour.name == "follow_lane"
    assert any("the start of this is not known" in note for note in notes(found))


def test_long_chains_of_events_are_left_out(tmp_path):
    waits = [
        event(STOP, state(f"e{number + 1}", "startTransition")).replace(
            'name="e"', f'name="e{number}"'
        )
        for number in range(500)
    ]
    found = read(tmp_path, cars("".join(waits)))
    assert found.scene.actors[0].behaviour.name == "follow_lane"


@pytest.mark.parametrize(
    ("seconds", "name"), [(4, "stall"), (1, "hard_brake"), (0.5, "hard_brake")]
)
@pytest.mark.parametrize("begins", [0, 0.3, 2])
def test_a_brake_is_one_also_at_the_start(begins, seconds, name, tmp_path):
    found = read(tmp_path, cars(event(speed(0, "linear", seconds), at(begins))))
    does = found.scene.actors[0].behaviour
    assert (does.name, does.parameters["speed"]) == (name, 5.0)
    assert trigger(found)[1] == begins


def test_a_first_speed_that_an_event_replaces_is_noted(tmp_path):
    found = read(tmp_path, cars(event(speed(9), at(0))))
    assert found.scene.actors[0].behaviour.parameters == {"speed": 9.0}
    assert any("9 m/s, in place of 5 m/s" in note for note in notes(found))


@pytest.mark.parametrize(
    ("stop", "note"),
    [
        (speed(0), "a stop at once"),
        (speed(0, "linear", 0), "a stop at once"),
        (speed(0, "linear", 0, "rate"), "a rate of 0"),
    ],
)
def test_a_stop_of_no_duration_is_noted(stop, note, tmp_path):
    assert any(note in one for one in notes(read(tmp_path, cars(event(stop, at(3))))))


def test_a_delay_after_a_distance_is_noted_and_after_a_time_added(tmp_path):
    found = read(tmp_path, cars(event(STOP, at(3), delay=2)))
    assert trigger(found) == ("time", 5.0, None)
    found = read(tmp_path, cars(event(STOP, by_entity(near(20)), delay=2)))
    assert trigger(found) == ("distance", 20.0, None)
    assert any("the delay of 2 s" in note for note in notes(found))


@pytest.mark.parametrize(("seconds", "kept"), [(1e6, 500.0), (-3, 0.0)])
def test_a_time_beyond_a_scene_is_noted(seconds, kept, tmp_path):
    found = read(tmp_path, cars(event(STOP, at(seconds))))
    assert trigger(found)[1] == kept
    assert any(f"is read as {kept:g}" in note for note in notes(found))


def act(condition, tag="StartTrigger"):
    held = f'<Condition name="d" delay="0" conditionEdge="none">{condition}</Condition>'
    return f"<{tag}><ConditionGroup>{held}</ConditionGroup></{tag}>"


def test_an_event_starts_after_its_act(tmp_path):
    for first, then, both in ((5, 3, 5.0), (3, 5, 5.0), (0, 3, 3.0)):
        found = read(tmp_path, cars(event(STOP, at(then), act=act(at(first)))))
        assert trigger(found) == ("time", both, None)
    found = read(tmp_path, cars(event(STOP, at(0), act=act(by_entity(near(20))))))
    assert trigger(found) == ("distance", 20.0, None)
    found = read(tmp_path, cars(event(STOP, by_entity(near(20)), act=act(at(5)))))
    assert any("the act starts by a time" in note for note in notes(found))


@pytest.mark.parametrize(
    ("condition", "kept"),
    [
        (at(0), 7.0),
        (
            '<ByValueCondition><StoryboardElementStateCondition storyboardElementType="story" '
            'storyboardElementRef="s" state="runningState"/></ByValueCondition>',
            7.0,
        ),
        (at(4), 10.0),
        (by_entity(near(20)), 10.0),
        ("<ByEntityCondition/>", 10.0),
    ],
)
def test_only_what_the_ego_does_at_once_is_its_first_speed(condition, kept, tmp_path):
    found = read(tmp_path, cars(event(speed(7), condition, name="ego")))
    assert found.scene.ego.speed == kept


def test_what_ends_an_act_is_noted(tmp_path):
    found = read(tmp_path, cars(event(STOP, at(3), act=act(at(1), "StopTrigger"))))
    assert any("StopTrigger: is not read" in note for note in notes(found))


def test_the_event_of_an_entity_that_does_not_exist_is_noted(tmp_path):
    found = notes(read(tmp_path, cars(event(STOP, at(3), name="zz"))))
    assert any("EntityRef: there is no entity 'zz'" in one for one in found)


def test_a_change_to_a_lane_that_does_not_exist_is_left_out(tmp_path):
    change = (
        "<PrivateAction><LateralAction><LaneChangeAction><LaneChangeTarget>"
        '<AbsoluteTargetLane value="9"/></LaneChangeTarget></LaneChangeAction></LateralAction></PrivateAction>'
    )
    found = read(tmp_path, cars(event(change, at(3))))
    assert found.scene.actors[0].behaviour.name == "follow_lane"
    assert any("road '1' has no lane 9" in note for note in notes(found))


# ------------------------------------------------------------------ courses


def course(timing, times=(0, 8), closed="false", condition=None, first=0):
    vertices = "".join(
        f'<Vertex time="{time}"><Position>{world(250, y, 1.5708)}</Position></Vertex>'
        for time, y in zip(times, (-8, 8), strict=True)
    )
    action = (
        f'<PrivateAction><RoutingAction><FollowTrajectoryAction><Trajectory name="t" closed="{closed}">'
        f"<Shape><Polyline>{vertices}</Polyline></Shape></Trajectory><TimeReference>{timing}</TimeReference>"
        '<TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction></PrivateAction>'
    )
    starts = [start("ego", lane(200), 10), start("a", world(250, -8, 1.5708), first)]
    bodies = [entity("ego"), entity("a", "pedestrian", 0.0, 0.5, 0.6)]
    return file(bodies, starts, event(action, condition or at(3)))


def timing(scale=1, offset=0, domain="relative"):
    return f'<Timing domainAbsoluteRelative="{domain}" scale="{scale}" offset="{offset}"/>'


@pytest.mark.parametrize(
    ("timed", "times", "pace", "begins"),
    [
        (timing(), (0, 8), 2.0, 3.0),
        (timing(2), (0, 8), 1.0, 3.0),
        (timing(1, 4), (0, 8), 2.0, 7.0),
        (timing(1, 0, "absolute"), (10, 18), 2.0, 10.0),
        (timing(1, 0, "absolute"), (1, 9), 2.0, 3.0),
    ],
)
def test_a_course_keeps_its_times(timed, times, pace, begins, tmp_path):
    found = read(tmp_path, course(timed, times))
    assert found.scene.actors[0].behaviour.parameters == {"distance": 16.0, "speed": pace}
    assert trigger(found) == ("time", begins, None)


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (course(timing(0)), "times cannot be scaled by 0"),
        (course(timing(-1)), "times cannot be scaled by -1"),
        (course(timing(), (8, 0)), "the times of the course do not grow"),
        (course(timing(), closed="true"), "closed='true' is not read"),
        (course(timing(1, 4), condition=by_entity(near(20))), "not at 4 s"),
        (course("<None/>"), "no speed of its own"),
    ],
)
def test_a_course_whose_times_cannot_be_kept_is_noted(text, note, tmp_path):
    assert any(note in one for one in notes(read(tmp_path, text)))


@pytest.mark.parametrize("kind", ["car", "bicycle"])
@pytest.mark.parametrize("first", [0, 4])
@pytest.mark.parametrize("condition", [at(5), by_entity(near(30))])
def test_a_later_start_of_a_course_is_kept_or_noted(kind, first, condition, tmp_path):
    text = course(timing(), condition=condition, first=first)
    body = entity("a", "pedestrian", 0.0, 0.5, 0.6)
    found = read(tmp_path, text.replace(body, entity("a").replace('="car"', f'="{kind}"')))
    does = found.scene.actors[0].behaviour
    is_lost = any("the first speed" in note and "are left out" in note for note in notes(found))
    assert is_lost or (does.name == "cross_road" and does.trigger != Trigger())


@pytest.mark.parametrize("condition", [at(5), by_entity(near(30))])
def test_a_trigger_that_is_left_out_does_not_tell_the_decision(condition, tmp_path):
    body = entity("a", "pedestrian", 0.0, 0.5, 0.6)
    text = course(timing(), condition=condition, first=4).replace(body, entity("a"))
    scene = read(tmp_path, text).scene
    does, decision = scene.actors[0].behaviour, scene.decision
    assert (does.name, does.trigger) == ("run_red", Trigger())
    assert (decision.kind, decision.value) == ("ttc", 3.0)


def test_a_pause_within_a_course_is_noted(tmp_path):
    middle = (
        f'<Vertex time="7.5"><Position>{world(250, -7, 1.5708)}</Position></Vertex><Vertex time="8"'
    )
    found = read(tmp_path, course(timing()).replace('<Vertex time="8"', middle))
    assert any("is read at its mean speed" in note for note in notes(found))


def test_times_without_a_reference_do_not_count_for_what_moves(tmp_path):
    found = read(tmp_path, course("<None/>", first=1.0))
    assert found.scene.actors[0].behaviour.parameters["speed"] == 1.0


# ------------------------------------------------------------------ catalogues

CAR = '<Vehicle name="v" vehicleCategory="car"/>'
HELD = "<VehicleCatalog><Directory path='cars'/></VehicleCatalog>"
USED = '<ScenarioObject name="a"><CatalogReference catalogName="C" entryName="v"/></ScenarioObject>'


def from_catalogue(folder, content, name="C"):
    (folder / "cars").mkdir()
    text = f'<OpenSCENARIO><FileHeader/><Catalog name="{name}">{content}</Catalog></OpenSCENARIO>'
    (folder / "cars" / "c.xosc").write_text(text)
    starts = [start("ego", lane(200), 10), start("a", lane(250), 5)]
    return read(folder, file([entity("ego"), USED], starts, catalogues=HELD))


def test_an_entry_that_occurs_twice_is_noted(tmp_path):
    found = from_catalogue(tmp_path, CAR + CAR)
    assert any("the entry 'v' occurs 2 times" in note for note in notes(found))


@pytest.mark.parametrize(
    ("content", "name", "why"),
    [
        (CAR, "D", "no catalogue 'C' has an entry 'v'"),
        ("<Vehicle", "C", "c.xosc cannot be read: not well-formed XML"),
        (
            '<CatalogReference catalogName="C" entryName="v" name="v"/>',
            "C",
            "is a reference itself",
        ),
    ],
)
def test_the_cause_of_a_missing_entry_is_named(content, name, why, tmp_path):
    with pytest.raises(OodscenError, match=why):
        from_catalogue(tmp_path, content, name)


def test_what_is_not_read_of_an_entry_has_its_file(tmp_path):
    found = from_catalogue(tmp_path, CAR.replace("/>", '><Trailer mass="3"/></Vehicle>'))
    assert any("line 1 of c.xosc: Trailer: is not read" in note for note in notes(found))


@pytest.mark.parametrize("path", ["cars", "../outside/cars"])
def test_a_catalogue_may_lie_outside_also_through_a_link(path, tmp_path):
    """As files of others name those of their collection."""
    inside, outside = tmp_path / "inside", tmp_path / "outside" / "cars"
    outside.mkdir(parents=True)
    inside.mkdir()
    text = f'<OpenSCENARIO><FileHeader/><Catalog name="C">{CAR}</Catalog></OpenSCENARIO>'
    (outside / "c.xosc").write_text(text)
    (inside / "cars").symlink_to(outside)
    starts = [start("ego", lane(200), 10), start("a", lane(250), 5)]
    named = HELD.replace("cars", path)
    found = read(inside, file([entity("ego"), USED], starts, catalogues=named))
    assert found.scene.actors[0].asset == "car"


def test_a_time_to_contact_is_noted(tmp_path):
    condition = (
        '<TimeToCollisionCondition value="2" freespace="{}" rule="lessThan"><TimeToCollisionConditionTarget>'
        '<EntityRef entityRef="a"/></TimeToCollisionConditionTarget></TimeToCollisionCondition>'
    )
    for freespace, is_told in (("true", True), ("false", False)):
        found = read(tmp_path, crowd(by_entity(condition.format(freespace))))
        assert trigger(found) == ("ttc", 2.0, None)
        told = any("TimeToCollisionCondition: the time to contact" in note for note in notes(found))
        assert told is is_told


def test_a_synchronised_arrival_is_noted(tmp_path):
    action = (
        '<PrivateAction><SynchronizeAction masterEntityRef="ego">'
        f"<TargetPositionMaster>{lane(280)}</TargetPositionMaster><TargetPosition>{lane(300)}</TargetPosition>"
        '<FinalSpeed><AbsoluteSpeed value="5"/></FinalSpeed></SynchronizeAction></PrivateAction>'
    )
    found = read(tmp_path, cars(event(action, at(2))))
    assert found.scene.actors[0].behaviour.name == "follow_lane"
    (told,) = [note for note in notes(found) if "SynchronizeAction" in note]
    assert told.startswith("line ")
    assert "no behaviour does this" in told

"""Trajectories and routes of an OpenSCENARIO file: their points and times."""

import math
from itertools import pairwise
from typing import NamedTuple

from oodscen.data._scene import MAX_TRIGGER, Trigger
from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element

_STRAIGHT_M = 1.0
"""Distance from the straight way between its ends up to which a course is straight, m."""
_PACE_SHARE = 0.05
"""Share of the fastest part of a course by which its parts may differ without a note."""


class CoursePoint(NamedTuple):
    """One point of a course that is read."""

    element: Element
    """The element with its time."""
    place: EntityPlace


class CourseTimes(NamedTuple):
    """The times of a course, s."""

    begin_s: float
    duration_s: float


def course_points(course: Element, positions: Positions) -> list[CoursePoint]:
    """Return the points of a course whose positions are read."""
    holders = [
        (point, point.first("Position"))
        for kind in ("Vertex", "Waypoint", "ControlPoint")
        for point in course.within(kind)
    ]
    if course.name == "AcquirePositionAction":
        goal = course.first("Position")
        holders += [] if goal is None else [(goal, goal)]
    places = [
        (element, None if position is None else positions.read(position))
        for element, position in holders
    ]
    return [CoursePoint(element, place) for element, place in places if place is not None]


def timing_of(course: Element) -> Element | None:
    """Return the element that gives the times of a course their meaning, or `None` if they do not count."""
    reference = course.first("TimeReference")
    return None if reference is None else reference.first("Timing")


def course_times(course: Element, points: list[CoursePoint]) -> CourseTimes | None:
    """Return the times of a course, or `None` if it has none that can be used."""
    times_s = [point.element.number("time", 0.0) for point in points]
    timing = timing_of(course)
    scale = 1.0 if timing is None else timing.number("scale", 1.0)
    offset_s = 0.0 if timing is None else timing.number("offset", 0.0)
    if any(later <= earlier for earlier, later in pairwise(times_s)) and any(times_s):
        course.note("the times of the course do not grow and are left out")
        return None
    if timing is not None and scale <= 0.0:
        timing.note(f"times cannot be scaled by {scale:g} and are left out")
        return None
    duration_s = scale * (times_s[-1] - times_s[0])
    return CourseTimes(offset_s + scale * times_s[0], duration_s) if duration_s > 0.0 else None


def course_start(course: Element, trigger: Trigger, begin_s: float) -> Trigger:
    """Return when an entity leaves the first point of a course whose action starts by a trigger."""
    timing = timing_of(course)
    if timing is None:
        return trigger
    is_absolute = timing.word("domainAbsoluteRelative", "relative", "absolute") == "absolute"
    if begin_s == 0.0:
        return trigger
    if trigger.kind != "time":
        timing.note(f"the course begins at its {trigger.kind}, not at {begin_s:g} s")
        return trigger
    start_s = max(begin_s, trigger.value) if is_absolute else trigger.value + begin_s
    return Trigger(value=round(timing.bounded(start_s, 0.0, MAX_TRIGGER, "a time of"), 3))


def note_paces(course: Element, points: list[CoursePoint]) -> None:
    """Record the slowest and the fastest part of a course that is read at its mean speed."""
    paces = [
        math.hypot(later.place.x - earlier.place.x, later.place.y - earlier.place.y)
        / (later.element.number("time", 0.0) - earlier.element.number("time", 0.0))
        for earlier, later in pairwise(points)
    ]
    if max(paces) - min(paces) > _PACE_SHARE * max(paces):
        course.note(
            f"the course has parts of {min(paces):.1f} and of {max(paces):.1f} m/s and is read at its mean speed"
        )


def note_bends(
    course: Element, points: list[CoursePoint], start: EntityPlace, heading: float
) -> None:
    """Record that a course is not the straight way from a start in a direction."""
    way = start._replace(heading=heading)
    if any(abs(point.place.offset_from(way)[1]) > _STRAIGHT_M for point in points):
        course.note("the course is read as a straight way from its first point to its last")

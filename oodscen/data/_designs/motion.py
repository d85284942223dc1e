"""Motions made to order: movements that a scene carries, for what no catalogue has."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from oodscen.data._base import ROUNDING, LeanData
from oodscen.data._category import Category
from oodscen.data._designs.courses import Circle, Drift, KeyPose, Roll, Swing, Walk
from oodscen.data._designs.description import Description
from oodscen.data._designs.poses import PoseTrack
from oodscen.data._issues import IssuesError
from oodscen.errors import DataError, Issue

if TYPE_CHECKING:
    from oodscen.data._catalogue import BehaviourKind

KEYED = "keyed"
"""Id of the behaviour of the kinematic world that moves bodies through key poses."""
MOST_KEYS = 24
LONGEST_S = 60.0
"""Greatest time of a key, s."""
FARTHEST_M = 300.0
"""Greatest distance of the ego at a key, m."""
EGO_MPS = 10.0
"""Speed of the ego for which a motion over its distance is checked before a scene is known, m/s."""
EASE: dict[str, float] = {"time": 1.0, "ego": 5.0}
"""Stretch over which a repeated motion gathers pace, s or m of the ego."""
BACKWARDS = 0.4
"""Share of its speed that a body reaches backwards."""
LEAST_SPAN = 0.05
"""Least distance between two keys, s or m of the ego."""
NEAR_M = 1e-6
"""Difference between the first and the last key of a repeated motion that counts as none, m or degrees."""

Frame = Literal["start", "lane", "other", "ego"]
BodyKind = Literal["person", "animal", "cyclist", "car", "truck", "loose", "flying"]
Facing = Literal["fixed", "along", "against"]
Ending = Literal["stay", "repeat", "go_on"]

_BODY_FRAMES = ("other", "ego")
"""Frames that move with another body."""
_COURSES = ("keys", "walk", "roll", "drift", "swing", "circle")


class Ability(NamedTuple):
    """The limits of what a kind of body can do."""

    words: str
    speed: float
    """m/s"""
    acceleration: float
    """In any direction along the ground, m/s^2."""
    climb: float
    """Up or down, m/s."""
    height: float
    """Greatest height above the road, m."""
    spin: float
    """Rate of turn about any axis, degrees per second."""
    radius: float
    """Least radius of a turn that it faces along, m."""
    categories: tuple[Category, ...]
    """Categories of the assets that are such bodies."""


ABILITIES: dict[BodyKind, Ability] = {
    "person": Ability("a person", 8, 6, 4, 3, 400, 0, ("pedestrian",)),
    "animal": Ability("an animal", 18, 10, 6, 3, 400, 0, ("animal",)),
    "cyclist": Ability("a cyclist", 15, 6, 4, 3, 180, 1.2, ("cyclist",)),
    "car": Ability("a car", 45, 9.5, 6, 4, 180, 4, ("vehicle",)),
    "truck": Ability("a truck", 30, 6, 3, 4, 60, 6, ("vehicle",)),
    "loose": Ability(
        "a loose thing", 30, 25, 20, 30, 1440, 0, ("object", "work_zone", "vegetation", "signal")
    ),
    "flying": Ability("a flying thing", 25, 15, 10, 30, 720, 0, ("object", "animal")),
}


class Motion(LeanData):
    """The design of one movement: a body's key poses, or a course that yields them."""

    _left_out: ClassVar = ("let_go", *_COURSES)

    schema_version: Literal[1] = 1
    id: str = Field(pattern=r"^[a-z][a-z0-9_]{1,39}$")
    """Its name as a behaviour."""
    description: Description
    """Visible movement as a participle, e.g. `falling over across the road`."""
    body: BodyKind
    """Kind of body that moves so; it limits speed, acceleration and turning."""
    frame: Frame = "start"
    """Reference of the keys: straight on from the actor's start and heading, the road as the ego drives it,
    the actor `other`, or the ego. Before the trigger an actor rides on `other`; elsewhere it waits."""
    by: Literal["time", "ego"] = "time"
    """Meaning of `at`: seconds since the trigger, or metres that the ego has driven since then."""
    facing: Facing = "fixed"
    """Heading: that of the frame, along the actor's way, or against it; the yaw of a key is added."""
    begins: Literal["rest", "moving"] = "rest"
    """Before the trigger it rests in the pose of the first key, or comes straight on at its first speed."""
    then: Ending = "stay"
    """End: it stays at the last key, begins again at the first, or goes on at its last velocity."""
    pivot_m: float = Field(default=0.0, ge=0, le=30)
    """Height above the body's underside about which it pitches and rolls, m: 0 for what falls over."""
    let_go: float | None = Field(default=None, ge=0, le=300)
    """`at` from which an actor in the frame of another body is let go: it flies on, falls and slides to rest."""
    delay: float = Field(default=0.0, ge=0, le=20)
    """Every actor begins up to so much later, drawn from the seed: people of a crowd differ."""
    pace: float = Field(default=0.0, ge=0, le=0.5)
    """Every actor is up to this share faster or slower, drawn from the seed."""
    keys: tuple[KeyPose, ...] = Field(default=(), max_length=MOST_KEYS)
    """Poses in order; the first is at 0 and where the actor is placed."""
    walk: Walk | None = None
    roll: Roll | None = None
    drift: Drift | None = None
    swing: Swing | None = None
    circle: Circle | None = None

    @model_validator(mode="after")
    def _sound(self) -> Self:
        issues = list(_form_faults(self))
        if not issues or _is_measurable(self):
            issues += motion_faults(self)
        if issues:
            # A course is the path of all its stretches, of which several may have one fault.
            raise IssuesError(tuple(dict.fromkeys(issues)))
        return self

    @property
    def course(self) -> str:
        """The member that gives the key poses: `keys` or the name of a course."""
        return next(name for name in _COURSES if getattr(self, name))

    def poses(self) -> tuple[KeyPose, ...]:
        """Return the key poses, those of its course if it has one."""
        if self.keys:
            return self.keys
        course: Walk | Roll | Drift | Swing | Circle = getattr(self, self.course)
        return course.poses()

    def track(self) -> PoseTrack:
        """Return the smooth curve through the key poses."""
        rows = [pose.values() for pose in self.poses()]
        return PoseTrack.of(rows, self.then, is_moving=self.begins == "moving")

    @property
    def fastest(self) -> float:
        """Greatest speed of its body, m/s: backwards it is less."""
        return ABILITIES[self.body].speed * (BACKWARDS if self.facing == "against" else 1.0)

    @property
    def is_tilting(self) -> bool:
        """True if the body ever pitches or rolls."""
        return any(pose.pitch or pose.roll for pose in self.poses())

    def kind(self) -> "BehaviourKind":
        """Return it as a behaviour of a catalogue."""
        from oodscen.data._catalogue import BehaviourKind

        last = self.poses()[-1]
        way = " along the road" if self.frame == "lane" else ""
        unit = "s" if self.by == "time" else "m of the ego's way"
        ahead, left = last.ahead + 0.0, last.left + 0.0  # A zero loses its minus sign.
        extent = f"{ahead:.3g} m ahead and {left:.3g} m to the left in {last.at:.3g} {unit}"
        return BehaviourKind(
            id=self.id,
            description=f"{self._before()}; from the trigger on{way}: {self.description} ({extent})",
            categories=ABILITIES[self.body].categories,
            needs_other=self.frame == "other",
            like=KEYED,
        )

    def _before(self) -> str:
        """Return what the body does before the trigger."""
        if self.frame == "other":
            return "goes along with another actor"
        if self.begins == "rest":
            return "stands"
        _, second, *_ = self.poses()
        speed = math.hypot(second.ahead, second.left) / second.at
        return f"moves straight ahead at {speed:.2g} m/s" if speed else "stands"


def motion_faults(motion: Motion, ego_speed: float = EGO_MPS) -> list[Issue]:
    """Return the faults of a motion that its body cannot do, with paths in the writer's coordinates.

    Args:
        motion: A motion in good form.
        ego_speed: Speed of the ego for keys over its distance, m/s.
    """
    rate = max(ego_speed, 1.0) if motion.by == "ego" else 1.0
    rate *= 1.0 + motion.pace
    track, ability = motion.track(), ABILITIES[motion.body]
    issues = [
        Issue(_at(motion, index + 1), message)
        for index in range(len(track.spans))
        if (message := _stretch_fault(motion, track, index, rate, ability))
    ]
    if motion.then == "repeat" and not issues:
        acceleration, index = track.set_off(EASE[motion.by])
        acceleration *= rate * rate
        if acceleration > ability.acceleration + ROUNDING:
            message = (
                f"needs {acceleration:.3g} m/s^2 to get under way from rest; {ability.words} can "
                f"{ability.acceleration:g}: begin more slowly"
            )
            issues.append(Issue(_at(motion, index + 1), message))
    for index, pose in enumerate(motion.poses()):
        if pose.up > ability.height:
            message = f"{ability.words} gets {ability.height:g} m above the road at most"
            issues.append(Issue(_at(motion, index, "up"), message))
    return issues


def _form_faults(motion: Motion) -> Iterator[Issue]:
    """Yield the faults of the form: what is missing, out of order, or does not fit together."""
    courses = [name for name in _COURSES if getattr(motion, name)]
    if not courses:
        yield Issue("keys", f"give one of {', '.join(_COURSES)}; none is given")
        return
    if len(courses) > 1:
        yield Issue(courses[1], f"give one of {', '.join(_COURSES)}; not {' and '.join(courses)}")
        return
    try:
        poses = motion.poses()
    except DataError as error:
        for issue in error.issues:
            yield Issue(motion.course, f"leads to a key whose `{issue.path}` is out of range")
        return
    yield from _key_faults(motion, poses)
    yield from _begin_faults(motion, poses)
    yield from _end_faults(motion, poses)


def _key_faults(motion: Motion, poses: Sequence[KeyPose]) -> Iterator[Issue]:
    """Yield the faults of the keys: the first is 0, times rise up to a limit, and something moves."""
    unit, limit = ("m", FARTHEST_M) if motion.by == "ego" else ("s", LONGEST_S)
    first, last = poses[0], poses[-1]
    if first.at != 0:
        yield Issue(_at(motion, 0, "at"), "the first key is at 0")
    for name in ("ahead", "left"):
        if getattr(first, name) != 0:
            yield Issue(_at(motion, 0, name), "the first key is where the actor is placed: 0")
    for index, (pose, following) in enumerate(pairwise(poses), start=1):
        if following.at < pose.at + LEAST_SPAN:
            message = f"must be at least {LEAST_SPAN:g} {unit} after the key before it"
            yield Issue(_at(motion, index, "at"), message)
    if last.at > limit:
        yield Issue(_at(motion, len(poses) - 1, "at"), f"at most {limit:g} {unit}")
    if motion.frame in ("start", "lane") and len({pose.values()[1:] for pose in poses}) < 2:
        yield Issue(motion.course, "nothing moves: at least two keys differ")


def _begin_faults(motion: Motion, poses: Sequence[KeyPose]) -> Iterator[Issue]:
    """Yield the faults of a body that moves before the trigger."""
    if motion.begins == "rest":
        return
    if motion.by == "ego" or motion.frame in _BODY_FRAMES:
        yield Issue("begins", "what moves with another body cannot move before: `rest`")
    elif len(poses) < 2 or motion.then == "repeat":
        yield Issue("begins", "needs at least two keys, and no repetition")


def _end_faults(motion: Motion, poses: Sequence[KeyPose]) -> Iterator[Issue]:
    """Yield the faults of the end: letting go, going on and repeating."""
    if motion.let_go is not None:
        if motion.frame not in _BODY_FRAMES:
            message = "only what moves with another body (`other`, `ego`) can be let go"
            yield Issue("let_go", message)
        elif motion.facing != "fixed":
            yield Issue("facing", "what is let go keeps its heading: `fixed`")
    if motion.then != "stay" and len(poses) < 2:
        yield Issue("then", "needs at least two keys")
    elif motion.then == "repeat":
        yield from _seam_faults(motion, poses[0], poses[-1])


def _is_measurable(motion: Motion) -> bool:
    """Return whether there is one course, its keys are far enough apart, and two if they repeat."""
    if sum(bool(getattr(motion, name)) for name in _COURSES) != 1:
        return False
    try:
        poses = motion.poses()
    except DataError:
        return False
    if motion.then == "repeat" and len(poses) < 2:
        return False
    return all(following.at >= pose.at + LEAST_SPAN for pose, following in pairwise(poses))


def _seam_faults(motion: Motion, first: KeyPose, last: KeyPose) -> Iterator[Issue]:
    """Yield a fault where the last pose of a repeated motion is not the first."""
    index = len(motion.poses()) - 1
    for name in ("ahead", "left", "up", "yaw", "pitch", "roll"):
        gap = abs(getattr(first, name) - getattr(last, name))
        if name in ("yaw", "pitch", "roll"):
            gap = min(gap % 360.0, -gap % 360.0)
        if gap > NEAR_M:
            yield Issue(_at(motion, index, name), "what repeats ends in the pose of its first key")


def _stretch_fault(
    motion: Motion, track: PoseTrack, index: int, rate: float, ability: Ability
) -> str | None:
    """Return the reason why a body cannot move so between two keys, `None` if it can."""
    measures = track.measure(index)
    speed, climb, spin = measures.speed * rate, measures.climb * rate, measures.spin * rate
    acceleration = measures.acceleration * rate * rate
    unit = "s" if motion.by == "time" else "m of the ego"
    stretch = f"{track.moved(index):.3g} m within {track.spans[index]:g} {unit}"
    if speed > motion.fastest + ROUNDING:
        backwards = "backwards " if motion.facing == "against" else ""
        can = f"{ability.words} can {backwards}{motion.fastest:g}"
        return f"{stretch} takes {speed:.3g} m/s; {can}"
    if climb > ability.climb + ROUNDING:
        return f"up or down at {climb:.3g} m/s; {ability.words} can {ability.climb:g}"
    if spin > ability.spin + ROUNDING:
        return f"turns at {spin:.3g} degrees per second; {ability.words} can {ability.spin:g}"
    if acceleration > ability.acceleration + ROUNDING:
        needed = f"needs {acceleration:.3g} m/s^2; {ability.words} can {ability.acceleration:g}"
        return f"{stretch} {needed}: allow more time, or ease in and out with further keys"
    if motion.facing != "fixed" and measures.radius < ability.radius - ROUNDING:
        return f"turns within {measures.radius:.2g} m; {ability.words} needs {ability.radius:g} m"
    return None


def _at(motion: Motion, index: int, name: str = "") -> str:
    """Return the path of a key, or of the course that yields it."""
    if not motion.keys:
        return motion.course
    return f"keys[{index}].{name}" if name else f"keys[{index}]"

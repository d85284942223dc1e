"""The built-in behaviours of actors: one row each, with its code, its entry in catalogues and its abilities.

The motion itself is in `lane_kernels`, `walking_kernels` and `world_kernels`, one branch per behaviour.
"""

from collections.abc import Callable, Mapping

from oodscen.data._catalogue import BehaviourKind, BehaviourParameter
from oodscen.data._category import Category
from oodscen.driving._motion.behaviours.codes import Code
from oodscen.driving._motion.behaviours.row import BehaviourRow

_ANYBODY: tuple[Category, ...] = (
    "vehicle",
    "cyclist",
    "pedestrian",
    "animal",
    "object",
    "work_zone",
    "vegetation",
    "signal",
)
QUICKNESS: dict[Category, float] = {
    **dict.fromkeys(_ANYBODY, 2.5),
    **{"animal": 6.0, "cyclist": 1.5, "object": 4.0},
}
"""Acceleration of actors that walk, ride or blow along, by category, m/s^2."""
_DRIVERS: tuple[Category, ...] = ("vehicle", "cyclist")
_WALKERS: tuple[Category, ...] = ("pedestrian", "animal", "cyclist", "object", "vegetation")


def _number(low: float, high: float, default: float, text: str) -> BehaviourParameter:
    return BehaviourParameter(minimum=low, maximum=high, default=default, description=text)


def _speed(
    high: float, default: float, low: float = 0.0, text: str = "m/s"
) -> dict[str, BehaviourParameter]:
    return {"speed": _number(low, high, default, text)}


_LANES = _number(-3, 3, 1, "lanes to the left as the ego sees it; negative is to the right")
_DURATION = "s that the move to the side takes"

_ROWS = (
    BehaviourRow(
        Code.STAND,
        "stays where it is",
        _ANYBODY,
        doing="standing still",
        phrase="stands still",
        tags=("MotionStop",),
        plain_action="none",
        course="place",
        has_trigger=False,
    ),
    BehaviourRow(
        Code.FOLLOW_LANE,
        "drives in its lane and keeps a safe distance to whatever is ahead of it",
        _DRIVERS,
        parameters={
            **_speed(45, 10),
            "headway": _number(0.2, 5, 1.2, "s that it keeps behind whatever is ahead of it"),
            "deceleration": _number(1, 9, 9, "m/s^2 with which it brakes at most"),
        },
        doing="driving the same way",
        phrase="keeps its lane",
        tags=("MotionDrive",),
        plain_action="none",
        course="lane",
        holds_brake=True,
        moves_before_trigger=True,
        has_trigger=False,
    ),
    BehaviourRow(
        Code.WRONG_WAY,
        "drives against its lane's direction and yields to nobody",
        _DRIVERS,
        parameters=_speed(45, 10),
        doing="coming towards the ego vehicle",
        phrase="drives against its lane’s direction",
        tags=("MotionDrive", "MotionTowards"),
        course="against",
        moves_before_trigger=True,
        has_trigger=False,
    ),
    BehaviourRow(
        Code.CUT_IN,
        "drives in its lane; at the trigger moves over by some lanes",
        _DRIVERS,
        parameters={**_speed(45, 10), "lanes": _LANES, "duration": _number(0.5, 8, 1.5, _DURATION)},
        doing="moving over into another lane",
        phrase="changes lane",
        effect="joins",
        tags=("MotionDrive", "MotionCutIn"),
        plain_action="lane_change",
        holds_brake=True,
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.HARD_BRAKE,
        "drives in its lane; at the trigger brakes hard until it stands",
        _DRIVERS,
        parameters={**_speed(45, 10), "deceleration": _number(1, 9, 7, "m/s^2")},
        doing="braking hard",
        phrase="brakes hard to a stop",
        effect="brakes",
        tags=("MotionDecelerate", "MotionStop"),
        plain_action="stop",
        holds_brake=True,
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.STALL,
        "drives in its lane; at the trigger loses its drive and rolls to a stop",
        _DRIVERS,
        parameters={**_speed(45, 10), "deceleration": _number(0.3, 4, 1.5, "m/s^2")},
        doing="slowing down",
        phrase="coasts to a stop",
        effect="brakes",
        tags=("MotionDecelerate", "MotionStop"),
        plain_action="stop",
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.STOP_AND_GO,
        "drives in its lane; from the trigger on stops and starts again and again",
        _DRIVERS,
        parameters={**_speed(20, 6), "period": _number(2, 20, 6, "s from stop to stop")},
        doing="stopping and starting again",
        phrase="stops and goes",
        effect="brakes",
        tags=("MotionDecelerate", "MotionAccelerate"),
        course="lane",
        holds_brake=True,
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.HALT,
        "drives in its lane; at the trigger slows down smoothly, stands for a while and drives on",
        _DRIVERS,
        parameters={
            **_speed(45, 10),
            "deceleration": _number(0.5, 4, 2, "m/s^2"),
            "pause": _number(0, 60, 5, "s that it stands"),
        },
        doing="slowing down",
        effect="brakes",
        tags=("MotionDecelerate", "MotionStop", "MotionAccelerate"),
        holds_brake=True,
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.REVERSE,
        "stands; at the trigger drives backwards",
        ("vehicle",),
        parameters=_speed(10, 3),
        doing="driving backwards",
        phrase="drives backwards",
        effect="brakes",
        tags=("MotionReverse",),
        course="against",
        keeps_heading=True,
        drives_from_rest=True,
    ),
    BehaviourRow(
        Code.SWERVE,
        "drives in its lane; from the trigger on weaves from side to side",
        _DRIVERS,
        parameters={
            **_speed(45, 10),
            "amplitude": _number(0.1, 4, 0.8, "m to either side"),
            "period": _number(1, 10, 3, "s"),
        },
        doing="weaving from side to side",
        phrase="swerves",
        effect="joins",
        tags=("MotionDrive",),
        course="lane",
        moves_before_trigger=True,
        has_chance=True,
    ),
    BehaviourRow(
        Code.PULL_OUT,
        "stands at the roadside; at the trigger accelerates and moves into the lane",
        _DRIVERS,
        parameters={
            **_speed(30, 8),
            "lanes": _number(-3, 3, 0, "lanes to the left of the one it is placed against"),
            "duration": _number(1, 10, 2.5, _DURATION),
        },
        doing="moving from the roadside into the lane",
        phrase="pulls out from the roadside",
        effect="joins",
        tags=("MotionAccelerate", "MotionDrive"),
        drives_from_rest=True,
    ),
    BehaviourRow(
        Code.U_TURN,
        "drives in its lane; at the trigger turns left across the road and drives back",
        _DRIVERS,
        parameters={**_speed(10, 5), "duration": _number(2, 12, 4, "s that the turn takes")},
        doing="turning across the road",
        phrase="turns across the road",
        effect="joins",
        tags=("MotionUTurn",),
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.CROSS_ROAD,
        "stands; at the trigger moves along its own heading for a distance",
        _WALKERS,
        parameters={**_speed(10, 1.4), "distance": _number(0.5, 60, 12, "m")},
        doing="crossing",
        has_side=True,
        phrase="crosses the road",
        effect="crosses",
        tags=("MotionCross",),
        plain_action="walk",
        course="place",
        keeps_heading=True,
        reaches_farther=True,
    ),
    BehaviourRow(
        Code.HESITATE,
        "stands; at the trigger moves along its heading, pauses and goes back",
        _WALKERS,
        parameters={
            **_speed(10, 1.4),
            "distance": _number(0.5, 30, 4, "m"),
            "pause": _number(0, 20, 2, "s"),
        },
        doing="stepping onto the road and back",
        has_side=True,
        phrase="steps out, stops and goes back",
        effect="crosses",
        tags=("MotionCross", "MotionStop"),
        course="place",
        reaches_farther=True,
    ),
    BehaviourRow(
        Code.WALK_ALONG,
        "moves along its own heading from the trigger on",
        _WALKERS,
        parameters=_speed(10, 1.4),
        doing="crossing",
        has_side=True,
        phrase="moves along its heading",
        effect="crosses",
        tags=("MotionWalk",),
        plain_action="walk",
        course="heading",
        keeps_heading=True,
    ),
    BehaviourRow(
        Code.BOLT,
        "stands; at the trigger runs along its own heading",
        ("animal", "pedestrian"),
        parameters={**_speed(18, 8), "distance": _number(0.5, 80, 20, "m")},
        doing="running across",
        has_side=True,
        phrase="bolts along its heading",
        effect="crosses",
        tags=("MotionRun", "MotionCross"),
        plain_action="walk",
        course="heading",
        keeps_heading=True,
        reaches_farther=True,
    ),
    BehaviourRow(
        Code.WOBBLE,
        "rides in its lane; from the trigger on sways from side to side",
        _DRIVERS,
        parameters={
            **_speed(15, 4.5),
            "amplitude": _number(0.1, 2, 0.5, "m to either side"),
            "period": _number(1, 10, 2.5, "s"),
        },
        doing="swaying from side to side",
        phrase="weaves in its lane",
        tags=("MotionDrive",),
        course="lane",
        moves_before_trigger=True,
        has_chance=True,
    ),
    BehaviourRow(
        Code.DRIFT,
        "drives in its lane; from the trigger on slowly leaves it",
        _DRIVERS,
        parameters={
            **_speed(45, 10),
            "lateral": _number(-2, 2, 0.5, "m/s to the left as the ego sees it"),
        },
        doing="drifting out of its lane",
        phrase="drifts out of its lane",
        effect="joins",
        tags=("MotionDrive",),
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.CUT_OUT,
        "drives ahead in its lane and minds moving traffic only; at the trigger moves "
        "over by some lanes and reveals what it hid",
        _DRIVERS,
        parameters={**_speed(45, 10), "lanes": _LANES, "duration": _number(0.5, 8, 2, _DURATION)},
        doing="moving over into another lane",
        effect="joins",
        tags=("MotionDrive", "MotionCutOut"),
        plain_action="lane_change",
        holds_brake=True,
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.OVERTAKE,
        "drives in its lane; from the trigger on passes with a shift to the side, "
        "yields little, and moves back once the ego is behind it",
        _DRIVERS,
        parameters={
            **_speed(45, 20),
            "lateral": _number(-4, 4, 2.4, "m to the left as the ego sees it"),
        },
        doing="overtaking",
        effect="joins",
        tags=("MotionOvertake",),
        moves_before_trigger=True,
    ),
    BehaviourRow(
        Code.RUN_RED,
        "drives along its own heading from the start, whatever the trigger and the "
        "lights say, and yields to nobody",
        _DRIVERS,
        parameters=_speed(30, 12),
        doing="crossing",
        has_side=True,
        tags=("MotionDrive", "MotionCross"),
        keeps_heading=True,
        moves_before_trigger=True,
        has_trigger=False,
    ),
    BehaviourRow(
        Code.ROLL_AWAY,
        "stands; at the trigger rolls along its heading without a driver",
        ("vehicle", "object", "work_zone"),
        parameters={
            **_speed(15, 4, -15, "m/s in the end; negative is backwards"),
            "acceleration": _number(0.05, 3, 0.6, "m/s^2"),
        },
        doing="rolling",
        tags=("MotionSlide",),
        keeps_heading=True,
    ),
    BehaviourRow(
        Code.WANDER,
        "stands; from the trigger on mills about its place",
        ("pedestrian", "animal"),
        parameters={**_speed(5, 0.9), "radius": _number(0.3, 15, 2, "m around its place")},
        doing="walking about",
        effect="crosses",
        tags=("MotionWalk",),
        course="place",
        has_chance=True,
    ),
    BehaviourRow(
        Code.DART,
        "stands; at the trigger sprints along its own heading and stops after a distance",
        ("pedestrian", "animal", "cyclist", "object"),
        parameters={**_speed(12, 4), "distance": _number(0.5, 60, 9, "m")},
        doing="running across",
        has_side=True,
        effect="crosses",
        tags=("MotionRun", "MotionCross"),
        plain_action="walk",
        keeps_heading=True,
    ),
    BehaviourRow(
        Code.FALL,
        "rides on another actor; at the trigger falls off, lands, and slides to rest",
        ("object", "vegetation", "work_zone", "vehicle", "cyclist", "animal"),
        parameters={
            "height": _number(0, 4, 1.2, "m above the road while it rides"),
            "lateral": _number(-4, 4, 0, "m/s to the left of the carrier as it leaves it"),
            "spin_deg": _number(-360, 360, 60, "degrees per second at first, counter-clockwise"),
        },
        needs_other=True,
        doing="falling off a vehicle",
        tags=("MotionSlide",),
        leaves_ground=True,
    ),
    BehaviourRow(
        Code.TOWED,
        "follows another actor like a trailer, drawn at that one's tail",
        ("vehicle", "cyclist", "object", "work_zone"),
        needs_other=True,
        doing="drawn by another vehicle",
        tags=("MotionDrive",),
        course="lane",
        has_trigger=False,
    ),
    BehaviourRow(
        Code.OPEN_DOOR,
        "belongs to the side of another actor; at the trigger swings open about its front edge",
        ("object",),
        parameters={
            "angle_deg": _number(5, 90, 65, "degrees away from the other actor"),
            "duration": _number(0.2, 5, 0.7, "s that it takes"),
        },
        needs_other=True,
        doing="swinging open",
    ),
    BehaviourRow(
        Code.BLOWN,
        "stands; from the trigger on the wind drives it along its heading in gusts",
        ("object", "vegetation", "work_zone"),
        parameters={
            **_speed(20, 5),
            "period": _number(1, 10, 2.5, "s from gust to gust"),
            "lift": _number(0, 3, 0.3, "m that it rises between gusts"),
        },
        doing="blown along by the wind",
        tags=("MotionSlide",),
        has_chance=True,
        leaves_ground=True,
    ),
)

BUILT_IN: Mapping[str, BehaviourRow] = {row.kind.id: row for row in _ROWS}
"""All behaviours of the kinematic world, by id."""
BEHAVIOURS: tuple[BehaviourKind, ...] = tuple(row.kind for row in _ROWS)
"""Their entries in the catalogues of mirror simulators."""


def having(fits: Callable[[BehaviourRow], bool]) -> tuple[str, ...]:
    """Return the ids of the behaviours whose rows fit."""
    return tuple(row.kind.id for row in _ROWS if fits(row))


MOVES_BEFORE_TRIGGER = frozenset(having(lambda row: row.moves_before_trigger))
DRIVES_IN_LANE = frozenset(having(lambda row: row.moves_before_trigger and not row.keeps_heading))
"""Behaviours that drive along their lane until their trigger, if they have one."""
STAYS = frozenset(having(lambda row: row.course == "place"))
"""Behaviours that keep an actor at its place along the road."""
WITHOUT_TRIGGER = frozenset(having(lambda row: not row.has_trigger))
USUAL = frozenset(having(lambda row: row.plain_action == "none"))
"""Behaviours that are nothing unusual."""
ATTACHED = frozenset(row.code for row in _ROWS if row.needs_other)
"""Codes of the behaviours of actors that belong to another actor."""

"""The vocabulary of actor behaviours, for catalogues.

The motion itself is in `oodscen.driving._motion.behaviour_kernels`, one branch per behaviour.
"""

from oodscen.data._catalogue import BehaviourKind, BehaviourParameter
from oodscen.data._category import Category
from oodscen.driving._motion.behaviour_kernels import Code

BEHAVE: dict[str, Code] = {code.name.lower(): code for code in Code if code != Code.KEYED}
"""Codes of the behaviours in the kinematic world, by id; key poses come with a scene."""

MOVES_BEFORE_TRIGGER = frozenset(
    {
        "follow_lane",
        "wrong_way",
        "cut_in",
        "cut_out",
        "hard_brake",
        "stall",
        "stop_and_go",
        "halt",
        "swerve",
        "u_turn",
        "wobble",
        "drift",
        "overtake",
        "run_red",
    }
)
"""Behaviours that drive at their `speed` from the start."""

QUICKNESS: dict[str, float] = {"pedestrian": 2.5, "animal": 6.0, "cyclist": 1.5, "object": 4.0}
"""Acceleration of actors that walk, ride or blow along, by category, m/s^2; 2.5 for the others."""

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

BEHAVIOURS: tuple[BehaviourKind, ...] = (
    BehaviourKind(id="stand", description="stays where it is", categories=_ANYBODY),
    BehaviourKind(
        id="follow_lane",
        description="drives in its lane and keeps a safe distance to whatever is ahead of it",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "headway": _number(0.2, 5, 1.2, "s that it keeps behind whatever is ahead of it"),
            "deceleration": _number(1, 9, 9, "m/s^2 with which it brakes at most"),
        },
    ),
    BehaviourKind(
        id="wrong_way",
        description="drives against its lane's direction and yields to nobody",
        categories=_DRIVERS,
        parameters=_speed(45, 10),
    ),
    BehaviourKind(
        id="cut_in",
        description="drives in its lane; at the trigger moves over by some lanes",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "lanes": _LANES,
            "duration": _number(0.5, 8, 1.5, _DURATION),
        },
    ),
    BehaviourKind(
        id="hard_brake",
        description="drives in its lane; at the trigger brakes hard until it stands",
        categories=_DRIVERS,
        parameters={**_speed(45, 10), "deceleration": _number(1, 9, 7, "m/s^2")},
    ),
    BehaviourKind(
        id="stall",
        description="drives in its lane; at the trigger loses its drive and rolls to a stop",
        categories=_DRIVERS,
        parameters={**_speed(45, 10), "deceleration": _number(0.3, 4, 1.5, "m/s^2")},
    ),
    BehaviourKind(
        id="stop_and_go",
        description="drives in its lane; from the trigger on stops and starts again and again",
        categories=_DRIVERS,
        parameters={**_speed(20, 6), "period": _number(2, 20, 6, "s from stop to stop")},
    ),
    BehaviourKind(
        id="halt",
        description="drives in its lane; at the trigger slows down smoothly, stands for a while and "
        "drives on",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "deceleration": _number(0.5, 4, 2, "m/s^2"),
            "pause": _number(0, 60, 5, "s that it stands"),
        },
    ),
    BehaviourKind(
        id="reverse",
        description="stands; at the trigger drives backwards",
        categories=("vehicle",),
        parameters=_speed(10, 3),
    ),
    BehaviourKind(
        id="swerve",
        description="drives in its lane; from the trigger on weaves from side to side",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "amplitude": _number(0.1, 4, 0.8, "m to either side"),
            "period": _number(1, 10, 3, "s"),
        },
    ),
    BehaviourKind(
        id="pull_out",
        description="stands at the roadside; at the trigger accelerates and moves into the lane",
        categories=_DRIVERS,
        parameters={
            **_speed(30, 8),
            "lanes": _number(-3, 3, 0, "lanes to the left of the one it is placed against"),
            "duration": _number(1, 10, 2.5, _DURATION),
        },
    ),
    BehaviourKind(
        id="u_turn",
        description="drives in its lane; at the trigger turns left across the road and drives back",
        categories=_DRIVERS,
        parameters={**_speed(10, 5), "duration": _number(2, 12, 4, "s that the turn takes")},
    ),
    BehaviourKind(
        id="cross_road",
        description="stands; at the trigger moves along its own heading for a distance",
        categories=_WALKERS,
        parameters={**_speed(10, 1.4), "distance": _number(0.5, 60, 12, "m")},
    ),
    BehaviourKind(
        id="hesitate",
        description="stands; at the trigger moves along its heading, pauses and goes back",
        categories=_WALKERS,
        parameters={
            **_speed(10, 1.4),
            "distance": _number(0.5, 30, 4, "m"),
            "pause": _number(0, 20, 2, "s"),
        },
    ),
    BehaviourKind(
        id="walk_along",
        description="moves along its own heading from the trigger on",
        categories=_WALKERS,
        parameters=_speed(10, 1.4),
    ),
    BehaviourKind(
        id="bolt",
        description="stands; at the trigger runs along its own heading",
        categories=("animal", "pedestrian"),
        parameters={**_speed(18, 8), "distance": _number(0.5, 80, 20, "m")},
    ),
    BehaviourKind(
        id="wobble",
        description="rides in its lane; from the trigger on sways from side to side",
        categories=_DRIVERS,
        parameters={
            **_speed(15, 4.5),
            "amplitude": _number(0.1, 2, 0.5, "m to either side"),
            "period": _number(1, 10, 2.5, "s"),
        },
    ),
    BehaviourKind(
        id="drift",
        description="drives in its lane; from the trigger on slowly leaves it",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "lateral": _number(-2, 2, 0.5, "m/s to the left as the ego sees it"),
        },
    ),
    BehaviourKind(
        id="cut_out",
        description="drives ahead in its lane and minds moving traffic only; at the trigger moves "
        "over by some lanes and reveals what it hid",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 10),
            "lanes": _LANES,
            "duration": _number(0.5, 8, 2, _DURATION),
        },
    ),
    BehaviourKind(
        id="overtake",
        description="drives in its lane; from the trigger on passes with a shift to the side, "
        "yields little, and moves back once the ego is behind it",
        categories=_DRIVERS,
        parameters={
            **_speed(45, 20),
            "lateral": _number(-4, 4, 2.4, "m to the left as the ego sees it"),
        },
    ),
    BehaviourKind(
        id="run_red",
        description="drives along its own heading from the start, whatever the trigger and the "
        "lights say, and yields to nobody",
        categories=_DRIVERS,
        parameters=_speed(30, 12),
    ),
    BehaviourKind(
        id="roll_away",
        description="stands; at the trigger rolls along its heading without a driver",
        categories=("vehicle", "object", "work_zone"),
        parameters={
            **_speed(15, 4, -15, "m/s in the end; negative is backwards"),
            "acceleration": _number(0.05, 3, 0.6, "m/s^2"),
        },
    ),
    BehaviourKind(
        id="wander",
        description="stands; from the trigger on mills about its place",
        categories=("pedestrian", "animal"),
        parameters={**_speed(5, 0.9), "radius": _number(0.3, 15, 2, "m around its place")},
    ),
    BehaviourKind(
        id="dart",
        description="stands; at the trigger sprints along its own heading and stops after a "
        "distance",
        categories=("pedestrian", "animal", "cyclist", "object"),
        parameters={**_speed(12, 4), "distance": _number(0.5, 60, 9, "m")},
    ),
    BehaviourKind(
        id="fall",
        description="rides on another actor; at the trigger falls off, lands, and slides to rest",
        categories=("object", "vegetation", "work_zone", "vehicle", "cyclist", "animal"),
        parameters={
            "height": _number(0, 4, 1.2, "m above the road while it rides"),
            "lateral": _number(-4, 4, 0, "m/s to the left of the carrier as it leaves it"),
            "spin_deg": _number(-360, 360, 60, "degrees per second at first, counter-clockwise"),
        },
        needs_other=True,
    ),
    BehaviourKind(
        id="towed",
        description="follows another actor like a trailer, drawn at that one's tail",
        categories=("vehicle", "cyclist", "object", "work_zone"),
        needs_other=True,
    ),
    BehaviourKind(
        id="open_door",
        description="belongs to the side of another actor; at the trigger swings open about its "
        "front edge",
        categories=("object",),
        parameters={
            "angle_deg": _number(5, 90, 65, "degrees away from the other actor"),
            "duration": _number(0.2, 5, 0.7, "s that it takes"),
        },
        needs_other=True,
    ),
    BehaviourKind(
        id="blown",
        description="stands; from the trigger on the wind drives it along its heading in gusts",
        categories=("object", "vegetation", "work_zone"),
        parameters={
            **_speed(20, 5),
            "period": _number(1, 10, 2.5, "s from gust to gust"),
            "lift": _number(0, 3, 0.3, "m that it rises between gusts"),
        },
    ),
)
"""All behaviours of the kinematic world, for the catalogues of mirror simulators."""

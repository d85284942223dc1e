"""The built-in behaviours of actors: one row each, with its code, its entry in catalogues and its abilities.

The motion itself is in `oodscen.driving._motion.behaviour_kernels`, one branch per behaviour.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from oodscen.data._catalogue import BehaviourKind, BehaviourParameter
from oodscen.data._category import Category
from oodscen.driving._motion.behaviour_kernels import Code

Effect = Literal["", "brakes", "joins", "crosses"]
"""Effects on those behind: an actor slows down, comes into their lane, or crosses the road."""


@dataclass(frozen=True)
class BuiltInBehaviour:
    """One behaviour of the kinematic world."""

    code: Code
    """The branch of the kernel that moves it."""
    kind: BehaviourKind
    """Its entry in catalogues."""
    doing: str
    """The motion as a few frames show it: `braking hard`."""
    has_side: bool = False
    """True if the motion comes from a side of the road, which the words must name."""
    phrase: str = ""
    """The whole motion for readers of a report; its id if empty."""
    effect: Effect = ""
    moves_before_trigger: bool = False
    """True if it drives at its `speed` from the start."""
    drives_from_rest: bool = False
    """True if it stands until its trigger and then drives on the road."""
    has_trigger: bool = True
    """False if no trigger changes its course."""
    has_chance: bool = False
    """True if its phase is drawn from the seed."""
    leaves_ground: bool = False


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

_ROWS = (
    BuiltInBehaviour(
        Code.STAND,
        BehaviourKind(id="stand", description="stays where it is", categories=_ANYBODY),
        doing="standing still",
        phrase="stands still",
        has_trigger=False,
    ),
    BuiltInBehaviour(
        Code.FOLLOW_LANE,
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
        doing="driving the same way",
        phrase="keeps its lane",
        moves_before_trigger=True,
        has_trigger=False,
    ),
    BuiltInBehaviour(
        Code.WRONG_WAY,
        BehaviourKind(
            id="wrong_way",
            description="drives against its lane's direction and yields to nobody",
            categories=_DRIVERS,
            parameters=_speed(45, 10),
        ),
        doing="coming towards the ego vehicle",
        phrase="drives against its lane’s direction",
        moves_before_trigger=True,
        has_trigger=False,
    ),
    BuiltInBehaviour(
        Code.CUT_IN,
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
        doing="moving over into another lane",
        phrase="changes lane",
        effect="joins",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.HARD_BRAKE,
        BehaviourKind(
            id="hard_brake",
            description="drives in its lane; at the trigger brakes hard until it stands",
            categories=_DRIVERS,
            parameters={**_speed(45, 10), "deceleration": _number(1, 9, 7, "m/s^2")},
        ),
        doing="braking hard",
        phrase="brakes hard to a stop",
        effect="brakes",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.STALL,
        BehaviourKind(
            id="stall",
            description="drives in its lane; at the trigger loses its drive and rolls to a stop",
            categories=_DRIVERS,
            parameters={**_speed(45, 10), "deceleration": _number(0.3, 4, 1.5, "m/s^2")},
        ),
        doing="slowing down",
        phrase="coasts to a stop",
        effect="brakes",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.STOP_AND_GO,
        BehaviourKind(
            id="stop_and_go",
            description="drives in its lane; from the trigger on stops and starts again and again",
            categories=_DRIVERS,
            parameters={**_speed(20, 6), "period": _number(2, 20, 6, "s from stop to stop")},
        ),
        doing="stopping and starting again",
        phrase="stops and goes",
        effect="brakes",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.HALT,
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
        doing="slowing down",
        effect="brakes",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.REVERSE,
        BehaviourKind(
            id="reverse",
            description="stands; at the trigger drives backwards",
            categories=("vehicle",),
            parameters=_speed(10, 3),
        ),
        doing="driving backwards",
        phrase="drives backwards",
        effect="brakes",
        drives_from_rest=True,
    ),
    BuiltInBehaviour(
        Code.SWERVE,
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
        doing="weaving from side to side",
        phrase="swerves",
        effect="joins",
        moves_before_trigger=True,
        has_chance=True,
    ),
    BuiltInBehaviour(
        Code.PULL_OUT,
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
        doing="moving from the roadside into the lane",
        phrase="pulls out from the roadside",
        effect="joins",
        drives_from_rest=True,
    ),
    BuiltInBehaviour(
        Code.U_TURN,
        BehaviourKind(
            id="u_turn",
            description="drives in its lane; at the trigger turns left across the road and drives back",
            categories=_DRIVERS,
            parameters={**_speed(10, 5), "duration": _number(2, 12, 4, "s that the turn takes")},
        ),
        doing="turning across the road",
        phrase="turns across the road",
        effect="joins",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.CROSS_ROAD,
        BehaviourKind(
            id="cross_road",
            description="stands; at the trigger moves along its own heading for a distance",
            categories=_WALKERS,
            parameters={**_speed(10, 1.4), "distance": _number(0.5, 60, 12, "m")},
        ),
        doing="crossing",
        has_side=True,
        phrase="crosses the road",
        effect="crosses",
    ),
    BuiltInBehaviour(
        Code.HESITATE,
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
        doing="stepping onto the road and back",
        has_side=True,
        phrase="steps out, stops and goes back",
        effect="crosses",
    ),
    BuiltInBehaviour(
        Code.WALK_ALONG,
        BehaviourKind(
            id="walk_along",
            description="moves along its own heading from the trigger on",
            categories=_WALKERS,
            parameters=_speed(10, 1.4),
        ),
        doing="crossing",
        has_side=True,
        phrase="moves along its heading",
        effect="crosses",
    ),
    BuiltInBehaviour(
        Code.BOLT,
        BehaviourKind(
            id="bolt",
            description="stands; at the trigger runs along its own heading",
            categories=("animal", "pedestrian"),
            parameters={**_speed(18, 8), "distance": _number(0.5, 80, 20, "m")},
        ),
        doing="running across",
        has_side=True,
        phrase="bolts along its heading",
        effect="crosses",
    ),
    BuiltInBehaviour(
        Code.WOBBLE,
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
        doing="swaying from side to side",
        phrase="weaves in its lane",
        moves_before_trigger=True,
        has_chance=True,
    ),
    BuiltInBehaviour(
        Code.DRIFT,
        BehaviourKind(
            id="drift",
            description="drives in its lane; from the trigger on slowly leaves it",
            categories=_DRIVERS,
            parameters={
                **_speed(45, 10),
                "lateral": _number(-2, 2, 0.5, "m/s to the left as the ego sees it"),
            },
        ),
        doing="drifting out of its lane",
        phrase="drifts out of its lane",
        effect="joins",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.CUT_OUT,
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
        doing="moving over into another lane",
        effect="joins",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.OVERTAKE,
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
        doing="overtaking",
        effect="joins",
        moves_before_trigger=True,
    ),
    BuiltInBehaviour(
        Code.RUN_RED,
        BehaviourKind(
            id="run_red",
            description="drives along its own heading from the start, whatever the trigger and the "
            "lights say, and yields to nobody",
            categories=_DRIVERS,
            parameters=_speed(30, 12),
        ),
        doing="crossing",
        has_side=True,
        moves_before_trigger=True,
        has_trigger=False,
    ),
    BuiltInBehaviour(
        Code.ROLL_AWAY,
        BehaviourKind(
            id="roll_away",
            description="stands; at the trigger rolls along its heading without a driver",
            categories=("vehicle", "object", "work_zone"),
            parameters={
                **_speed(15, 4, -15, "m/s in the end; negative is backwards"),
                "acceleration": _number(0.05, 3, 0.6, "m/s^2"),
            },
        ),
        doing="rolling",
    ),
    BuiltInBehaviour(
        Code.WANDER,
        BehaviourKind(
            id="wander",
            description="stands; from the trigger on mills about its place",
            categories=("pedestrian", "animal"),
            parameters={**_speed(5, 0.9), "radius": _number(0.3, 15, 2, "m around its place")},
        ),
        doing="walking about",
        effect="crosses",
        has_chance=True,
    ),
    BuiltInBehaviour(
        Code.DART,
        BehaviourKind(
            id="dart",
            description="stands; at the trigger sprints along its own heading and stops after a "
            "distance",
            categories=("pedestrian", "animal", "cyclist", "object"),
            parameters={**_speed(12, 4), "distance": _number(0.5, 60, 9, "m")},
        ),
        doing="running across",
        has_side=True,
        effect="crosses",
    ),
    BuiltInBehaviour(
        Code.FALL,
        BehaviourKind(
            id="fall",
            description="rides on another actor; at the trigger falls off, lands, and slides to rest",
            categories=("object", "vegetation", "work_zone", "vehicle", "cyclist", "animal"),
            parameters={
                "height": _number(0, 4, 1.2, "m above the road while it rides"),
                "lateral": _number(-4, 4, 0, "m/s to the left of the carrier as it leaves it"),
                "spin_deg": _number(
                    -360, 360, 60, "degrees per second at first, counter-clockwise"
                ),
            },
            needs_other=True,
        ),
        doing="falling off a vehicle",
        leaves_ground=True,
    ),
    BuiltInBehaviour(
        Code.TOWED,
        BehaviourKind(
            id="towed",
            description="follows another actor like a trailer, drawn at that one's tail",
            categories=("vehicle", "cyclist", "object", "work_zone"),
            needs_other=True,
        ),
        doing="drawn by another vehicle",
        has_trigger=False,
    ),
    BuiltInBehaviour(
        Code.OPEN_DOOR,
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
        doing="swinging open",
    ),
    BuiltInBehaviour(
        Code.BLOWN,
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
        doing="blown along by the wind",
        has_chance=True,
        leaves_ground=True,
    ),
)

BUILT_IN: Mapping[str, BuiltInBehaviour] = {row.kind.id: row for row in _ROWS}
"""All behaviours of the kinematic world, by id."""
BEHAVIOURS: tuple[BehaviourKind, ...] = tuple(row.kind for row in _ROWS)
"""Their entries in the catalogues of mirror simulators."""
MOVES_BEFORE_TRIGGER = frozenset(row.kind.id for row in _ROWS if row.moves_before_trigger)
WITHOUT_TRIGGER = frozenset(row.kind.id for row in _ROWS if not row.has_trigger)
WITH_CHANCE = frozenset(row.kind.id for row in _ROWS if row.has_chance)
AIRBORNE = frozenset(row.kind.id for row in _ROWS if row.leaves_ground)
ATTACHED = frozenset(row.code for row in _ROWS if row.kind.needs_other)
"""Codes of the behaviours of actors that belong to another one."""


def having_effect(effect: Effect) -> tuple[str, ...]:
    """Return the ids of the behaviours with an effect."""
    return tuple(row.kind.id for row in _ROWS if row.effect == effect)

"""The behaviours by number, as kernels know them."""

from enum import IntEnum


class Code(IntEnum):
    """The behaviours by number; a code without a branch in the kernels raises `ValueError` as its actor moves."""

    STAND = 0
    FOLLOW_LANE = 1
    WRONG_WAY = 2
    CUT_IN = 3
    HARD_BRAKE = 4
    STALL = 5
    STOP_AND_GO = 6
    REVERSE = 7
    SWERVE = 8
    PULL_OUT = 9
    U_TURN = 10
    CROSS_ROAD = 11
    HESITATE = 12
    WALK_ALONG = 13
    BOLT = 14
    WOBBLE = 15
    DRIFT = 16
    CUT_OUT = 17
    OVERTAKE = 18
    WANDER = 19
    DART = 20
    BLOWN = 21
    HALT = 22
    RUN_RED = 23
    ROLL_AWAY = 24
    FALL = 25
    TOWED = 26
    OPEN_DOOR = 27
    KEYED = 28


WALKING = (
    int(Code.CROSS_ROAD),
    int(Code.HESITATE),
    int(Code.WALK_ALONG),
    int(Code.BOLT),
    int(Code.DART),
    int(Code.WANDER),
    int(Code.BLOWN),
    int(Code.REVERSE),
)
"""Codes of actors that move along their own heading."""
IN_WORLD = (
    int(Code.RUN_RED),
    int(Code.ROLL_AWAY),
    int(Code.FALL),
    int(Code.TOWED),
    int(Code.OPEN_DOOR),
    int(Code.KEYED),
)
"""Codes of actors that move in world coordinates; all others move along the road."""

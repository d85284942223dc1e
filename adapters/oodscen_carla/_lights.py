"""The lamps of vehicles, as CARLA's clients and servers number them."""

from enum import IntFlag


class VehicleLight(IntFlag):
    """The part of `carla.VehicleLightState` that scenes use."""

    POSITION = 1
    LOW_BEAM = 2
    HIGH_BEAM = 4
    BRAKE = 8
    RIGHT_BLINKER = 16
    LEFT_BLINKER = 32
    SPECIAL_1 = 128


LAMPS_OF_STATE = {
    "hazard": VehicleLight.LEFT_BLINKER | VehicleLight.RIGHT_BLINKER,
    "indicate_left": VehicleLight.LEFT_BLINKER,
    "indicate_right": VehicleLight.RIGHT_BLINKER,
    "beacon": VehicleLight.SPECIAL_1,
}
"""The lamps that flash in a state of an asset; brake lamps follow from the motion."""

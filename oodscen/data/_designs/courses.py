"""Key poses, and courses that yield them: walk, roll, drift, swing, circle."""

import math

from pydantic import Field

from oodscen.data._base import Data

_SINES = (0.0, 0.3826834323650898, 0.7071067811865476, 0.9238795325112867, 1.0)
"""Sines of the multiples of an eighth of pi, as literals: they are the same on every machine."""
_BRAKING = 3.0
"""Deceleration with which a rolling thing comes to rest, m/s^2."""
_GATHERING, _STOPPING = 6, 4
"""Stretches in which a rolling thing gathers speed and comes to rest."""
_LEAST_EVEN_S = 0.3
"""Time at even speed from which it is a stretch of its own, s."""
_LEAST_SPEED = math.ulp(0.0)
"""Least speed of a rolling thing, with which it takes for ever, m/s."""
_LAP = 16
"""Stretches of one round on a circle."""


class KeyPose(Data):
    """One pose of a motion, in its frame."""

    at: float = Field(default=0.0, ge=0, le=300)
    """Seconds since the trigger, or metres that the ego has driven since then."""
    ahead: float = Field(default=0.0, ge=-200, le=200)
    """m from the start"""
    left: float = Field(default=0.0, ge=-100, le=100)
    """m from the start"""
    up: float = Field(default=0.0, ge=-12, le=30)
    """Height of the underside above the road, m; negative is below it."""
    yaw: float = Field(default=0.0, ge=-14_400, le=14_400)
    """Degrees, counter-clockwise."""
    pitch: float = Field(default=0.0, ge=-14_400, le=14_400)
    """Degrees; positive tips its top ahead."""
    roll: float = Field(default=0.0, ge=-14_400, le=14_400)
    """Degrees; positive tips its top to the right."""

    def values(self) -> tuple[float, ...]:
        """Return `at`, the three distances and the three angles, rad."""
        angles = (degrees * math.pi / 180.0 for degrees in (self.yaw, self.pitch, self.roll))
        return (self.at, self.ahead, self.left, self.up, *angles)


Poses = tuple[KeyPose, ...]


class Walk(Data):
    """A walk straight on, with pauses, and back if wanted: one of a crowd."""

    distance: float = Field(gt=0, le=100)
    """m"""
    speed: float = Field(default=1.3, gt=0, le=20)
    """Mean speed between pauses, m/s."""
    pauses: int = Field(default=0, ge=0, le=6)
    pause_s: float = Field(default=2.0, ge=0.2, le=20)
    back: bool = False
    """True if it then turns round and comes back."""

    def poses(self) -> Poses:
        """Return the key poses."""
        legs = self.pauses + 1
        step_m, time, key_poses = self.distance / legs, 0.0, [KeyPose()]
        for leg in range(1, legs + 1):
            time += step_m / self.speed
            key_poses.append(KeyPose(at=time, ahead=step_m * leg))
            if leg < legs or self.back:
                time += self.pause_s
                key_poses.append(KeyPose(at=time, ahead=step_m * leg))
        if self.back:
            key_poses.append(KeyPose(at=time + self.distance / self.speed))
        return tuple(key_poses)


class Roll(Data):
    """A roll down a slope: faster and faster up to a speed, on to a distance, and to rest there."""

    distance: float = Field(gt=0, le=120)
    """m"""
    speed: float = Field(default=4.0, gt=0, le=20)
    """Greatest speed, m/s."""
    acceleration: float = Field(default=0.8, gt=0, le=5)
    """m/s^2"""
    radius: float = Field(default=0.0, ge=0, le=2)
    """Radius with which it turns over as it rolls, m; 0 if it stays upright, on wheels."""
    stops: bool = True
    """False if it is still rolling at that distance; `then` is `go_on`."""

    def poses(self) -> Poses:
        """Return the key poses."""
        gain, braking = self.acceleration, _BRAKING if self.stops else math.inf
        # The greatest speed that leaves room to gather it and to come to rest; it may round to 0.
        fastest = math.sqrt(self.distance / (0.5 / gain + 0.5 / braking)) or _LEAST_SPEED
        speed = min(self.speed, fastest)
        gathering_m, braking_m = 0.5 * speed * speed / gain, 0.5 * speed * speed / braking
        rows = [
            (speed / gain * k / _GATHERING, gathering_m * (k / _GATHERING) ** 2)
            for k in range(_GATHERING + 1)
        ]
        time, distance_m = rows[-1]
        even_m = self.distance - gathering_m - braking_m
        if even_m > _LEAST_EVEN_S * speed:
            time, distance_m = time + even_m / speed, distance_m + even_m
            rows.append((time, distance_m))
        if self.stops:
            rows += [
                (
                    time + speed / braking * k / _STOPPING,
                    distance_m + braking_m * (1.0 - (1.0 - k / _STOPPING) ** 2),
                )
                for k in range(1, _STOPPING + 1)
            ]
        return tuple(
            KeyPose(at=time, ahead=ahead, pitch=self._pitch(ahead)) for time, ahead in rows
        )

    def _pitch(self, distance_m: float) -> float:
        """Return the angle by which it has turned over, degrees."""
        return math.degrees(distance_m / self.radius) if self.radius else 0.0


class Drift(Data):
    """A drift with the wind: on in gusts, swaying, rising and sinking."""

    speed: float = Field(default=3.0, gt=0, le=20)
    """Mean speed of gusts and lulls, m/s; it sets off and ends at half of it."""
    seconds: float = Field(default=12.0, ge=1, le=60)
    gust_s: float = Field(default=2.5, ge=0.5, le=10)
    """Time from gust to gust, s."""
    sway: float = Field(default=0.5, ge=0, le=5)
    """m to either side"""
    height: float = Field(default=1.0, ge=0, le=20)
    """Mean height of its underside above the road, m."""
    rise: float = Field(default=0.5, ge=0, le=8)
    """m up and down around that height; it stays above the road."""
    turn_deg: float = Field(default=20.0, ge=0, le=90)
    """Degrees to either side."""

    def poses(self) -> Poses:
        """Return the key poses."""
        count = max(2, min(22, round(2.0 * self.seconds / self.gust_s)))
        key_poses = [KeyPose(up=self.height)]
        ahead = 0.0
        for k in range(1, count + 1):
            side = 1.0 if k % 2 else -1.0
            gust = 0.5 if k in (1, count) else 1.0 + 0.35 * side
            ahead += self.speed * self.seconds / count * gust
            key_poses.append(
                KeyPose(
                    at=self.seconds * k / count,
                    ahead=ahead,
                    left=side * self.sway,
                    up=max(0.0, self.height + side * self.rise),
                    yaw=side * self.turn_deg,
                )
            )
        return tuple(key_poses)


class Swing(Data):
    """A swing to and fro about a point; choose its height by `pivot_m`."""

    angle_deg: float = Field(default=20.0, gt=0, le=90)
    """Degrees to either side."""
    period_s: float = Field(default=2.0, ge=0.5, le=20)
    sideways: bool = True
    """True if its top or bottom moves sideways, false if to and from the driver."""
    swings: int = Field(default=5, ge=1, le=10)
    """Swings until it hangs still; it begins again where the motion repeats."""
    fades: bool = True
    """True if every swing is smaller than the last."""
    up: float = Field(default=0.0, ge=0, le=20)
    """Height of its underside above the road, m."""

    def poses(self) -> Poses:
        """Return the key poses."""
        quarter_s = 0.25 * self.period_s
        halves = 2 * self.swings
        key_poses = [KeyPose(up=self.up)]
        for k in range(halves):
            angle = self.angle_deg if k % 2 == 0 else -self.angle_deg
            if self.fades:
                angle *= 1.0 - k / halves
            tilt = {"roll": angle} if self.sideways else {"pitch": angle}
            key_poses.append(KeyPose(at=quarter_s * (2 * k + 1), up=self.up, **tilt))
        key_poses.append(KeyPose(at=quarter_s * 2 * halves, up=self.up))
        return tuple(key_poses)


class Circle(Data):
    """Rounds on a circle to the left of the start, or to its right."""

    radius: float = Field(default=2.0, ge=0.3, le=30)
    """m"""
    speed: float = Field(default=2.0, gt=0, le=20)
    """m/s"""
    clockwise: bool = False
    up: float = Field(default=0.0, ge=0, le=20)
    """Height of its underside above the road, m."""

    def poses(self) -> Poses:
        """Return the key poses of one round."""
        side = -1.0 if self.clockwise else 1.0
        lap_s = 2.0 * math.pi * self.radius / self.speed
        return tuple(
            KeyPose(
                at=lap_s * k / _LAP,
                ahead=self.radius * _sine(k),
                left=side * self.radius * (1.0 - _sine(k + 4)),
                up=self.up,
            )
            for k in range(_LAP + 1)
        )


def _sine(eighths: int) -> float:
    """Return the sine of a multiple of an eighth of pi."""
    in_turn = eighths % 16
    size = _SINES[4 - abs(in_turn % 8 - 4)]
    return -size if in_turn > 8 else size

"""Poses and gestures of people as joint angles, and the positions of the joints that follow from them."""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from oodscen.data._details import Details, posed
from oodscen.numerics._exact import PI, cos, sin
from oodscen_pybullet._meshes.look import BEATS
from oodscen_pybullet._meshes.shapes import rotated, rotation
from oodscen_pybullet._types import Array, Point

UPPER_ARM, FOREARM = 0.28, 0.27
THIGH, SHIN = 0.425, 0.41
SHOULDER_Y, HIP_Y = 0.225, 0.095
"""Distance of the joints from the middle of the body, m."""
_Raise = Annotated[float, Field(ge=-60, le=185)]
_Aside = Annotated[float, Field(ge=-40, le=110)]
_Elbow = Annotated[float, Field(ge=0, le=150)]
_Twist = Annotated[float, Field(ge=-95, le=95)]
_Thigh = Annotated[float, Field(ge=-30, le=140)]
_Out = Annotated[float, Field(ge=-10, le=60)]
_Knee = Annotated[float, Field(ge=0, le=155)]
_Ankle = Annotated[float, Field(ge=-40, le=85)]
Arm = tuple[_Raise, _Aside, _Elbow, _Twist]
Leg = tuple[_Thigh, _Out, _Knee] | tuple[_Thigh, _Out, _Knee, _Ankle]


class KeyFrame(BaseModel):
    """The joint angles of one moment, in degrees; a limb without angles hangs, stands or walks."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    right_arm: Arm | None = None
    left_arm: Arm | None = None
    right_leg: Leg | None = None
    left_leg: Leg | None = None
    lean: Annotated[float, Field(ge=-95, le=95)] = 0.0
    """Forward turn of the trunk about the hips."""
    roll: Annotated[float, Field(ge=-95, le=95)] = 0.0
    head: tuple[Annotated[float, Field(ge=-60, le=50)], Annotated[float, Field(ge=-80, le=80)]] = (
        0.0,
        0.0,
    )
    """Nod, and turn to the left."""

    def blended(self, other: Self, share: float) -> Self:
        """Return the angles at a share of the way to another key frame."""
        if share == 0.0:
            return self
        mixed = {}
        for name in type(self).model_fields:
            one, two = getattr(self, name), getattr(other, name)
            if isinstance(one, tuple):
                two = two if isinstance(two, tuple) else one
                mixed[name] = tuple(a + share * (b - a) for a, b in zip(one, two, strict=True))
            elif isinstance(one, float):
                mixed[name] = one + share * (two - one)
            else:
                mixed[name] = one
        return self.model_copy(update=mixed)


class Pose(KeyFrame):
    """A pose of a whole body; its own angles are those of the first key frame."""

    second: KeyFrame | None = None
    """The angles that change in the other key frame."""
    period_s: float | None = Field(default=None, ge=0.4, le=10)
    """Time from the first key frame to the next one like it, s."""
    stride_m: float | None = Field(default=None, ge=0.3, le=3)
    """Distance from the first key frame to the next one like it, m."""
    hands: Literal["fist", "flat", "finger"] = "fist"
    walks: bool = False
    """True if the legs of the pose are those of a person who stands; in motion they walk."""
    backwards: bool = False
    rope: bool = False
    """True if a taut rope runs forward from the hands."""
    phone: bool = False
    """True if the right hand holds a lit phone."""

    @model_validator(mode="after")
    def _timed(self) -> Self:
        clocks = [one for one in (self.period_s, self.stride_m) if one is not None]
        if len(clocks) != (self.second is not None):
            raise ValueError("a second key frame needs one of period_s and stride_m")
        return self

    def at(self, beat: int) -> KeyFrame:
        """Return the angles in a beat of the cycle."""
        if self.second is None:
            return self
        changed = {name: getattr(self.second, name) for name in self.second.model_fields_set}
        other = self.model_copy(update=changed)
        step = min(beat % BEATS, -beat % BEATS)
        return self.blended(other, 0.5 - 0.5 * cos(2.0 * PI * step / BEATS))

    @property
    def is_walking(self) -> bool:
        """True if the legs walk in motion."""
        return self.walks or not self.bends_legs

    @property
    def bends_legs(self) -> bool:
        """True if the pose moves the legs."""
        return self.right_leg is not None


@cache
def load_poses() -> dict[str, Pose]:
    """Return all poses by name."""
    text = files(__package__).joinpath("poses.toml").read_text("utf-8")
    return TypeAdapter(dict[str, Pose]).validate_python(tomllib.loads(text))


def pose_of(details: Details | None) -> Pose | None:
    """Return the pose of an actor, `None` if it has none."""
    return load_poses().get(posed(details)) if details else None


# ---------------------------------------------------------------------- joints


class Chain(NamedTuple):
    """A limb: its three joints, and the direction of the hand or of the foot."""

    start: Point
    middle: Point
    end: Point
    way: Point


def arm(angles: Arm, side: float, shoulder: Point) -> Chain:
    """Return the joints of an arm; `side` is 1 for the left one."""
    lift, aside, elbow, twist = (PI * value / 180.0 for value in angles)
    # The hanging arm, with the forearm's bend forward, is swung up in the plane at the azimuth `aside`.
    azimuth = side * aside
    swing = _times(rotation(yaw=azimuth), _times(rotation(pitch=-lift), rotation(yaw=-azimuth)))
    down, forward = (0.0, 0.0, -1.0), (cos(twist), -side * sin(twist), 0.0)
    bent = _mixed(down, forward, cos(elbow), sin(elbow))
    upper, lower = _way(swing, down), _way(swing, bent)
    middle = _along(shoulder, upper, UPPER_ARM)
    return Chain(shoulder, middle, _along(middle, lower, FOREARM), lower)


def leg(angles: Leg, side: float, hip: Point, lean: float) -> Chain:
    """Return the joints of a leg; a foot without an angle is level although the body leans, in degrees."""
    thigh, out, knee = (PI * value / 180.0 for value in angles[:3])
    sideways = rotation(roll=side * out)
    shin = thigh - knee
    ankle = PI * angles[3] / 180.0 if len(angles) == 4 else shin - PI * lean / 180.0
    foot = shin + PI / 2 - ankle

    def down(turn: float) -> Point:
        return _way(sideways, (sin(turn), 0.0, -cos(turn)))

    middle = _along(hip, down(thigh), THIGH)
    return Chain(hip, middle, _along(middle, down(shin), SHIN), down(foot))


def trunk(frame: KeyFrame) -> Array:
    """Return the rotation of the trunk about the hips."""
    return _times(rotation(pitch=PI * frame.lean / 180.0), rotation(roll=-PI * frame.roll / 180.0))


def _times(one: Array, two: Array) -> Array:
    return rotated(two.T, one).T


def _way(rows: Array, way: Point) -> Point:
    x, y, z = rotated(np.array([way]), rows)[0].tolist()
    return x, y, z


def _mixed(one: Point, two: Point, a: float, b: float) -> Point:
    return a * one[0] + b * two[0], a * one[1] + b * two[1], a * one[2] + b * two[2]


def _along(start: Point, way: Point, length: float) -> Point:
    return _mixed(start, way, 1.0, length)

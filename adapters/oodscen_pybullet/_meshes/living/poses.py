"""Poses and gestures of people as joint angles."""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from oodscen.data._details import Details, posed
from oodscen.numerics._exact import PI, cos
from oodscen_pybullet._meshes.look import BEATS

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
        blended = {}
        for name in type(self).model_fields:
            start, end = getattr(self, name), getattr(other, name)
            if isinstance(start, tuple) and isinstance(end, tuple):
                pairs = zip(start, end, strict=True)
                blended[name] = tuple(a + share * (b - a) for a, b in pairs)
            elif isinstance(start, float):
                blended[name] = start + share * (end - start)
        return self.model_copy(update=blended)


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
        clocks = [clock for clock in (self.period_s, self.stride_m) if clock is not None]
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

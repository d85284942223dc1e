"""One row of the table of built-in behaviours: its entry in catalogues, and all that other packages ask about it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from oodscen.data._catalogue import BehaviourKind, BehaviourParameter
from oodscen.data._category import Category
from oodscen.driving._motion.behaviours.codes import Code

Effect = Literal["", "brakes", "joins", "crosses"]
"""Effects on those behind: an actor slows down, comes into their lane, or crosses the road."""
Course = Literal["", "place", "lane", "against", "heading"]
"""Courses along the road: none that is plain, standing at one place, with its lane, against it, or by heading."""
PlainAction = Literal["", "none", "stop", "lane_change", "walk"]
"""Single actions that every player of scenarios has: braking to a stop, changing lanes, walking straight on."""


@dataclass(frozen=True)
class BehaviourRow:
    """One behaviour of the kinematic world."""

    code: Code
    """The branch of the kernel that moves it; its name is the behaviour's id."""
    description: str
    """The motion, for the models that stage scenes."""
    categories: tuple[Category, ...]
    """Categories of the actors that are able to do it."""
    parameters: Mapping[str, BehaviourParameter] = field(default_factory=dict)
    needs_other: bool = False
    """True if the actor belongs to another actor."""
    doing: str = ""
    """The motion as a few frames show it: `braking hard`."""
    has_side: bool = False
    """True if the motion comes from a side of the road, which the words must name."""
    phrase: str = ""
    """The whole motion for readers of a report; its id if empty."""
    effect: Effect = ""
    tags: tuple[str, ...] = ()
    """Its tags in ASAM OpenLABEL's ontology; empty if it is not a motion of a road user."""
    plain_action: PlainAction = ""
    """The action that says all of it, `none` if it does nothing unusual; empty if no single action does."""
    course: Course = ""
    """Course along the road until it meets the ego."""
    keeps_heading: bool = False
    """True if it goes straight on along its heading, whatever the lane does."""
    reaches_farther: bool = False
    """True if it starts earlier and goes farther where the ego's lane is farther from the roadside."""
    holds_brake: bool = False
    """True if its driver keeps a foot on the brake while standing."""
    moves_before_trigger: bool = False
    """True if it drives at its `speed` from the start."""
    drives_from_rest: bool = False
    """True if it stands until its trigger and then drives on the road."""
    has_trigger: bool = True
    """False if no trigger changes its course."""
    has_chance: bool = False
    """True if its phase is drawn from the seed."""
    leaves_ground: bool = False

    @cached_property
    def kind(self) -> BehaviourKind:
        """Its entry in catalogues."""
        return BehaviourKind(
            id=self.code.name.lower(),
            description=self.description,
            categories=self.categories,
            parameters=dict(self.parameters),
            needs_other=self.needs_other,
        )

"""Storyboards: their start and end, and the elements for what entities do."""

from oodscen.data._scene import Scene
from oodscen.interchange._writing.elements import Element, child, within
from oodscen.interchange._writing.environment import write_environment
from oodscen.interchange._writing.trajectories import world_position
from oodscen.interchange._writing.triggers import at_time
from oodscen.numerics._exact import Floats

_STANDING_MPS = 1e-9
"""Speed up to which an entity stands, m/s."""


class Storyboard:
    """The storyboard of one file: init, one story with one act, and its end."""

    def __init__(self, parent: Element, scene: Scene, story: str) -> None:
        self.root = child(parent, "Storyboard")
        self.actions = within(self.root, "Init", "Actions")
        write_environment(self.actions, scene.weather, minor=2)
        self.act = child(child(self.root, "Story", name=story), "Act", name="act")

    def maneuver(self, name: str) -> Element:
        """Append a maneuver of one entity."""
        return child(maneuver_group(self.act, name), "Maneuver", name=f"maneuver_{name}")

    def end(self, time_s: float) -> None:
        """Append the triggers of the act and of the storyboard's end; an act has at least one group."""
        if not len(self.act):
            maneuver_group(self.act, "ego")
        at_time(self.act, "StartTrigger", "act_start", 0.0)
        at_time(self.root, "StopTrigger", "end", time_s, "greaterThan")


def maneuver_group(act: Element, name: str) -> Element:
    """Append a group of maneuvers for one entity."""
    group = child(act, "ManeuverGroup", name=f"group_{name}", maximumExecutionCount=1)
    actors = child(group, "Actors", selectTriggeringEntities=False)
    child(actors, "EntityRef", entityRef=name)
    return group


def event(maneuver: Element, name: str) -> tuple[Element, Element]:
    """Append an event, and return it and its action."""
    new = child(maneuver, "Event", name=name, priority="override", maximumExecutionCount=1)
    return new, child(new, "Action", name=f"action_{name}")


def write_start(actions: Element, name: str, pose: Floats, speed: float) -> None:
    """Append an entity's pose and, unless it stands, its speed at the start."""
    private = child(actions, "Private", entityRef=name)
    teleport = within(private, "PrivateAction", "TeleportAction")
    world_position(child(teleport, "Position"), pose)
    if abs(speed) > _STANDING_MPS:
        write_speed(child(private, "PrivateAction"), speed)


def write_speed(action: Element, speed: float) -> None:
    """Append an immediate change of speed."""
    holder = within(action, "LongitudinalAction", "SpeedAction")
    child(holder, "SpeedActionDynamics", dynamicsShape="step", dynamicsDimension="time", value=0.0)
    child(child(holder, "SpeedActionTarget"), "AbsoluteTargetSpeed", value=float(speed))


def strip_ego(root: Element) -> None:
    """Remove the ego's maneuvers, so that another controller drives it; its empty group stays."""
    for group in root.iter("ManeuverGroup"):
        if group.get("name") == "group_ego":
            for maneuver in group.findall("Maneuver"):
                group.remove(maneuver)

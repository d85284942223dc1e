"""The formats, and the elements of OpenSCENARIO XML, that are written and read, as the tables of the documentation."""

from collections.abc import Sequence
from typing import NamedTuple

from oodscen.data._catalogue import BehaviourKind
from oodscen.driving._motion.behaviours import BEHAVIOURS, MOVES_BEFORE_TRIGGER, WITHOUT_TRIGGER


class ElementSupport(NamedTuple):
    """One element of the standard, both ways; an empty text means that it is not supported."""

    element: str
    written: str = ""
    read: str = ""


class FormatSupport(NamedTuple):
    """One format of `oodscen export`."""

    name: str
    """Its name as a value of `--to`."""
    files: str
    content: str
    read: str = ""
    """The command that reads it."""
    extra: str = ""
    """The extra that it needs."""


FORMATS: tuple[FormatSupport, ...] = (
    FormatSupport(
        "openscenario",
        "`.xosc`, `.xodr`",
        "OpenSCENARIO XML 1.2, 1.0 for ScenarioRunner; OpenDRIVE",
        "`import`",
    ),
    FormatSupport("openlabel", "`.json`", "tags as OpenLABEL 1.0"),
    FormatSupport("osi", "`.osi`", "OSI ground truth", "`verdict`"),
    FormatSupport("mcap", "`.mcap`", "OSI ground truth and the map in MCAP", "`verdict`", "osi"),
    FormatSupport("rerun", "`.rrd`", "camera, depth, boxes, plan, actions", "", "rerun"),
)
"""The formats in the order of the option's values."""

ELEMENTS: tuple[ElementSupport, ...] = (
    ElementSupport("FileHeader", "1.2, fixed date; properties with the scene", "1.0 to 1.3"),
    ElementSupport("ParameterDeclarations", "of logical scenarios", "everywhere, `${}` too"),
    ElementSupport("ParameterValueDistribution", "ranges, uniform distributions"),
    ElementSupport("CatalogReference", "", "entities, routes, trajectories, maneuvers, weather"),
    ElementSupport("LogicFile", "the map, beside the file", "yes, or `--map`"),
    ElementSupport("TrafficSignals"),
    ElementSupport("Vehicle", "box, axles, category", "the nearest asset"),
    ElementSupport("Pedestrian", "box, category", "the nearest asset"),
    ElementSupport("MiscObject", "box, category", "the nearest asset"),
    ElementSupport("ExternalObjectReference"),
    ElementSupport("EntitySelection"),
    ElementSupport("ObjectController"),
    ElementSupport("EnvironmentAction", "at the start", "the first"),
    ElementSupport("TeleportAction", "at the start", "at the start"),
    ElementSupport("SpeedAction", "at the start, and rest", "start, stop, pulling out"),
    ElementSupport("LaneChangeAction", "", "`cut_in`"),
    ElementSupport("LaneOffsetAction"),
    ElementSupport("FollowTrajectoryAction", "polylines", "a straight way"),
    ElementSupport("AcquirePositionAction", "", "a straight way"),
    ElementSupport("AssignRouteAction", "", "a straight way"),
    ElementSupport("SynchronizeAction", "", "a start by time to collision"),
    ElementSupport("LongitudinalDistanceAction", "followers of the ego"),
    ElementSupport("ControllerAction"),
    ElementSupport("AnimationAction"),
    ElementSupport("WorldPosition", "with pitch", "x, y, heading"),
    ElementSupport("LanePosition", "", "yes"),
    ElementSupport("RoadPosition", "", "yes"),
    ElementSupport("RelativeObjectPosition", "reactions of moving actors", "yes"),
    ElementSupport("RelativeWorldPosition", "", "yes"),
    ElementSupport("RelativeLanePosition", "", "yes"),
    ElementSupport("RelativeRoadPosition", "", "yes"),
    ElementSupport("RoutePosition"),
    ElementSupport("GeoPosition"),
    ElementSupport("SimulationTimeCondition", "yes", "yes"),
    ElementSupport("StoryboardElementStateCondition", "later phases", "as the start"),
    ElementSupport("DistanceCondition", "to standing actors", "yes"),
    ElementSupport("RelativeDistanceCondition", "to moving actors", "yes"),
    ElementSupport("TimeToCollisionCondition", "to a position or an actor", "yes"),
    ElementSupport("TimeHeadwayCondition", "", "as a distance"),
    ElementSupport("TraveledDistanceCondition", "", "as a time"),
    ElementSupport("ReachPositionCondition", "", "as a distance"),
    ElementSupport("CollisionCondition"),
    ElementSupport("ParameterCondition"),
    ElementSupport("VariableCondition"),
)
"""The elements in the order of the standard."""


def format_table() -> str:
    """Return the formats as a Markdown table."""
    rows = [
        (
            f"`{one.name}`",
            one.files,
            one.content,
            one.read or "–",
            f"`{one.extra}`" if one.extra else "–",
        )
        for one in FORMATS
    ]
    return _table(("`--to`", "files", "content", "read by", "extra"), rows)


def element_table() -> str:
    """Return the supported elements as a Markdown table."""
    rows = [(f"`{one.element}`", one.written or "–", one.read or "–") for one in ELEMENTS]
    return _table(("element", "written", "read"), rows)


def behaviour_table() -> str:
    """Return as a Markdown table in which form a reactive file has each behaviour."""
    return _table(
        ("behaviour", "in a reactive file"), [(f"`{b.id}`", _form(b)) for b in BEHAVIOURS]
    )


def _form(kind: BehaviourKind) -> str:
    if kind.id == "stand":
        return "its place"
    if kind.id in WITHOUT_TRIGGER:
        return "its recorded course; a follower of the ego keeps its first distance"
    if kind.id == "overtake":
        return "its recorded course from the trigger on; not exact for another ego"
    where = "where it then is" if kind.id in MOVES_BEFORE_TRIGGER else "from its place"
    return f"its recorded course from the trigger on, {where}"


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines) + "\n"

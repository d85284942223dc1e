"""Small OpenSCENARIO files of others, on a road of the catalogue."""

from hypothesis import HealthCheck, settings

from oodscen.driving._roads.building import find_map, read_map
from oodscen.interchange import read_openscenario
from tests.interchange.staging import catalogue

ROAD = read_map(find_map("urban_avenue", catalogue()).file)
IN_FOLDER = settings(
    max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None
)
"""Settings of laws that write their files into one folder."""
_BODY = {"car": ("Vehicle", "vehicleCategory"), "pedestrian": ("Pedestrian", "pedestrianCategory")}


def entity(name, kind="car", ahead=1.4, length=4.5, width=1.8):
    body, category = _BODY[kind]
    return (
        f'<ScenarioObject name="{name}"><{body} name="v" {category}="{kind}"><BoundingBox>'
        f'<Center x="{ahead}" y="0" z="0.7"/><Dimensions length="{length}" width="{width}" height="1.5"/>'
        f"</BoundingBox></{body}></ScenarioObject>"
    )


def lane(s, lane=-1, offset=0.0):
    return f'<LanePosition roadId="1" laneId="{lane}" s="{s}" offset="{offset}"/>'


def world(x, y, h=0.0):
    return f'<WorldPosition x="{x}" y="{y}" h="{h}"/>'


def speed(value, shape="step", amount=0, dimension="time"):
    return (
        f"<PrivateAction><LongitudinalAction><SpeedAction>"
        f'<SpeedActionDynamics dynamicsShape="{shape}" value="{amount}" dynamicsDimension="{dimension}"/>'
        f'<SpeedActionTarget><AbsoluteTargetSpeed value="{value}"/></SpeedActionTarget>'
        "</SpeedAction></LongitudinalAction></PrivateAction>"
    )


def start(name, place, first=0.0):
    teleport = f"<PrivateAction><TeleportAction><Position>{place}</Position></TeleportAction></PrivateAction>"
    return f'<Private entityRef="{name}">{teleport}{speed(first)}</Private>'


def event(action, condition, name="a", delay=0, edge="none", act=""):
    held = f'<Condition name="c" delay="{delay}" conditionEdge="{edge}">{condition}</Condition>'
    return (
        '<Story name="s"><Act name="t"><ManeuverGroup name="g" maximumExecutionCount="1">'
        f'<Actors selectTriggeringEntities="false"><EntityRef entityRef="{name}"/></Actors>'
        f'<Maneuver name="m"><Event name="e" priority="overwrite"><Action name="x">{action}</Action>'
        f"<StartTrigger><ConditionGroup>{held}</ConditionGroup></StartTrigger></Event></Maneuver>"
        f"</ManeuverGroup>{act}</Act></Story>"
    )


def at(seconds, rule="greaterThan"):
    return f'<ByValueCondition><SimulationTimeCondition value="{seconds}" rule="{rule}"/></ByValueCondition>'


def by_entity(condition, *names):
    refs = "".join(f'<EntityRef entityRef="{name}"/>' for name in names or ("ego",))
    return (
        f'<ByEntityCondition><TriggeringEntities triggeringEntitiesRule="any">{refs}</TriggeringEntities>'
        f"<EntityCondition>{condition}</EntityCondition></ByEntityCondition>"
    )


def near(value, reference="a", freespace="false", rule="lessThan", kind="longitudinal"):
    return (
        f'<RelativeDistanceCondition entityRef="{reference}" relativeDistanceType="{kind}" '
        f'value="{value}" freespace="{freespace}" rule="{rule}"/>'
    )


def file(entities, starts, story="", environment="", parameters="", catalogues=""):
    return f"""<OpenSCENARIO>
<FileHeader revMajor="1" revMinor="2" date="2024-01-01T00:00:00" description="x" author="y"/>
<ParameterDeclarations>{parameters}</ParameterDeclarations>
<CatalogLocations>{catalogues}</CatalogLocations>
<RoadNetwork><LogicFile filepath="road.xodr"/></RoadNetwork>
<Entities>{"".join(entities)}</Entities>
<Storyboard><Init><Actions>{environment}{"".join(starts)}</Actions></Init>
{story}
<StopTrigger/></Storyboard></OpenSCENARIO>"""


def cars(story="", first=5.0, ego=10.0, place=None, ego_place=None, **parts):
    """Return a file of the ego and a car 50 m ahead of it."""
    starts = [
        start("ego", ego_place or lane(200), ego),
        start("a", place or lane(250), first),
    ]
    return file([entity("ego"), entity("a")], starts, story, **parts)


def weather(sky="<Weather/>", friction=1.0):
    return (
        '<GlobalAction><EnvironmentAction><Environment name="e">'
        f'{sky}<RoadCondition frictionScaleFactor="{friction}"/>'
        "</Environment></EnvironmentAction></GlobalAction>"
    )


def read(folder, text, own_road=ROAD, **options):
    (folder / "road.xodr").write_bytes(own_road)
    path = folder / "other.xosc"
    path.write_text(text)
    return read_openscenario(path, catalogue(), **options)


def notes(found):
    return [str(omission) for omission in found.omissions]

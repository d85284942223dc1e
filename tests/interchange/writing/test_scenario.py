import numpy as np
import pytest
from lxml import etree

from oodscen.data import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._designs.motion import Motion
from oodscen.driving._motion.actions import is_available
from oodscen.driving._motion.behaviours.table import BEHAVIOURS, BUILT_IN
from oodscen.errors import SceneError, UnknownComponent, UsageError
from oodscen.interchange._moving import UnrenderedSimulator
from oodscen.interchange._reading.scenario import read_openscenario
from oodscen.interchange._recording import replayed
from oodscen.interchange._tags import scene_tags
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._writing.reactions import reactions
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.interchange._writing.scenario_runner import unplayable
from oodscen.stages._simulate import approach
from tests.interchange.page import table
from tests.interchange.playing import centres, turned
from tests.interchange.staging import SCENES, catalogue, doing

DOINGS = [doing(kind) for kind in BEHAVIOURS]
MOTIONS = [
    Motion.parse({"id": name, "description": "moving somehow", **members})
    for name, members in {
        "comes": {"body": "car", "begins": "moving", "keys": [{"at": 0}, {"at": 3, "ahead": 24}, {"at": 6, "ahead": 36}]},
        "rises": {"body": "loose", "keys": [{"at": 0, "up": -1}, {"at": 3}]},
        "hovers": {"body": "flying", "frame": "other", "then": "repeat", "keys": [{"up": 2}, {"at": 2, "up": 3}, {"at": 4, "up": 2}]},
    }.items()
]  # fmt: skip
MADE = [doing(motion.kind()).model_copy(update={"motions": (motion,)}) for motion in MOTIONS]


@pytest.fixture(autouse=True, scope="module")
def _reactions_once():
    """Drive each scene for its reactive files once, whatever is written of it."""
    known = {}

    def once(scene, catalogue, seed):
        key = (scene.to_json(), catalogue.digest(), seed)
        return (
            known[key] if key in known else known.setdefault(key, reactions(scene, catalogue, seed))
        )

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("oodscen.interchange._writing.scenario.reactions", once)
        yield


def names(root, tag, attribute):
    return [one.get(attribute) for one in root.iter(tag)]


@pytest.mark.parametrize("scene", [*SCENES[::2], *DOINGS, *MADE], ids=lambda one: one.id)
def test_a_replay_has_every_course_within_a_millimetre_and_a_degree(scene):
    truth = replayed(scene, UnrenderedSimulator(catalogue()), "stop", 0)
    played = centres(to_openscenario(scene, catalogue(), action="stop").xosc, truth.time)
    assert set(played) == set(truth.ids)
    for row, name in enumerate(truth.ids):
        apart = np.abs(played[name][:, :3] - truth.poses[:, row, :3])
        assert apart.max() < 1e-3, name
        assert turned(played[name][:, 3], truth.poses[:, row, 3]) < 1.0, name


@pytest.mark.parametrize(
    ("scene", "mode"),
    [
        *((scene, "reactive") for scene in (*SCENES[::3], *DOINGS, *MADE)),
        *((scene, "replay") for scene in (*SCENES[::3], *MADE)),
    ],
    ids=lambda one: getattr(one, "id", one),
)
def test_every_reference_leads_somewhere_and_names_are_unique(scene, mode):
    root = etree.fromstring(to_openscenario(scene, catalogue(), mode=mode, target="esmini").xosc)
    entities = names(root, "ScenarioObject", "name")
    assert entities == ["ego", *(actor.id for actor in scene.actors)]
    for element in root.iter():
        assert element.get("entityRef", "ego") in entities
    for tag in ("Event", "ManeuverGroup", "Condition", "Trajectory"):
        found = names(root, tag, "name")
        assert len(found) == len(set(found))
    events = names(root, "Event", "name")
    for started in root.iter("StoryboardElementStateCondition"):
        assert started.get("storyboardElementRef") in events
    known = {element for element, written, _ in table("elements") if written}
    kinds = ("Action", "Condition", "Position")
    for element in root.iter():
        if element.tag.endswith(kinds) and len(element.tag) > 14 and "Entity" not in element.tag:
            groups = ("PrivateAction", "GlobalAction", "RoutingAction", "LongitudinalAction")
            assert element.tag in known.union(groups, ["ByValueCondition"]), element.tag


@pytest.mark.parametrize("scene", DOINGS, ids=lambda one: one.id)
def test_a_reaction_starts_with_its_condition_on_the_ego(scene):
    run = reactions(scene, catalogue(), 0)
    root = etree.fromstring(to_openscenario(scene, catalogue(), mode="reactive").xosc)
    reacts = [name for name in names(root, "Event", "name") if name.startswith("react_actor")]
    behaviour = scene.actors[-1].behaviour.name
    changes = behaviour not in ("stand", "follow_lane", "wrong_way", "run_red", "towed")
    assert bool(reacts) == (changes and "actor" in run.triggered)
    if reacts:
        (trigger,) = (one for one in root.iter("Condition") if one.get("name") == "trigger_actor")
        assert {"DistanceCondition", "RelativeDistanceCondition"} & {
            one.tag for one in trigger.iter()
        }


def test_the_ego_is_last_and_can_be_left_out():
    for scene in SCENES[::10]:
        root = etree.fromstring(to_openscenario(scene, catalogue()).xosc)
        assert names(root, "ManeuverGroup", "name")[-1] == "group_ego"
        without = etree.fromstring(to_openscenario(scene, catalogue(), ego=False).xosc)
        assert not any("ego" in name for name in names(without, "Maneuver", "name"))
        assert without.find("Storyboard/Story/Act/ManeuverGroup") is not None


def test_the_same_scene_gives_the_same_bytes():
    scene = SCENES[0]
    for mode in ("replay", "reactive"):
        first = scene.to_openscenario(catalogue(), mode=mode)
        assert first == to_openscenario(scene, catalogue(), mode=mode)


def test_files_are_saved_beside_their_roads(tmp_path):
    for scene in SCENES[::10]:
        path = to_openscenario(scene, catalogue()).save(tmp_path)
        road = etree.parse(path).find("RoadNetwork/LogicFile").get("filepath")
        assert (tmp_path / road).read_bytes().startswith(b"<?xml")


def test_what_cannot_be_written_is_refused():
    with pytest.raises(UnknownComponent):
        to_openscenario(SCENES[0], catalogue(), mode="other")
    with pytest.raises(UnknownComponent):
        to_openscenario(SCENES[0], catalogue(), action="jump")
    odd = SCENES[0].model_copy(update={"map": "nowhere"})
    with pytest.raises(SceneError):
        to_openscenario(odd, catalogue())


@pytest.mark.parametrize("action", ["change_lane_left", "change_lane_right"])
def test_an_action_is_written_exactly_where_the_ego_has_its_lane(action):
    for scene in SCENES[:3]:
        simulator = UnrenderedSimulator(catalogue())
        approach(scene, simulator, 0)
        if is_available(action, simulator.observe()):
            assert to_openscenario(scene, catalogue(), action=action).xosc
            assert osi_trace(scene, catalogue(), action=action)
            continue
        for write in (to_openscenario, osi_trace):
            with pytest.raises(UsageError, match=f"no lane for its action {action}"):
                write(scene, catalogue(), action=action)


@pytest.mark.parametrize("scene", [*SCENES[::4], *DOINGS], ids=lambda one: one.id)
def test_scenario_runner_gets_its_own_actions_or_a_reason_for_each_actor(scene):
    options = {"mode": "reactive", "target": "carla-scenario-runner"}
    if reasons := unplayable(scene, reactions(scene, catalogue(), 0)):
        with pytest.raises(SceneError) as caught:
            to_openscenario(scene, catalogue(), **options)
        assert list(caught.value.issues) == reasons
        assert all(issue.path.startswith("actors[") for issue in reasons)
        return
    root = etree.fromstring(to_openscenario(scene, catalogue(), **options).xosc)
    assert root.find("FileHeader").get("revMinor") == "0"
    assert not list(root.iter("FollowTrajectoryAction"))
    assert set(names(root, "Event", "priority")) <= {"overwrite"}
    assert set(names(root, "SimulationTimeCondition", "rule")) == {"greaterThan"}
    assert all(BUILT_IN[actor.behaviour.name].plain_action for actor in scene.actors)


@pytest.mark.parametrize(("lane", "lanes"), [(0, 1.0), (2, -1.0), (3, -1.0), (2, 1.0)])
def test_a_change_of_lanes_in_a_file_is_as_the_actor_sees_it(tmp_path, lane, lanes):
    actor = Actor(
        id="car",
        asset="car",
        placement=Placement(ahead_m=80.0, lane=lane),
        behaviour=Behaviour(name="cut_in", parameters={"speed": 8.0, "lanes": lanes}),
    )
    scene = Scene(
        id="car",
        scenario_id="car",
        map="urban_avenue",
        ego=Ego(speed=10.0),
        actors=(actor,),
        hazard=Hazard(actors={"car": None}),
        decision=Trigger(kind="time", value=1.0),
    )
    file = to_openscenario(scene, catalogue(), mode="reactive", target="carla-scenario-runner")
    (own,) = etree.fromstring(file.xosc).iter("RelativeTargetLane")
    side = 1.0 if lane < 2 else -1.0  # Lanes 2 and 3 are oncoming.
    assert float(own.get("value")) == side * lanes
    assert scene_tags(scene, catalogue()).keys() & {
        "MotionLaneChangeLeft",
        "MotionLaneChangeRight",
    } == {"MotionLaneChangeLeft" if side * lanes > 0.0 else "MotionLaneChangeRight"}
    again = read_openscenario(file.save(tmp_path), catalogue()).scene.actors[0]
    assert again.behaviour.parameters["lanes"] == lanes
    assert again.placement.lane == lane


RUNNER = {"mode": "reactive", "target": "carla-scenario-runner"}


@pytest.mark.parametrize("name", ["cut_in", "hard_brake", "cross_road"])
def test_a_behaviour_of_a_simulator_is_written_as_the_one_that_it_is_like(name):
    kind = BUILT_IN[name].kind
    own = kind.model_copy(update={"id": f"own_{name}", "like": name})
    wider = catalogue().model_copy(update={"behaviours": (*BEHAVIOURS, own)})
    scene = doing(kind)
    (actor,) = scene.actors
    behaviour = actor.behaviour.model_copy(update={"name": own.id})
    same = scene.model_copy(update={"actors": (actor.model_copy(update={"behaviour": behaviour}),)})
    for options in ({"mode": "reactive"}, RUNNER):
        boards = [
            etree.tostring(
                etree.fromstring(to_openscenario(one, wider, **options).xosc).find("Storyboard")
            )
            for one in (scene, same)
        ]
        assert boards[0] == boards[1]
    assert scene_tags(scene, wider) == scene_tags(same, wider)


def test_what_a_behaviour_leaves_open_is_written_as_its_default():
    kind = BUILT_IN["cross_road"].kind
    scene = doing(kind)
    (actor,) = scene.actors
    behaviour = actor.behaviour.model_copy(update={"parameters": {}})
    scene = scene.model_copy(
        update={"actors": (actor.model_copy(update={"behaviour": behaviour}),)}
    )
    root = etree.fromstring(to_openscenario(scene, catalogue(), **RUNNER).xosc)
    (travelled,) = names(root, "TraveledDistanceCondition", "value")
    assert float(travelled) == kind.parameters["distance"].default


def test_scenario_runner_plays_no_recorded_courses():
    with pytest.raises(UsageError):
        to_openscenario(SCENES[0], catalogue(), target="carla-scenario-runner")


def test_the_checkers_of_asam_have_no_issue(tmp_path):
    pytest.importorskip("qc_openscenario")
    from tests.interchange.asam import issues

    for scene in [*SCENES, *DOINGS]:
        for mode in ("replay", "reactive"):
            file = to_openscenario(scene, catalogue(), mode=mode)
            path = file.save(tmp_path / mode)
            assert issues(path) == []
            assert issues(path.with_name(file.road.name)) == []

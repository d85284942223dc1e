import math
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_sumo import SumoSimulator
from oodscen_sumo._catalogue import load_catalogue
from oodscen_sumo._network import Networks, load_sumo
from oodscen_sumo._places import FrontBumper

from oodscen import make_catalogue
from oodscen.data import Actor, Behaviour, Placement, Scene, Trigger
from oodscen.driving._roads.building import load_corridor, read_map
from oodscen.driving._roads.network import KINDS
from oodscen.errors import SceneError, SimulatorError, SpawnError
from oodscen.protocols import Control, State
from oodscen.testing import check_simulator
from oodscen.testing._check import QUICK
from oodscen.testing._kit.samples import plain_scene, sample_scene
from tests.adapters.missing import told_without
from tests.driving import networks as opendrive
from tests.driving.networks import lane
from tests.needs import needs

pytestmark = needs("libsumo", "sumo")

CATALOGUE = load_catalogue()
AVENUE = CATALOGUE.map("urban_avenue")


def actor(behaviour: str, *, id: str = "a", asset: str = "car", ahead: float = 30.0, **parameters):
    doing = Behaviour(name=behaviour, trigger=Trigger(value=0.5), parameters=parameters)
    return Actor(id=id, asset=asset, placement=Placement(ahead_m=ahead), behaviour=doing)


@pytest.mark.parametrize("part", QUICK)
def test_it_keeps_the_protocols_promises(part) -> None:
    # One street and one road that bends: what does not repeat does so on any road.
    scenes = [
        plain_scene(CATALOGUE, CATALOGUE.map(road)) for road in ("urban_avenue", "rural_curve")
    ]
    check_simulator(SumoSimulator, scenes=scenes, parts=(part,))


def test_every_driving_lane_has_a_lane_of_sumo_in_its_middle() -> None:
    sumo, _ = load_sumo()
    for road in CATALOGUE.maps:
        corridor = load_corridor(road)
        with SumoSimulator() as simulator:
            simulator.reset(sample_scene(road, ()), 0)
            for strip in corridor.driving:
                for s in np.arange(corridor.start - 10.0, corridor.start + 300.0, 9.0):
                    x, y, *_ = corridor.point(s, corridor.centre(strip, s))
                    middle = sumo.simulation.convert2D(*sumo.simulation.convertRoad(x, y))
                    along, t = corridor.locate(*middle)
                    assert abs(t - corridor.centre(strip, along)) < 0.1, (road.id, strip, s)
                    assert abs(along - s) < 0.5, (road.id, strip, s)


def test_drivers_brake_for_a_guided_body_that_crosses() -> None:
    crossing = actor("cross_road", id="b", asset="adult", ahead=80.0, speed=0.2, distance=1.0)
    with SumoSimulator() as simulator:
        state = simulator.reset(sample_scene(AVENUE, (actor("follow_lane"), crossing)), 0)
        for _ in range(200):
            state = simulator.step(Control())
    assert state.speeds[1] < 1.0
    assert state.poses[1, 0] < state.poses[2, 0]


def test_a_change_into_an_oncoming_lane_is_refused() -> None:
    street = CATALOGUE.map("residential_two_lane")
    with SumoSimulator() as simulator, pytest.raises(SceneError) as refused:
        simulator.reset(sample_scene(street, (actor("cut_in", lanes=1.0),)), 0)
    assert [issue.path for issue in refused.value.issues] == [
        "actors[0].behaviour.parameters.lanes"
    ]


@pytest.mark.parametrize("behaviour", ["follow_lane", "hard_brake"])
def test_a_driver_against_the_traffic_of_its_lane_is_refused(behaviour) -> None:
    against = Placement(ahead_m=60.0, heading_deg=180.0)
    staged = actor(behaviour).model_copy(update={"placement": against})
    with SumoSimulator() as simulator, pytest.raises(SceneError) as refused:
        simulator.reset(sample_scene(AVENUE, (staged,)), 0)
    assert [issue.path for issue in refused.value.issues] == ["actors[0].placement.heading_deg"]


def street(tmp_path, *, rule: str = "RHT", turn: float = 0.1) -> str:
    """Return a file of a road with two lanes on each side, straight and then in a bend to the left by some rad."""
    lanes = {
        side: "".join(
            f'<lane id="{sign * index}" type="driving">'
            '<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>'
            for index in order
        )
        for side, sign, order in (("left", 1, (2, 1)), ("right", -1, (1, 2)))
    }
    file = tmp_path / "street.xodr"
    file.write_text(
        '<OpenDRIVE><header revMajor="1" revMinor="8"/>'
        f'<road id="1" length="360" junction="-1" rule="{rule}"><planView>'
        '<geometry s="0" x="0" y="0" hdg="0" length="260"><line/></geometry>'
        '<geometry s="260" x="260" y="0" hdg="0" length="100">'
        f'<arc curvature="{turn / 100.0}"/></geometry></planView><lanes><laneSection s="0">'
        f'<left>{lanes["left"]}</left><center><lane id="0" type="none"/></center>'
        f"<right>{lanes['right']}</right></laneSection></lanes></road></OpenDRIVE>"
    )
    return str(file)


@pytest.mark.parametrize("lanes", [1, -1])
@pytest.mark.parametrize("road", ["urban_avenue", "highway", "street"])
def test_a_driver_that_changes_lanes_moves_as_its_speed_says(road, lanes, tmp_path) -> None:
    changing = actor("cut_in", ahead=20.0, speed=10.0, lanes=float(lanes), duration=3.0)
    beside = Placement(ahead_m=20.0, lane=0 if lanes > 0 else 1, offset_m=0.3)
    changing = changing.model_copy(update={"placement": beside})
    scene = sample_scene(AVENUE, (changing,))
    scene = scene.model_copy(
        update={"map": street(tmp_path, turn=1.2) if road == "street" else road}
    )
    with SumoSimulator() as simulator:
        states = [simulator.reset(scene, 0)]
        states += [simulator.step(Control()) for _ in range(100)]
    places = np.array([state.places[1] for state in states])
    speeds = np.array([state.speeds[1] for state in states])
    poses = np.array([state.poses[1] for state in states])
    assert abs(places[-1, 1] - places[0, 1]) == pytest.approx(3.5, abs=0.6)
    steps = np.diff(poses[:, :2], axis=0)
    headings = np.stack([np.cos(poses[1:, 3]), np.sin(poses[1:, 3])], axis=1)
    along = (steps * headings).sum(axis=1) / simulator.dt
    assert np.abs(along - speeds[1:]).max() < 0.01
    assert np.abs(speeds - 10.0).max() < (1.5 if road == "street" else 0.4)
    assert np.abs(np.diff(speeds)).max() < 0.2
    assert np.abs(np.diff(poses[:, 3])).max() < 0.03


def test_a_driver_that_has_left_the_network_stands(tmp_path) -> None:
    leaving = actor("follow_lane", ahead=100.0, speed=40.0)
    scene = sample_scene(AVENUE, (leaving,)).model_copy(update={"map": street(tmp_path)})
    with SumoSimulator() as simulator:
        states = [simulator.reset(scene, 0)]
        states += [simulator.step(Control()) for _ in range(200)]
    assert np.array_equal(states[-1].poses[1], states[-2].poses[1])
    assert states[-1].speeds[1] == 0.0


def run(simulator: SumoSimulator, scene: Scene, steps: int = 120) -> list[State]:
    return [simulator.reset(scene, 0), *(simulator.step(Control()) for _ in range(steps))]


@pytest.mark.parametrize("against", [False, True])
@pytest.mark.parametrize("joint", ["sections", "roads"])
def test_drivers_go_on_over_joints_of_sections_and_of_roads(joint, against, tmp_path) -> None:
    lanes = {"right": lane(-1), "left": lane(1)}
    whole = opendrive.road("1", 400.0, **lanes)
    if joint == "sections":
        begin, end = whole.index("<laneSection"), whole.index("</lanes>")
        section = whole[begin:end]
        for id in (1, -1):
            section = section.replace("<link></link>", f'<link><{{}} id="{id}"/></link>', 1)
        both = section.replace("{}", "successor") + section.replace("{}", "predecessor").replace(
            's="0"', 's="130"', 1
        )
        parts = [whole[:begin] + both + whole[end:]]
    else:
        link = '<{} elementType="road" elementId="{}" contactPoint="{}"/>'
        on = opendrive.road("1", 130.0, link=link.format("successor", 2, "start"), **lanes)
        back = link.format("predecessor", 1, "end")
        parts = [on, opendrive.road("2", 270.0, at=(130.0, 0.0, 0.0), link=back, **lanes)]
    placement = Placement(ahead_m=45.0 if against else 15.0, lane=int(against))
    driver = actor("follow_lane", speed=8.0).model_copy(update={"placement": placement})
    found = []
    for number, content in enumerate(([whole], parts)):
        map_file = tmp_path / f"{number}.xodr"
        map_file.write_bytes(opendrive.file(*content))
        scene = sample_scene(AVENUE, (driver,)).model_copy(update={"map": str(map_file)})
        with SumoSimulator() as simulator:
            found.append(run(simulator, scene))
            start_s = simulator.staged.corridor.start
            assert start_s == pytest.approx(100.0)
    for one, other in zip(*found, strict=True):
        assert np.abs(one.poses - other.poses).max() < 0.15
        assert np.abs(one.speeds - other.speeds).max() < 0.1


@pytest.mark.parametrize("kind", [kind for kind in KINDS if KINDS[kind] == "driving"])
def test_drivers_drive_on_every_kind_of_driving_lane(kind, tmp_path) -> None:
    map_file = tmp_path / "lanes.xodr"
    map_file.write_bytes(
        opendrive.file(opendrive.road("1", 400.0, right=lane(-1) + lane(-2, kind), left=lane(1)))
    )
    scene = sample_scene(AVENUE, (actor("follow_lane", speed=8.0),))
    scene = scene.model_copy(update={"map": str(map_file)})
    with SumoSimulator() as simulator:
        states = run(simulator, scene, 40)
    assert states[-1].poses[1, 0] - states[0].poses[1, 0] == pytest.approx(16.0, abs=0.1)


@pytest.mark.parametrize("offset_m", [-2.4, -2.8, -4.0])
def test_a_driver_beside_the_lanes_of_sumo_is_refused(offset_m, tmp_path) -> None:
    map_file = tmp_path / "shoulder.xodr"
    map_file.write_bytes(
        opendrive.file(
            opendrive.road("1", 400.0, right=lane(-1) + lane(-2, "shoulder"), left=lane(1))
        )
    )
    placement = Placement(ahead_m=30.0, offset_m=offset_m)
    driver = actor("follow_lane").model_copy(update={"placement": placement})
    scene = sample_scene(AVENUE, (driver,)).model_copy(update={"map": str(map_file)})
    with SumoSimulator() as simulator:
        if offset_m > -2.5:
            assert run(simulator, scene, 2)[-1].speeds[1] > 0.0
        else:
            with pytest.raises(SpawnError, match="no lane there"):
                simulator.reset(scene, 0)


def test_left_hand_traffic_is_refused(tmp_path) -> None:
    scene = sample_scene(AVENUE, (actor("follow_lane"),))
    scene = scene.model_copy(update={"map": street(tmp_path, rule="LHT")})
    with SumoSimulator() as simulator, pytest.raises(SceneError, match="LHT") as refused:
        simulator.reset(scene, 0)
    assert [issue.path for issue in refused.value.issues] == ["map"]


def test_a_driver_whose_lane_runs_the_other_way_in_sumo_is_refused(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(SumoSimulator, "check", lambda self, scene: [])
    scene = sample_scene(AVENUE, (actor("follow_lane"),))
    scene = scene.model_copy(update={"map": street(tmp_path, rule="LHT")})
    with SumoSimulator() as simulator, pytest.raises(SpawnError, match="runs the other way"):
        simulator.reset(scene, 0)


@pytest.mark.parametrize("friction", [1.0, 0.1])
def test_a_driver_that_halts_stands_for_the_pause_and_goes_on_even_on_ice(friction) -> None:
    halting = actor("halt", ahead=60.0, speed=8.0, deceleration=4.0, pause=2.0)
    scene = sample_scene(AVENUE, (halting,))
    weather = scene.weather.model_copy(update={"friction": friction})
    ego = scene.ego.model_copy(update={"speed": 0.0})
    with SumoSimulator() as simulator:
        simulator.reset(scene.model_copy(update={"weather": weather, "ego": ego}), 0)
        speeds = [simulator.step(Control()).speeds[1] for _ in range(300)]
    standing = simulator.dt * sum(speed < 0.1 for speed in speeds)
    assert 1.9 < standing < 2.3
    assert speeds[-1] > 1.0


@given(
    x=st.floats(-1e3, 1e3),
    y=st.floats(-1e3, 1e3),
    yaw=st.floats(-3.1, 3.1),
    length=st.floats(0.1, 20.0),
)
def test_places_of_front_bumpers_and_of_centres_are_two_views_of_one(x, y, yaw, length) -> None:
    front = FrontBumper.of(x, y, yaw, length=length)
    assert math.dist(front[:2], (x, y)) == pytest.approx(0.5 * length)
    assert front.pose(length) == pytest.approx((x, y, yaw), abs=1e-9)


def test_one_simulation_runs_per_process() -> None:
    scene = sample_scene(AVENUE, (actor("follow_lane"),))
    with SumoSimulator() as one, SumoSimulator() as other:
        first = one.reset(scene, 0).fingerprint()
        assert other.reset(scene, 0).fingerprint() == first
        with pytest.raises(SimulatorError):
            one.step(Control())
        one.reset(scene, 0)
        one.step(Control())


def test_a_driver_at_the_end_of_its_road_stays_there() -> None:
    leaving = actor("hard_brake", ahead=300.0, speed=45.0, deceleration=1.0)
    with SumoSimulator() as simulator:
        states = [simulator.reset(sample_scene(AVENUE, (leaving,)), 0)]
        states += [simulator.step(Control()) for _ in range(400)]
    assert np.array_equal(states[-1].poses[1], states[-2].poses[1])


def test_a_file_that_netconvert_refuses_is_named(tmp_path) -> None:
    broken = tmp_path / "broken.xodr"
    broken.write_text("no road")
    networks = Networks(load_sumo()[1])
    with pytest.raises(SimulatorError, match="broken"):
        networks.path(str(broken))
    networks.close()


def test_a_map_that_has_changed_has_another_network(tmp_path) -> None:
    changing = tmp_path / "changing.xodr"
    networks = Networks(load_sumo()[1])
    found = []
    for road in (AVENUE, CATALOGUE.maps[-1], AVENUE):
        changing.write_bytes(read_map(road.file))
        found.append(networks.path(str(changing)))
    networks.close()
    assert found[0] == found[2] != found[1]


@pytest.fixture
def run_netconvert(tmp_path):
    """Return a function that converts the avenue with a script in place of netconvert."""

    def run(script: str) -> None:
        program = tmp_path / "netconvert"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o700)
        networks = Networks(str(tmp_path))
        try:
            networks.path(AVENUE.file)
        finally:
            networks.close()

    return run


def test_a_missing_netconvert_is_told(tmp_path) -> None:
    networks = Networks(str(tmp_path))
    with pytest.raises(SimulatorError, match=r"netconvert cannot be started: .*No such file"):
        networks.path(AVENUE.file)
    networks.close()


def test_what_netconvert_says_is_told_on_one_line_in_any_encoding(run_netconvert) -> None:
    with pytest.raises(SimulatorError, match=r"refuses .*: caf\ufffd is no road$"):
        run_netconvert(r"printf 'caf\351\nis no road\n' >&2; exit 1")


def test_a_netconvert_that_does_not_end_is_ended(run_netconvert, monkeypatch) -> None:
    monkeypatch.setattr("oodscen_sumo._network._TIMEOUT_S", 0.2)
    with pytest.raises(SimulatorError, match=r"has not ended after 0\.2 s"):
        run_netconvert("exec sleep 5")


def test_a_libsumo_that_cannot_be_loaded_is_told(tmp_path, monkeypatch) -> None:
    (tmp_path / "libsumo.py").write_text("raise ImportError('libproj.so: cannot open')")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "libsumo", raising=False)
    with pytest.raises(SimulatorError, match=r"libsumo cannot be loaded: libproj\.so"):
        load_sumo()


def test_the_catalogue_needs_no_sumo_and_a_run_says_how_to_get_it() -> None:
    told = told_without("libsumo", "oodscen_sumo:SumoSimulator")
    assert told == ["sumo", "libsumo"]
    assert make_catalogue("oodscen_sumo:SumoSimulator") == CATALOGUE


def changes_lane(behaviour, duration, *, friction=1.0, obstacle=None):
    """Return the states of 5 s in which a car at 12 m/s changes lanes at once."""
    changing = actor(behaviour, ahead=20.0, speed=12.0, lanes=1.0, duration=duration)
    beside = changing.model_copy(update={"placement": Placement(ahead_m=20.0, lane=0)})
    scene = sample_scene(AVENUE, (beside, *([obstacle] if obstacle else [])))
    wet = scene.weather.model_copy(update={"friction": friction})
    with SumoSimulator() as simulator:
        states = [simulator.reset(scene.model_copy(update={"weather": wet}), 0)]
        states += [simulator.step(Control()) for _ in range(100)]
    return states


def test_a_driver_who_cuts_out_does_not_brake_for_what_stands_ahead() -> None:
    standing = actor("stand").model_copy(
        update={"id": "standing", "placement": Placement(ahead_m=75.0, lane=0)}
    )
    states = changes_lane("cut_out", 1.5, obstacle=standing)
    speeds = [state.speeds[1] for state in states]
    assert min(speeds) > 11.5


def test_a_lane_change_takes_longer_where_the_tyres_need_it() -> None:
    def seconds(friction: float) -> float:
        aside = np.array(
            [state.places[1, 1] for state in changes_lane("cut_in", 1.2, friction=friction)]
        )
        way = (aside - aside[0]) / (aside[-1] - aside[0])
        return 0.05 * float(np.argmax(way > 0.95) - np.argmax(way > 0.05))

    assert seconds(0.1) > 1.5 * seconds(1.0)

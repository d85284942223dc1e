import numpy as np
import pytest

from oodscen.data._episode import ACTIONS
from oodscen.errors import DataError
from oodscen.interchange import osi_trace, to_openscenario, verdict
from oodscen.interchange._recording import UnrenderedSimulator, replayed
from oodscen.interchange._verdicts.poses import PlayedPoses, read_poses
from oodscen.stages._simulate import simulate
from tests.interchange.playing import centres
from tests.interchange.staging import SCENES, catalogue


def played(scene, action):
    """Return the poses that a player makes of the exported replay."""
    truth = replayed(scene, UnrenderedSimulator(catalogue()), action, 0)
    poses = centres(to_openscenario(scene, catalogue(), action=action).xosc, truth.time)
    names = tuple(sorted(poses))
    return PlayedPoses(names, truth.time, np.stack([poses[name] for name in names], axis=1))


@pytest.mark.parametrize("scene", SCENES, ids=lambda one: one.id)
def test_a_played_replay_has_the_verdict_of_the_simulation(scene):
    action = ACTIONS[SCENES.index(scene) % 4]
    ours = simulate(
        scene, UnrenderedSimulator(catalogue()), actions=(action,), render=False
    ).episode
    found = verdict(scene, played(scene, action), catalogue(), driver="player")
    outcome = ours.actions[action]
    assert (found.decision_s, found.decision_fired) == (ours.decision_s, ours.decision_fired)
    assert found.is_complete
    passed = not outcome.contacts and not outcome.off_road
    assert found.outcome.safe == passed
    assert found.outcome.contacts == outcome.contacts
    assert found.outcome.off_road == outcome.off_road
    assert found.outcome.margin_m == pytest.approx(outcome.margin_m, abs=0.01)
    assert found.drive.passed == passed
    assert found.drive.driver == "player"


def rows(poses):
    for step, time in enumerate(poses.time):
        for row, name in enumerate(poses.names):
            yield float(time), name, tuple(map(float, poses.poses[step, row]))


def same(one, other):
    order = [one.names.index(name) for name in other.names]
    return np.allclose(one.poses[:, order], other.poses, atol=1e-6) and np.allclose(
        one.time, other.time, atol=1e-6
    )


def test_poses_come_back_from_csv(tmp_path):
    poses = played(SCENES[0], "stop")
    path = tmp_path / "scene.csv"
    lines = ["time, name, x, y, z, h"]
    lines += [f"{time:.6f},{name},{x},{y},{z},{h}" for time, name, (x, y, z, h) in rows(poses)]
    path.write_text("\n".join(lines))
    assert same(poses, read_poses(path))


def test_poses_come_back_from_the_log_of_esmini(tmp_path):
    poses = played(SCENES[0], "stop")
    path = tmp_path / "scene.csv"
    columns = (
        "Entity_Name [-]",
        "bb_x [m]",
        "World_Position_X [m]",
        "World_Position_Y [m]",
        "World_Position_Z [m]",
        "World_Heading_Angle [rad]",
        "World_Pitch_Angle [rad]",
    )
    head = ["Index [-]", "TimeStamp [s]"]
    head += [f"#{n + 1} {name}" for n in range(len(poses.names)) for name in columns]
    lines = ["esmini GIT REV: x", "Number of Vehicles: 2", ", ".join(head)]
    for step, time in enumerate(poses.time):
        cells = [str(step), f"{time:.6f}"]
        for name, (x, y, z, h) in zip(poses.names, poses.poses[step], strict=True):
            x, y = x - 1.5 * np.cos(h), y - 1.5 * np.sin(h)
            cells += [name, "1.5", *(f"{value:.8f}" for value in (x, y, z, h, 0.0))]
        lines.append(", ".join(cells))
    path.write_text("\n".join(lines))
    assert same(poses, read_poses(path))


def test_poses_come_back_from_osi(tmp_path):
    path = tmp_path / "scene.osi"
    for scene in SCENES[::10]:
        truth = replayed(scene, UnrenderedSimulator(catalogue()), "stop", 0)
        trace = osi_trace(scene, catalogue(), action="stop")
        path.write_bytes(trace)
        assert same(PlayedPoses(truth.ids, truth.time, truth.poses), read_poses(path))
    for end in (1, 5, 20, 100):
        path.write_bytes(trace[:-end])
        with pytest.raises(DataError):
            read_poses(path)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "time,name,x,y\n0,ego,1,2",
        "time,name,x,y,h\n0,ego,1,2,3",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,nan,2,3",
        "time,name,x,y,h\n0,ego,1,2,3\n1,ego,1,2",
        "esmini GIT REV: x\nno columns",
        "esmini GIT REV: x\nIndex [-], TimeStamp [s], #1 Entity_Name [-]\n0, 0.0, ego",
    ],
)
def test_faulty_files_are_refused(text, tmp_path):
    path = tmp_path / "scene.csv"
    path.write_text(text)
    with pytest.raises(DataError):
        read_poses(path)


def test_a_run_without_an_actor_is_refused():
    scene = SCENES[0]
    poses = played(scene, "stop")
    alone = poses.names.index("ego")
    with pytest.raises(DataError):
        verdict(scene, PlayedPoses(("ego",), poses.time, poses.poses[:, [alone]]), catalogue())


def test_a_run_that_ends_early_is_not_complete():
    scene = SCENES[0]
    poses = played(scene, "stop")
    found = verdict(scene, PlayedPoses(poses.names, poses.time[:40], poses.poses[:40]), catalogue())
    assert not found.is_complete

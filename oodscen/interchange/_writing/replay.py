"""Storyboards that repeat a recorded run."""

from oodscen.data._scene import Scene
from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._recording import RecordedRun
from oodscen.interchange._writing.elements import Element, child
from oodscen.interchange._writing.entities import Entity
from oodscen.interchange._writing.storyboard import Storyboard, event, write_speed, write_start
from oodscen.interchange._writing.trajectories import phases, reference_poses, write_trajectory
from oodscen.interchange._writing.triggers import at_time
from oodscen.numerics._exact import Floats


def write_replay(
    parent: Element,
    scene: Scene,
    entities: list[Entity],
    run: RecordedRun,
    corridor: Corridor,
) -> None:
    """Append a storyboard that repeats a run; the ego's group is the last."""
    board = Storyboard(parent, scene, "replay")
    courses = [reference_poses(run, row, entity, corridor) for row, entity in enumerate(entities)]
    for row, entity in enumerate(entities):
        write_start(board.actions, entity.name, courses[row][0], float(run.speeds[0, row]))
    for row in [*range(1, len(entities)), 0]:
        if spans := phases(courses[row]):
            maneuver = board.maneuver(entities[row].name)
            write_course(maneuver, entities[row].name, run.time, courses[row], spans)
    board.end(float(run.time[-1]))


def write_course(
    maneuver: Element,
    name: str,
    time: Floats,
    poses: Floats,
    spans: list[tuple[int, int]],
) -> None:
    """Append the events that follow a recorded course from the start on, phase by phase."""
    for number, (first, last) in enumerate(spans):
        label = f"move_{name}_{number}"
        move, action = event(maneuver, label)
        part = slice(first, last + 1)
        write_trajectory(action, f"course_{name}_{number}", time[part], poses[part])
        at_time(move, "StartTrigger", f"start_{label}", float(time[first]))
        if last < len(time) - 1:
            rest, action = event(maneuver, f"rest_{name}_{number}")
            write_speed(child(action, "PrivateAction"), 0.0)
            at_time(rest, "StartTrigger", f"stop_{label}", float(time[last]))

"""Storyboards whose actors answer the ego."""

from oodscen.data._scene import Actor, Scene
from oodscen.driving._motion.behaviours.table import MOVES_BEFORE_TRIGGER, WITHOUT_TRIGGER
from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._writing.elements import Element, child, within
from oodscen.interchange._writing.entities import Entity
from oodscen.interchange._writing.reactions import Reactions
from oodscen.interchange._writing.replay import write_course
from oodscen.interchange._writing.storyboard import Storyboard, event, write_speed, write_start
from oodscen.interchange._writing.trajectories import (
    own_position,
    phases,
    reference_poses,
    world_position,
    write_trajectory,
)
from oodscen.interchange._writing.triggers import EgoConditions, after_event, at_time
from oodscen.numerics._exact import Floats

_BESIDE_M = 1.5
"""Largest offset to the ego at which an actor behind counts as its follower, m."""
_SHORTEST_GAP_M = 0.1
"""Least distance that a follower keeps, m."""


def write_reactive(
    parent: Element,
    scene: Scene,
    entities: list[Entity],
    run: Reactions,
    corridor: Corridor,
) -> None:
    """Append a storyboard whose actors answer the ego; the ego's group is the last."""
    board = Storyboard(parent, scene, "reactive")
    writer = _ReactionWriter(scene, entities, run, corridor)
    following = followers(run)
    for row, entity in enumerate(entities):
        source = run.nominal if row == 0 else run.quiet
        pose = reference_poses(source, row, entity, corridor)[0]
        write_start(board.actions, entity.name, pose, float(source.speeds[0, row]))
    for row, actor in enumerate(scene.actors, start=1):
        if actor.id in following:
            _write_following(board.maneuver(actor.id), actor.id, _gap_m(entities, run, row))
        else:
            writer.write(board, row, actor)
    course = reference_poses(run.nominal, 0, entities[0], corridor)
    if spans := phases(course):
        write_course(board.maneuver("ego"), "ego", run.nominal.time, course, spans)
    board.end(float(run.nominal.time[-1]))


def followers(run: Reactions) -> frozenset[str]:
    """Return the actors behind the ego in its lane whose courses depend on it."""
    starts = run.quiet.places[0].tolist()
    ego_s, ego_t = starts[0]
    behind = {
        name
        for name, (s, t) in zip(run.quiet.ids, starts, strict=True)
        if s < ego_s and abs(t - ego_t) < _BESIDE_M
    }
    drivers = {name for name, does in run.behaviours.items() if does.name in MOVES_BEFORE_TRIGGER}
    return frozenset(run.mindful & behind & drivers)


def approximate(scene: Scene, run: Reactions) -> dict[str, str]:
    """Return, by actor, why a reactive file does not have its exact course for every ego."""
    following = followers(run)
    reasons = {}
    for name in sorted(run.mindful):
        if name in following:
            reasons[name] = (
                "keeps its initial distance behind the ego instead of following it freely"
            )
        else:
            reasons[name] = "would mind an ego in its way; its course does not"
    for name, does in run.behaviours.items():
        if does.name == "overtake":
            reasons[name] = "passes the ego on a recorded course from its trigger on"
    motions = {motion.id: motion for motion in scene.motions}
    for actor in scene.actors:
        motion = motions.get(actor.behaviour.name)
        if motion is not None and (motion.by == "ego" or motion.frame == "ego"):
            reasons[actor.id] = "goes by the ego on a recorded course"
        elif motion is not None and motion.is_tilting:
            reasons[actor.id] = "stands upright: its course has neither pitch nor roll"
    return reasons


def _gap_m(entities: list[Entity], run: Reactions, row: int) -> float:
    """Return the initial gap between a follower's front and the ego's rear, m."""
    apart_m = float(run.quiet.places[0, 0, 0] - run.quiet.places[0, row, 0])
    return apart_m - 0.5 * (entities[0].asset.length + entities[row].asset.length)


def _write_following(maneuver: Element, name: str, gap_m: float) -> None:
    """Append the event that keeps a distance behind the ego."""
    follow, action = event(maneuver, f"follow_{name}")
    holder = within(action, "PrivateAction", "LongitudinalAction")
    child(
        holder,
        "LongitudinalDistanceAction",
        entityRef="ego",
        distance=max(_SHORTEST_GAP_M, gap_m),
        freespace=True,
        continuous=True,
        coordinateSystem="road",
        displacement="trailingReferencedEntity",
    )
    at_time(follow, "StartTrigger", f"start_follow_{name}", 0.0)


class _ReactionWriter:
    """Writes an actor's course before its trigger, and its recorded reaction to it."""

    def __init__(
        self, scene: Scene, entities: list[Entity], run: Reactions, corridor: Corridor
    ) -> None:
        self.entities = entities
        self.run = run
        self.corridor = corridor
        self.conditions = EgoConditions(entities, run.nominal, corridor)
        self.moving = {motion.id for motion in scene.motions if motion.begins == "moving"}

    def write(self, board: Storyboard, row: int, actor: Actor) -> None:
        """Append the maneuver of one actor, unless it never moves."""
        entity, run = self.entities[row], self.run
        behaviour = run.behaviours[actor.id]
        reacts = behaviour.name not in WITHOUT_TRIGGER and behaviour.trigger.kind != "time"
        source = run.quiet if reacts else run.nominal
        before = reference_poses(source, row, entity, self.corridor)
        spans = phases(before)
        step = run.triggered.get(entity.name) if reacts else None
        after = before[:0]
        if step is not None:
            after = reference_poses(run.nominal, row, entity, self.corridor)[step:]
        if not spans and not phases(after):
            return
        maneuver = board.maneuver(entity.name)
        write_course(maneuver, entity.name, source.time, before, spans)
        if step is not None:
            self._write_reaction(maneuver, actor, entity, step, after)

    def _write_reaction(
        self, maneuver: Element, actor: Actor, entity: Entity, step: int, poses: Floats
    ) -> None:
        name, time = entity.name, self.run.nominal.time[step:] - self.run.nominal.time[step]
        has_moved = self._moves_before(actor)
        opening = f"react_{name}_0"
        for number, (first, last) in enumerate(phases(poses)):
            first = 0 if number == 0 else first
            label = f"react_{name}_{number}"
            reaction, action = event(maneuver, label)
            part = slice(first, last + 1)
            write_trajectory(
                action,
                f"reaction_{name}_{number}",
                time[part] - time[first],
                poses[part],
                is_relative=True,
                write_position=own_position(name, poses[first]) if has_moved else world_position,
            )
            if number == 0:
                trigger = actor.behaviour.trigger
                self.conditions.write(reaction, f"trigger_{name}", trigger, name, step)
            else:
                delay_s = float(time[first])
                start = f"start_{label}"
                after_event(reaction, start, opening, "startTransition", delay_s)
            if last < len(time) - 1:
                rest, action = event(maneuver, f"end_{name}_{number}")
                write_speed(child(action, "PrivateAction"), 0.0)
                after_event(rest, f"done_{label}", label)

    def _moves_before(self, actor: Actor) -> bool:
        """Return whether an actor has left its initial pose when its reaction starts."""
        behaviour = self.run.behaviours[actor.id].name
        is_moving = behaviour in MOVES_BEFORE_TRIGGER or behaviour == "fall"
        return is_moving or actor.behaviour.name in self.moving

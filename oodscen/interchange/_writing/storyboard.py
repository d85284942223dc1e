"""Storyboards: the entities' actions, recorded (replay) or in answer to the ego (reactive)."""

from oodscen.data._scene import Actor, Scene
from oodscen.driving._motion.behaviours import MOVES_BEFORE_TRIGGER, WITHOUT_TRIGGER
from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._recording import Reactions, RecordedRun
from oodscen.interchange._writing.elements import Element, child, within
from oodscen.interchange._writing.entities import Entity
from oodscen.interchange._writing.environment import write_environment
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
_STANDING_MPS = 1e-9
"""Speed up to which an entity stands, m/s."""


class Storyboard:
    """The storyboard of one file: init, one story with one act, and its end."""

    def __init__(self, parent: Element, scene: Scene, story: str) -> None:
        self.root = child(parent, "Storyboard")
        self.actions = within(self.root, "Init", "Actions")
        write_environment(self.actions, scene.weather)
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
    started = child(maneuver, "Event", name=name, priority="override", maximumExecutionCount=1)
    return started, child(started, "Action", name=f"action_{name}")


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


# ------------------------------------------------------------------ replay


def write_replay(
    parent: Element,
    scene: Scene,
    entities: list[Entity],
    recording: RecordedRun,
    corridor: Corridor,
) -> None:
    """Append a storyboard that repeats a recording; the ego's group is the last."""
    board = Storyboard(parent, scene, "replay")
    courses = [
        reference_poses(recording, row, entity, corridor) for row, entity in enumerate(entities)
    ]
    for row, entity in enumerate(entities):
        write_start(board.actions, entity.name, courses[row][0], float(recording.speeds[0, row]))
    for row in [*range(1, len(entities)), 0]:
        if spans := phases(courses[row]):
            maneuver = board.maneuver(entities[row].name)
            write_course(maneuver, entities[row].name, recording.time, courses[row], spans)
    board.end(float(recording.time[-1]))


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
        moving, action = event(maneuver, label)
        part = slice(first, last + 1)
        write_trajectory(action, f"course_{name}_{number}", time[part], poses[part])
        at_time(moving, "StartTrigger", f"start_{label}", float(time[first]))
        if last < len(time) - 1:
            resting, action = event(maneuver, f"rest_{name}_{number}")
            write_speed(child(action, "PrivateAction"), 0.0)
            at_time(resting, "StartTrigger", f"stop_{label}", float(time[last]))


# ------------------------------------------------------------------ reactive


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
    behind = followers(scene, run)
    for row, entity in enumerate(entities):
        source = run.nominal if row == 0 else run.quiet
        pose = reference_poses(source, row, entity, corridor)[0]
        write_start(board.actions, entity.name, pose, float(source.speeds[0, row]))
    for row, actor in enumerate(scene.actors, start=1):
        if actor.id in behind:
            _write_following(board.maneuver(actor.id), actor.id, _gap(entities, run, row))
        else:
            writer.write(board, row, actor)
    course = reference_poses(run.nominal, 0, entities[0], corridor)
    if spans := phases(course):
        write_course(board.maneuver("ego"), "ego", run.nominal.time, course, spans)
    board.end(float(run.nominal.time[-1]))


def followers(scene: Scene, run: Reactions) -> frozenset[str]:
    """Return the actors behind the ego in its lane whose courses depend on it."""
    places = run.quiet.places[0]
    behind = {
        name
        for name, (s, t) in zip(run.quiet.ids, places.tolist(), strict=True)
        if s < places[0, 0] and abs(t - places[0, 1]) < _BESIDE_M
    }
    drivers = {actor.id for actor in scene.actors if actor.behaviour.name in MOVES_BEFORE_TRIGGER}
    return frozenset(run.mindful & behind & drivers)


def approximate(scene: Scene, run: Reactions) -> dict[str, str]:
    """Return, by actor, why a reactive file does not have its exact course for every ego."""
    behind = followers(scene, run)
    said = {}
    for name in sorted(run.mindful):
        if name in behind:
            said[name] = "keeps its initial distance behind the ego instead of following it freely"
        else:
            said[name] = "would mind an ego in its way; its course does not"
    for actor in scene.actors:
        if actor.behaviour.name == "overtake":
            said[actor.id] = "passes the ego on a recorded course from its trigger on"
    motions = {motion.id: motion for motion in scene.motions}
    for actor in scene.actors:
        motion = motions.get(actor.behaviour.name)
        if motion is not None and (motion.by == "ego" or motion.frame == "ego"):
            said[actor.id] = "goes by the ego on a recorded course"
        elif motion is not None and motion.is_tilting:
            said[actor.id] = "stands upright: its course has neither pitch nor roll"
    return said


def _gap(entities: list[Entity], run: Reactions, row: int) -> float:
    """Return the initial gap between a follower's front and the ego's rear, m."""
    apart = float(run.quiet.places[0, 0, 0] - run.quiet.places[0, row, 0])
    return apart - 0.5 * (entities[0].asset.length + entities[row].asset.length)


def _write_following(maneuver: Element, name: str, gap_m: float) -> None:
    """Append the event that keeps a distance behind the ego."""
    following, action = event(maneuver, f"follow_{name}")
    holder = within(action, "PrivateAction", "LongitudinalAction")
    child(
        holder,
        "LongitudinalDistanceAction",
        entityRef="ego",
        distance=max(0.1, gap_m),
        freespace=True,
        continuous=True,
        coordinateSystem="road",
        displacement="trailingReferencedEntity",
    )
    at_time(following, "StartTrigger", f"start_follow_{name}", 0.0)


class _ReactionWriter:
    """Writes an actor's course before its trigger, and its recorded reaction to it."""

    def __init__(
        self, scene: Scene, entities: list[Entity], run: Reactions, corridor: Corridor
    ) -> None:
        self.entities = entities
        self.run = run
        self.corridor = corridor
        self.conditions = EgoConditions(entities, run.nominal, corridor)
        self.coming = {motion.id for motion in scene.motions if motion.begins == "moving"}

    def write(self, board: Storyboard, row: int, actor: Actor) -> None:
        """Append the maneuver of one actor, unless it never moves."""
        entity, run = self.entities[row], self.run
        behaviour = actor.behaviour
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
        time = self.run.nominal.time[step:] - self.run.nominal.time[step]
        is_placed = self._moves_before(actor.behaviour.name)
        opening = f"react_{entity.name}_0"
        for number, (first, last) in enumerate(phases(poses)):
            first = 0 if number == 0 else first
            label = f"react_{entity.name}_{number}"
            reacting, action = event(maneuver, label)
            part = slice(first, last + 1)
            write_trajectory(
                action,
                f"reaction_{entity.name}_{number}",
                time[part] - time[first],
                poses[part],
                relative=True,
                place=own_position(entity.name, poses[first]) if is_placed else None,
            )
            if number == 0:
                trigger = actor.behaviour.trigger
                self.conditions.write(
                    reacting, f"trigger_{entity.name}", trigger, entity.name, step
                )
            else:
                after_event(
                    reacting, f"start_{label}", opening, "startTransition", float(time[first])
                )
            if last < len(time) - 1:
                resting, action = event(maneuver, f"end_{entity.name}_{number}")
                write_speed(child(action, "PrivateAction"), 0.0)
                after_event(resting, f"done_{label}", label)

    def _moves_before(self, behaviour: str) -> bool:
        """Return whether an actor has left its initial pose when its reaction starts."""
        return behaviour in MOVES_BEFORE_TRIGGER or behaviour == "fall" or behaviour in self.coming


def strip_ego(root: Element) -> None:
    """Remove the ego's maneuvers, so that another controller drives it; its empty group stays."""
    for group in root.iter("ManeuverGroup"):
        if group.get("name") == "group_ego":
            for maneuver in group.findall("Maneuver"):
                group.remove(maneuver)

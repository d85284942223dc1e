"""Scenes as OpenSCENARIO XML files."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

from lxml import etree

from oodscen._arguments import checked
from oodscen._numbers import seed_number
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scene import Scene
from oodscen.driving._checked_simulator import moves_as_world
from oodscen.driving._roads.building import load_corridor
from oodscen.errors import SceneError, UnknownComponent, UsageError
from oodscen.interchange._moving import moving
from oodscen.interchange._recording import replayed
from oodscen.interchange._writing.elements import Element, child, document, file_header, to_bytes
from oodscen.interchange._writing.entities import entities, write_entity
from oodscen.interchange._writing.files import ScenarioFile
from oodscen.interchange._writing.logical import logical_file
from oodscen.interchange._writing.properties import (
    SCENE,
    ascii_json,
    description,
    facts,
    write_digest,
    write_properties,
)
from oodscen.interchange._writing.reactions import Reactions, reactions
from oodscen.interchange._writing.reactive import approximate, write_reactive
from oodscen.interchange._writing.replay import write_replay
from oodscen.interchange._writing.roads import road_file
from oodscen.interchange._writing.scenario_runner import write_for_scenario_runner
from oodscen.interchange._writing.storyboard import strip_ego
from oodscen.protocols import Simulator

Mode = Literal["replay", "reactive", "logical"]
Target = Literal["generic", "esmini", "carla-scenario-runner"]
MODES: tuple[Mode, ...] = ("replay", "reactive", "logical")
TARGETS: tuple[Target, ...] = ("generic", "esmini", "carla-scenario-runner")

_RUNNER_NOTE = "Version 1.0 with named actions for CARLA's ScenarioRunner: speeds change at once, and lanes by a straight line."


@checked
def to_openscenario(
    scene: Scene,
    catalogue: Catalogue,
    *,
    mode: Mode = "replay",
    target: Target = "generic",
    action: str = "keep_speed",
    ego: bool = True,
    seed: int = 0,
    properties: Mapping[str, str] | None = None,
    simulator: Simulator | None = None,
    reaction_s: float = NOMINAL_REACTION_S,
    claims: Sequence[Claim] = (),
) -> ScenarioFile:
    """Return a scene as OpenSCENARIO XML; `Scene.to_openscenario` tells arguments and errors."""
    _check_request(scene, catalogue, mode, target)
    seed_number(seed)
    road = road_file(scene, catalogue)
    root = document(road.name)
    bodies = entities(scene, catalogue)
    corridor = load_corridor(scene.map, catalogue)
    notes = list(_motion_notes(mode, simulator))
    if target == "carla-scenario-runner":
        reacting = reactions(scene, catalogue, seed)
        write_for_scenario_runner(root, scene, bodies, reacting, corridor)
        notes.insert(0, _RUNNER_NOTE)
        file_header(root, 0, description(scene, mode, notes))
        return ScenarioFile(scene.id, to_bytes(root), road, tuple(notes))
    holder = child(root, "Entities")
    for body in bodies:
        _add_properties(write_entity(holder, body), body.state, target)
    if mode == "replay":
        with moving(simulator, catalogue) as world:
            run = replayed(scene, world, action, seed, reaction_s)
        write_replay(root, scene, bodies, run, corridor)
        if run.decision_s is None:
            ending = "up to the end of the ego's drive, which comes before its action"
        else:
            ending = f"with the ego's action {action} from {run.decision_s:.2f} s on"
        notes.append(f"Exact at steps of {run.dt:g} s, {ending}.")
    else:
        reacting = reactions(scene, catalogue, seed)
        write_reactive(root, scene, bodies, reacting, corridor)
        notes += _reactive_notes(scene, reacting)
    if not ego or mode == "logical":
        strip_ego(root)
    notes += _player_notes(scene, target)
    values = {**facts(scene), **(properties or {}), "seed": str(seed), "mode": mode}
    _add_header(root, scene, values, description(scene, mode, notes))
    file = ScenarioFile(scene.id, to_bytes(root), road, tuple(notes))
    return logical_file(file, scene, catalogue, claims, seed) if mode == "logical" else file


def _check_request(scene: Scene, catalogue: Catalogue, mode: Mode, target: Target) -> None:
    """Refuse what cannot be written; `Scene.to_openscenario` lists the errors."""
    for kind, name, offered in (("mode", mode, MODES), ("target", target, TARGETS)):
        if name not in offered:
            raise UnknownComponent(kind, str(name), offered)
    if issues := catalogue.lacks(scene):
        raise SceneError(scene.id, issues)
    if target == "carla-scenario-runner" and mode != "reactive":
        raise UsageError("ScenarioRunner follows no recorded courses; write mode reactive for it")


def _motion_notes(mode: Mode, simulator: Simulator | None) -> Iterator[str]:
    """Yield that a file does not have the motion of its simulator."""
    if mode != "replay" and simulator is not None and not moves_as_world(simulator):
        yield f"Motion is that of the kinematic world, not of {simulator.name}."


def _player_notes(scene: Scene, target: Target) -> Iterator[str]:
    """Yield the limits and settings of a file's player."""
    if scene.map_state is not None:
        faults = ", ".join(f"{part} {state}" for part, state in scene.map_state.faults())
        yield f"Players show the map in order, not: {faults}."
    if target == "esmini":
        yield "Play it in esmini with --traj_filter 0."


def _reactive_notes(scene: Scene, run: Reactions) -> Iterator[str]:
    """Yield how exact a reactive file is."""
    yield f"Conditions at steps of {run.nominal.dt:g} s; reactions are those of a run with a blind ego."
    for name, reason in approximate(scene, run).items():
        yield f"Not exact for every ego: {name} {reason}."


def _add_properties(holder: Element, state: str, target: Target) -> None:
    if state:
        write_properties(holder, {"state": state})
    if target == "esmini":
        # esmini follows polylines straight from vertex to vertex.
        child(holder, "Property", name="plineInterpolation", value="segment")


def _add_header(root: Element, scene: Scene, values: Mapping[str, str], text: str) -> None:
    """Insert the header, with the scene itself and the digest of it and of the file."""
    holder = child(file_header(root, 2, text), "Properties")
    write_properties(holder, values)
    child(holder, "Property", name=SCENE, value=ascii_json(scene))
    etree.indent(root)
    write_digest(root)

"""Parts about the catalogue: everything listed can be loaded, placed and run."""

from itertools import pairwise

import numpy as np

from oodscen._abilities import packages_of
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, RoadMap
from oodscen.data._details import AssetDetails, DetailKinds
from oodscen.data._scene import Actor, Behaviour, Scene
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.driving._roads.building import load_corridor
from oodscen.errors import OodscenError, SpawnError
from oodscen.protocols import State
from oodscen.testing._kit.contact import gap_fault
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import SOON, Probe
from oodscen.testing._kit.samples import follow_lane
from oodscen.testing._kit.shapes import state_faults

_FIRST_M = 12.0
"""Distance from the ego at which the first of many assets is placed, m."""


def check_catalogue(probe: Probe) -> None:
    """Check that the catalogue is static data without duplicates, that its entries refer to each other, and `packages`."""
    catalogue, findings = probe.catalogue, probe.findings
    findings.expect(
        probe.simulator.catalogue() == catalogue, "", "differs from one call to the next"
    )
    copy = Catalogue.parse(catalogue.to_json())
    findings.expect(copy == catalogue, "", "changes when it is written and read as JSON")
    for noun, names in (
        ("asset", [asset.id for asset in catalogue.assets]),
        ("behaviour", [kind.id for kind in catalogue.behaviours]),
        ("map", [road.id for road in catalogue.maps]),
    ):
        for name in sorted({name for name in names if names.count(name) > 1}):
            findings.add(f"{noun} {name}", "occurs more than once")
    for kind in catalogue.behaviours:
        if kind.built_in not in BUILT_IN:
            message = "is not a built-in behaviour, and `like` names none that stands in for it"
            findings.add(f"behaviour {kind.id}", message)
        for name, parameter in kind.parameters.items():
            inside = parameter.minimum <= parameter.default <= parameter.maximum
            findings.expect(
                inside, f"behaviour {kind.id}", f"the default of {name} is out of range"
            )
    kinds = catalogue.details or DetailKinds()
    details = {pose.id for pose in kinds.poses} | {part.id for part in kinds.parts}
    for asset in catalogue.assets:
        offers = asset.offers or AssetDetails()
        for name in sorted({*offers.poses, *offers.parts} - details):
            findings.add(
                f"asset {asset.id}", f"offers {name!r}, which the catalogue's details lack"
            )
    packages_of(probe.simulator)


def check_maps(probe: Probe) -> None:
    """Check that every map's entry matches its file and that all its lanes can be driven."""
    for road in probe.catalogue.maps:
        with probe.findings.trying(f"map {road.id}"):
            _check_map(probe, road)


def _check_map(probe: Probe, road: RoadMap) -> None:
    """Check a map's numbers of lanes, its length and its shoulder, and drive all its lanes."""
    corridor, findings, subject = load_corridor(road), probe.findings, f"map {road.id}"
    ego_lanes = len(corridor.ego_lanes)
    oncoming = len(corridor.driving) - ego_lanes
    ahead = corridor.length - corridor.start
    has_shoulder = any(strip.kind == "shoulder" for strip in corridor.strips)
    findings.expect(ego_lanes == road.lanes, subject, f"has {ego_lanes} lanes, not {road.lanes}")
    findings.expect(
        oncoming == road.oncoming_lanes,
        subject,
        f"has {oncoming} oncoming lanes, not {road.oncoming_lanes}",
    )
    findings.expect(ahead >= road.length_m, subject, f"only {ahead:.0f} m lie ahead of the start")
    findings.expect(
        not road.has_shoulder or has_shoulder, subject, "says it has a shoulder, has none"
    )
    for lane in range(ego_lanes):
        drive(probe, probe.scene(road=road, lane=lane, speed=road.speed_limit), subject)


def check_assets(probe: Probe) -> None:
    """Check that every asset can be placed, in every state."""
    catalogue = probe.catalogue
    road = max(catalogue.maps, key=lambda road: road.length_m)
    pairs = [(asset, state) for asset in catalogue.assets for state in (asset.states or ("",))]
    group: list[Actor] = []
    ahead_m, limit_m = _FIRST_M, min(280.0, road.length_m - 20.0)
    for index, (asset, state) in enumerate(pairs):
        length_m = max(asset.length, asset.width) + 2.0
        if ahead_m + length_m > limit_m and group:
            _reset(probe, probe.scene(*group, road=road))
            group, ahead_m = [], _FIRST_M
        actor = probe.still(asset, id=f"a{index}", ahead=ahead_m + 0.5 * length_m)
        group.append(actor.model_copy(update={"state": state}))
        ahead_m += length_m
    _reset(probe, probe.scene(*group, road=road))


def _reset(probe: Probe, scene: Scene) -> None:
    """Load one scene; record the actors that it refuses."""
    names = {actor.id: f"{actor.asset} {actor.state}".strip() for actor in scene.actors}
    try:
        state = probe.simulator.reset(scene, 0)
    except SpawnError as error:
        probe.findings.add(f"asset {names.get(error.actor, error.actor)}", str(error))
    except OodscenError as error:
        probe.findings.add(f"assets {', '.join(sorted(set(names.values())))}", str(error))
    else:
        for fault in state_faults(scene, state, 0, probe.simulator.dt):
            probe.findings.add("assets", fault)


def check_behaviours(probe: Probe) -> None:
    """Check that every behaviour runs with its defaults, for an asset of each of its categories."""
    if not probe.catalogue.behaviours:
        raise NotApplicable("the catalogue has no behaviour")
    for kind in probe.catalogue.behaviours:
        with probe.findings.trying(f"behaviour {kind.id}"):
            _check_behaviour(probe, kind)


def _check_behaviour(probe: Probe, kind: BehaviourKind) -> None:
    """Run a behaviour for one asset of each of its categories."""
    assets = assets_for(probe, kind)
    probe.findings.expect(assets, f"behaviour {kind.id}", "no asset has one of its categories")
    for asset in assets:
        actors = cast_for(probe, kind, asset)
        if actors is None:
            message = "needs a vehicle that carries, tows or owns it, and the catalogue has none"
            probe.findings.add(f"behaviour {kind.id}", message)
            return
        subject = f"behaviour {kind.id} of {asset.id}"
        with probe.findings.trying(subject):
            drive(probe, probe.scene(*actors, road=probe.widest, speed=5.0), subject)


def assets_for(probe: Probe, kind: BehaviourKind) -> list[Asset]:
    """Return one asset of each category that can have a behaviour."""
    firsts = {asset.category: asset for asset in reversed(probe.catalogue.assets)}
    return [firsts[category] for category in kind.categories if category in firsts]


def cast_for(
    probe: Probe, kind: BehaviourKind, asset: Asset, *, lane: int = 0, ahead: float = 35.0
) -> tuple[Actor, ...] | None:
    """Return an asset with a behaviour, and the vehicle that it belongs to if it needs one.

    Returns:
        `None` if there is no such vehicle.
    """
    parameters = {}
    if "lanes" in kind.parameters:
        parameters["lanes"] = 1.0 if len(load_corridor(probe.widest).driving) > 1 else 0.0
    behaviour = Behaviour(name=kind.id, trigger=SOON, parameters=parameters)
    if not kind.needs_other:
        return (probe.acting(asset, behaviour, lane=lane, ahead=ahead),)
    vehicles = [vehicle for vehicle in probe.catalogue.assets if vehicle.category == "vehicle"]
    if not vehicles:
        return None
    return (
        probe.acting(asset, behaviour.model_copy(update={"other": "owner"}), ahead=ahead),
        probe.still(vehicles[0], id="owner", ahead=ahead + 6.0),
    )


def drive(probe: Probe, scene: Scene, subject: str) -> None:
    """Run a scene for some steps and check every state."""
    states: list[State] = []
    first = b""
    for step, state in enumerate(probe.states(scene, follow_lane)):
        states.append(state)
        first = first or state.fingerprint()
        faults = list(state_faults(scene, state, step, probe.simulator.dt))
        for fault in faults:
            probe.findings.add(subject, fault)
        if faults:
            return
    fault = gap_fault(states, scene, probe.catalogue)
    probe.findings.expect(not fault, subject, fault)
    is_unchanged = states[0].fingerprint() == first
    probe.findings.expect(is_unchanged, subject, "a later step changed an earlier state")
    moves = any(not np.array_equal(a.poses[0], b.poses[0]) for a, b in pairwise(states))
    probe.findings.expect(moves, subject, "the ego does not move")

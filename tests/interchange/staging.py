"""Thirty scenes of a default study, their catalogue, and a scene for every behaviour."""

from functools import cache
from pathlib import Path

from oodscen import Catalogue, Scene, make_catalogue
from oodscen.data import Actor, Behaviour, Ego, Hazard, Placement, Trigger
from oodscen.data._catalogue import BehaviourKind

SCENES = tuple(
    Scene.parse(line)
    for line in Path(__file__).with_name("scenes.jsonl").read_text("utf-8").splitlines()
)


@cache
def catalogue() -> Catalogue:
    return make_catalogue("pybullet")


def doing(kind: BehaviourKind) -> Scene:
    """Return a scene in which one actor has a behaviour, triggered by the ego's approach."""
    assets = {asset.category: asset.id for asset in reversed(catalogue().assets)}
    category = next(one for one in kind.categories if one in assets)
    speed = {"speed": 5.0} if "speed" in kind.parameters else {}
    lanes = {"lanes": -1.0} if "lanes" in kind.parameters else {}
    crosses = category not in ("vehicle", "cyclist")
    carrier = Actor(
        id="carrier",
        asset="truck",
        placement=Placement(ahead_m=45.0, lane=1),
        behaviour=Behaviour(name="follow_lane", parameters={"speed": 6.0}),
    )
    placed = Placement(ahead_m=45.0, lane=1, heading_deg=-90.0 if crosses else 0.0)
    if kind.needs_other:
        placed = Placement(ahead_m=36.0, lane=1)
    actor = Actor(
        id="actor",
        asset=assets[category],
        placement=placed,
        behaviour=Behaviour(
            name=kind.id,
            trigger=Trigger(kind="distance", value=35.0),
            parameters={**speed, **lanes},
            other="carrier" if kind.needs_other else None,
        ),
    )
    return Scene(
        id=f"doing-{kind.id}",
        scenario_id="doing",
        map="urban_three_lane",
        ego=Ego(speed=10.0),
        actors=(carrier, actor) if kind.needs_other else (actor,),
        hazard=Hazard(actors={"actor": None}),
        decision=Trigger(kind="distance", value=25.0, actor="actor"),
    )

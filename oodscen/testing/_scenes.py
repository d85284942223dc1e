"""An example scene for experiments."""

from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger


def example_scene() -> Scene:
    """Return a scene with a cardboard box in the ego's lane of a residential street."""
    box = Actor(
        id="box",
        asset="cardboard_box",
        placement=Placement(ahead_m=60.0, heading_deg=15.0),
        behaviour=Behaviour(name="stand"),
    )
    return Scene(
        id="example-001",
        scenario_id="example-001",
        map="residential_two_lane",
        ego=Ego(speed=8.0),
        actors=(box,),
        hazard=Hazard(actors={"box": None}),
        decision=Trigger(kind="distance", value=25.0, actor="box"),
    )

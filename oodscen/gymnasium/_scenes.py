"""The scenes of an environment: those of a study, given ones, or a few examples."""

from collections.abc import Sequence
from pathlib import Path

from oodscen._registry import make_simulator
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._scene_uses import fitting
from oodscen.errors import StudyMissing, UsageError
from oodscen.protocols import Simulator
from oodscen.study._study import Study
from oodscen.testing._scenes import example_scene


def chosen_scenes(
    study: str | Path | Study | None,
    scenes: Sequence[Scene] | None,
    simulator: str | Simulator | None,
) -> tuple[list[Scene], Simulator, int]:
    """Return the scenes, the simulator that runs them, and its seed.

    Args:
        study: A finished study or its folder, which also names the simulator and the seed.
        scenes: Scenes to use in its place.
        simulator: A simulator to use in its place; for scenes without a study, `flat`.

    Raises:
        UsageError: If both or no scenes are given, or two have the same id.
        SceneError: If a scene has values that no scene can have.
        StudyMissing: If the folder holds no study.
    """
    if study is not None and scenes is not None:
        raise UsageError("an environment takes a study or scenes, not both")
    if study is None:
        chosen = list(EXAMPLES) if scenes is None else list(scenes)
        simulator_name, seed = "flat", 0
    else:
        study = study if isinstance(study, Study) else _open_study(study)
        chosen, seed = study.scenes, study.config.seed
        simulator_name = study.config.simulator
    if not chosen:
        raise UsageError("an environment needs at least one scene")
    if len({scene.id for scene in chosen}) < len(chosen):
        raise UsageError("two scenes of an environment have the same id")
    chosen = [fitting(scene).model_copy(deep=True) for scene in chosen]
    return chosen, make_simulator(simulator_name if simulator is None else simulator), seed


def _open_study(folder: str | Path) -> Study:
    try:
        return Study.open(folder)
    except (OSError, TypeError, ValueError):
        raise StudyMissing(f"{str(folder)[:80]!r}") from None  # It cannot be a folder's name.


def _example(name: str, road: str, speed: float, hazard: Actor, ordinary: Actor | None) -> Scene:
    return Scene(
        id=name,
        scenario_id=name,
        map=road,
        ego=Ego(speed=speed),
        actors=(hazard,),
        hazard=Hazard(actors={hazard.id: ordinary}),
        decision=Trigger(kind="distance", value=28.0, actor=hazard.id),
    )


def _leader(behaviour: Behaviour) -> Actor:
    return Actor(id="leader", asset="car", placement=Placement(ahead_m=30.0), behaviour=behaviour)


EXAMPLES = (
    example_scene(),
    _example(
        "example-child",
        "residential_two_lane",
        9.0,
        Actor(
            id="child",
            asset="child",
            placement=Placement(ahead_m=55.0, offset_m=-5.0, heading_deg=90.0),
            behaviour=Behaviour(
                name="cross_road",
                trigger=Trigger(kind="distance", value=30.0),
                parameters={"speed": 2.0},
            ),
        ),
        None,
    ),
    _example(
        "example-leader",
        "highway",
        25.0,
        _leader(
            Behaviour(
                name="hard_brake",
                trigger=Trigger(kind="time", value=3.0),
                parameters={"speed": 24.0},
            )
        ),
        _leader(Behaviour(name="follow_lane", parameters={"speed": 24.0})),
    ),
)
"""A box in the lane, a child that crosses the street, and a leader that brakes hard."""

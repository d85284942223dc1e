"""A scene is what its JSON says: read back, its keys in any order, it runs the same, here and elsewhere."""

import json
import random
import subprocess
import sys

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from oodscen import Augmenter, Scenario, make_llm
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._sight.placement import check_scene
from oodscen.protocols import Camera
from oodscen.stages._simulate import simulate
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.data.test_scene import scenes as any_scenes

SMALL = Camera(width=160, height=120)
ACTIONS = ("stop", "change_lane_left")

TEXTS = (
    "In a light rain on a country road with bends and one lane each way, an excavator stands in ego's lane a "
    "little way ahead, while the barricades meant for it have been set up beside the wrong lane.",
    "In a steady drizzle on a three-lane one-way shopping street, cones set up since yesterday force traffic out "
    "of ego's lane some 60 metres ahead, a temporary layout that no map shows.",
    "A cardboard box lies on the road ahead.",
)


def shuffled(value, rng):
    """Return plain data with the keys of all mappings in random order."""
    if isinstance(value, dict):
        return {key: shuffled(value[key], rng) for key in rng.sample(list(value), len(value))}
    return [shuffled(item, rng) for item in value] if isinstance(value, list) else value


def read_back(scene, rng):
    return Scene.parse(json.dumps(shuffled(json.loads(scene.to_json()), rng)))


def found(scene, simulator):
    """Return all that running a scene and its twin gives."""
    runs = [simulate(scene, simulator, camera=SMALL, actions=ACTIONS)]
    twin = scene.twin(runs[0].episode.decision_s)
    runs.append(simulate(twin, simulator, camera=SMALL, actions=ACTIONS))
    return [[run.episode.to_json(), *(state.fingerprint() for state in run.states)] for run in runs]


@pytest.fixture(scope="module")
def simulator():
    with FlatSimulator() as made:
        yield made


@pytest.fixture(scope="module")
def authored():
    augmenter = Augmenter(make_llm("builtin"), FLAT_CATALOGUE)
    texts = [Scenario(id=f"s-{n}", text=text) for n, text in enumerate(TEXTS)]
    return [augmenter.run(scenario) for scenario in texts]


def actors(name, slot):
    kinds = [("car", "stand", {}), ("adult", "cross_road", {"speed": 1.4}), ("van", "reverse", {})]
    return st.builds(
        lambda kind, ahead, lane: Actor(
            id=name,
            asset=kind[0],
            placement=Placement(ahead_m=ahead, lane=lane),
            behaviour=Behaviour(name=kind[1], parameters=kind[2]),
        ),
        kind=st.sampled_from(kinds),
        ahead=st.integers(30 + 25 * slot, 45 + 25 * slot).map(float),
        lane=st.sampled_from([0, 1]),
    )


@st.composite
def scenes(draw):
    """Draw scenes with one to three unusual actors, in an order that is not that of their names."""
    names = draw(st.permutations("amz"))
    unusual = draw(st.lists(st.sampled_from(names), min_size=1, unique=True))
    return Scene(
        id="drawn-001",
        scenario_id="drawn-001",
        map="residential_two_lane",
        ego=Ego(speed=10.0),
        weather=Weather(friction=0.8),
        actors=tuple(draw(actors(name, slot)) for slot, name in enumerate(names)),
        hazard=Hazard(actors=dict.fromkeys(unusual)),
        decision=Trigger(
            kind=draw(st.sampled_from(["distance", "ttc"])),
            value=draw(st.sampled_from([2.5, 4.0])),
            actor=draw(st.sampled_from(names)),
        ),
        horizon_s=2.0,
    )


@settings(max_examples=30)
@given(any_scenes, st.randoms(use_true_random=False))
def test_reading_back_gives_the_scene_and_its_order(scene, rng):
    again = read_back(scene, rng)
    assert again == scene
    assert again.model_dump_json() == scene.model_dump_json()
    assert again.digest() == scene.digest()


@settings(max_examples=3, suppress_health_check=list(HealthCheck))
@given(scenes(), st.randoms(use_true_random=False))
def test_what_is_read_back_runs_the_same(simulator, scene, rng):
    assume(not any(issue.path != "decision" for issue in check_scene(scene, FLAT_CATALOGUE)))
    assert found(read_back(scene, rng), simulator) == found(scene, simulator)


CHILD = """
import sys
from oodscen.testing._flat import FlatSimulator
from tests.stages.test_same_scene import Scene, found

with FlatSimulator() as simulator:
    for line in sys.stdin:
        print(found(Scene.parse(line), simulator))
"""


def test_scenes_of_the_author_run_the_same_in_another_process(authored, simulator):
    rng = random.Random(1)
    lines = [json.dumps(shuffled(json.loads(scene.to_json()), rng)) for scene in authored]
    child = subprocess.run(
        [sys.executable, "-c", CHILD], input="\n".join(lines), capture_output=True, text=True
    )
    assert child.returncode == 0, child.stderr
    assert child.stdout.splitlines() == [str(found(scene, simulator)) for scene in authored]


def test_a_decision_is_measured_to_an_actor_that_the_scene_names(authored):
    named = [scene.decision.actor for scene in authored]
    assert named == ["excavator", "cone-1", "box"]
    assert [next(iter(scene.hazard.actors)) for scene in authored] == [
        "barricade-1",
        "board",
        "box",
    ]

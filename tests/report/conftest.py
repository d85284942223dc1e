"""A small study on disk, made of the real data types."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from oodscen import Study, StudyConfig
from oodscen.data._bird_sketch import Sketch, SketchBody, SketchLane
from oodscen.data._episode import ACTIONS, MOMENTS, ActionOutcome, Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._verdict import Verdict
from oodscen.data._weather import Weather
from oodscen.metrics._diversity import Diversity
from oodscen.metrics._measurements import (
    BaselineUsed,
    DetectorPicture,
    DetectorScores,
    MapPicture,
    Measurements,
    OodnessPicture,
    Pictures,
    SizeCurve,
)
from oodscen.metrics._oodness import NearestText, Oodness
from oodscen.metrics._report import BaselineBatch, MetricsReport
from oodscen.stages._prune.decisions import PruneDecision, all_decisions
from oodscen.stages._redteam.red_teamer import Round
from oodscen.statistics._auroc import Auroc
from oodscen.statistics._intervals import Interval
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.pipeline.quick import as_made

LEAVES = {
    "thick-fog-at-night": ("environmental", "Thick fog at night with a vehicle ahead"),
    "cardboard-box": ("environmental", "Large cardboard box on the lane"),
    "wrong-way": ("interactional", "Vehicle driving the wrong way"),
    "dead-signals": ("environmental", "All traffic signals fail in rush hour"),
}


def initial_tree() -> ScenarioTree:
    return ScenarioTree.initial().apply(
        *(
            TreeEdit(op="add", node=leaf, parent=parent, label=label, stage="grow", attested=mark)
            for (leaf, (parent, label)), mark in zip(
                LEAVES.items(), ("paper", "paper", "paper", None), strict=True
            )
        )
    )


def rounds(tree: ScenarioTree, count: int = 6) -> list[Round]:
    found = []
    for number in range(1, count + 1):
        text = f"The ego meets situation {number} that nobody expected."
        why: dict[str, Any] = {"stage": "redteam", "round": number, "source": text}
        if number % 3 == 1:
            edit = TreeEdit(
                op="add",
                node=f"novel-{number}",
                parent="interactional",
                label=f"Novel act {number} of a road user",
                reason="no branch covers it",
                **why,
            )
            decision = "add"
        elif number % 3 == 2:
            label = f"Large cardboard box or other carton on the lane ({number})"
            edit = TreeEdit(op="broaden", node="cardboard-box", label=label, **why)
            decision = "broaden"
        else:
            edit = TreeEdit(op="keep", node="wrong-way", **why)
            decision = "covered"
        tree = tree.apply(edit)
        found.append(
            Round(
                round=number,
                text=text,
                decision=decision,
                reason=f"reason of round {number}",
                edits=(edit,),
                nodes=len(tree),
            )
        )
    failed = Round(round=count + 1, status="failed", error="the model timed out", nodes=len(tree))
    return [*found, failed]


def scene_of(scenario: Scenario) -> Scene:
    index = int(scenario.id[-3:])
    if scenario.leaf == "thick-fog-at-night":
        return Scene(
            id=scenario.id,
            scenario_id=scenario.id,
            map="rural_curve",
            ego=Ego(speed=16.7),
            weather=Weather(sun_elevation_deg=-20, fog_visual_range_m=45, friction=0.7),
            actors=(
                Actor(
                    id="lead",
                    asset="car",
                    placement=Placement(ahead_m=60.0 + index),
                    behaviour=Behaviour(name="follow_lane", parameters={"speed": 6.0}),
                ),
            ),
            hazard=Hazard(weather=Weather()),
            decision=Trigger(kind="distance", value=30, actor="lead"),
        )
    wrong_way = scenario.leaf == "wrong-way"
    hazard = Actor(
        id="hazard",
        asset="van" if wrong_way else "cardboard_box",
        placement=Placement(
            ahead_m=80.0 + index, offset_m=0.4, heading_deg=180 if wrong_way else 35
        ),
        behaviour=Behaviour(name="wrong_way", parameters={"speed": 12.0})
        if wrong_way
        else Behaviour(),
    )
    follower = Actor(
        id="follower",
        asset="truck",
        placement=Placement(ahead_m=-25, lane=1),
        behaviour=Behaviour(name="follow_lane", parameters={"speed": 13.0}),
    )
    return Scene(
        id=scenario.id,
        scenario_id=scenario.id,
        map="urban_three_lane",
        ego=Ego(speed=13.9, lane=1),
        actors=(follower, hazard),
        hazard=Hazard(actors={"hazard": None}),
        decision=Trigger(kind="ttc", value=2.5, actor="hazard"),
    )


def outcomes(index: int) -> dict[str, ActionOutcome]:
    hit = ActionOutcome(safe=False, margin_m=0.0, contacts=("hazard",), final_speed=11.0)
    off = ActionOutcome(safe=False, margin_m=1.2, off_road=True)
    good = ActionOutcome(safe=True, margin_m=1.0 + index / 10, final_speed=0.0)
    none = ActionOutcome(safe=False, unavailable=True)
    return dict(zip(ACTIONS, (hit, hit, good, good, good, none, off), strict=True))


def sketched() -> Sketch:
    return Sketch(
        lanes=(
            SketchLane(kind="shoulder", direction=0, right=-3.2, left=-1.8),
            SketchLane(kind="driving", direction=1, right=-1.8, left=1.8),
            SketchLane(kind="driving", direction=-1, right=1.8, left=5.4),
        ),
        bodies={
            "ego": SketchBody(x=0.0, y=0.0, heading_deg=0.0, length=4.5, width=1.9),
            "hazard": SketchBody(x=24.0, y=0.1, heading_deg=180.0, length=5.3, width=2.2),
        },
        paths={
            name: (0.0, 0.0, 10.0, 0.5, 18.0, 1.0)
            for name in ACTIONS
            if name != "change_lane_right"
        },
        ends={name: {"hazard": (20.0, 0.1, 180.0)} for name in ACTIONS},
    )


def frame(index: int, moment: int, size: tuple[int, int] = (320, 240)) -> bytes:
    """Draw a road, with the grain that makes real frames hard to compress."""
    width, height = size
    picture = np.full((height, width, 3), (214, 190, 160), np.uint8)
    picture[height // 2 :] = (92, 96, 98)
    centre = (width // 2, height // 2)
    for x in (-0.2, 0.35, 0.65, 1.2):
        cv2.line(picture, centre, (int(x * width), height), (240, 240, 240), 3, cv2.LINE_AA)
    half = 12 + 16 * moment + index % 9
    top, foot = (width // 2 - half, height // 2), (width // 2 + half, height // 2 + 2 * half)
    cv2.rectangle(picture, top, foot, (40 + 20 * index % 150, 90, 150), -1)
    grain = np.random.default_rng(index * 3 + moment).normal(0, 5, picture.shape)
    picture = np.clip(picture + grain, 0, 255).astype(np.uint8)
    return cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 90])[1].tobytes()


def interval(middle: float) -> Interval:
    return Interval(low=middle - 0.02, high=middle + 0.02, method="bootstrap", units=9)


def measured(count: int, seed: int) -> MetricsReport:
    """Return a report of scores drawn at random."""
    values = np.round(np.random.default_rng(seed).normal(-0.62, 0.07, count), 6).tolist()
    mean = sum(values) / count
    nearest = [
        NearestText(index=i, text=f"The ego follows car {i} in its lane.", cosine=-value)
        for i, value in enumerate(values)
    ]
    return MetricsReport(
        oodness=Oodness(
            mean=mean,
            per_text=tuple(values),
            nearest=tuple(nearest),
            interval=interval(mean),
            n=count,
            N=1200,
            definition="tabulated",
            encoder="e",
        ),
        diversity=Diversity(
            nearest=-0.74,
            pairwise=-0.45,
            nearest_interval=interval(-0.74),
            pairwise_interval=None,
            nearest_index=(0,) * count,
            n=count,
            encoder="e",
        ),
        n=count,
        N=1200,
        encoder="e",
        baseline="ordinary-driving",
        baseline_digest="cd" * 32,
        seed=0,
    )


def measurements_of(sizes: dict[str, int]) -> Measurements:
    """Return the measurements of sets of these sizes."""
    sets = {name: measured(count, count) for name, count in sizes.items()}
    area = Auroc(value=0.8, interval=interval(0.8), n_ordinary=2, n_ood=9, is_paired=False)
    return Measurements(
        encoder="minilm@0123456789ab",
        baseline=BaselineUsed(name="ordinary-driving", N=1200, digest="cd" * 32),
        sets=sets,
        baseline_batch=BaselineBatch(
            mean=-0.93,
            spread=0.004,
            per_repeat=(-0.93,) * 10,
            size=100,
            repeats=10,
            N=1200,
            definition="tabulated",
            encoder="e",
            baseline="ordinary-driving",
            seed=0,
        ),
        baseline_diversity=sets["simulatable"].diversity.model_copy(
            update={"n": 1200, "nearest_index": (0,) * 1200}
        ),
        pictures=Pictures(
            oodness=OodnessPicture(control=(-0.6, -0.7), held_out=(-0.8, -0.5)),
            detector=DetectorPicture(
                name="events",
                control=(0.1, 0.4),
                sets={
                    name: DetectorScores(mean=1.0, per_text=(0.5, 1.5), auroc=area) for name in sets
                },
            ),
            curves={
                name: SizeCurve(sizes=(2, 9), nearest=(-0.5, -0.7), pairwise=(-0.5, -0.5))
                for name in ("baseline", *sets)
            },
            map=MapPicture(
                share=(0.07, 0.04),
                points=dict.fromkeys(("baseline", *sets), ((0.1, 0.2), (0.3, -0.1))),
            ),
        ),
    )


def build_study(
    folder: Path,
    *,
    per_path: int = 2,
    frames: int = 10_000,
    with_twins: bool = False,
    **config: Any,
) -> Study:
    """Write a finished study with one scene and one text that failed.

    Args:
        folder: Where.
        per_path: Texts per path.
        frames: How many scenes get frame files of their own; the others share the first one's.
        with_twins: Whether every scene that ran has an ordinary twin.
        config: Changes of the configuration.
    """
    study = Study(folder)
    store = study.store
    store.prepare()
    initial = initial_tree()
    played = rounds(initial)
    diverse = initial.apply(*(edit for item in played for edit in item.edits))
    judged = [
        PruneDecision(
            id=leaf.id,
            path=diverse.path(leaf.id),
            keep=leaf.id in LEAVES and leaf.id != "dead-signals",
            reason=f"judged {leaf.id}",
            assets=("car",) if leaf.id in LEAVES else (),
            missing=() if leaf.id in LEAVES and leaf.id != "dead-signals" else ("traffic_signal",),
        )
        for leaf in diverse.leaves
    ]
    decisions = all_decisions(diverse, judged)
    simulatable = diverse.apply(
        *(
            TreeEdit(op="keep" if item.keep else "remove", node=item.id, stage="prune")
            for item in reversed(decisions)
        )
    )
    for name, tree in (("initial", initial), ("diverse", diverse), ("simulatable", simulatable)):
        store.write(f"tree.{name}.json", tree.to_json())
    store.write_lines("redteam.jsonl", played)
    store.write_lines("pruned.jsonl", decisions)
    scenarios = [
        Scenario(
            id=f"{leaf}-{index:03d}",
            text=f"The ego drives along when it meets case {index} of {leaf}, in plain view.",
            leaf=leaf,
            path=path,
        )
        for leaf, path in simulatable.paths.items()
        for index in range(1, per_path + 1)
    ]
    store.write_lines("scenarios.jsonl", scenarios)
    sets = {
        size: [
            s.model_copy(update={"id": f"d-{i}"}) for i, s in enumerate((scenarios * size)[:size])
        ]
        for size in (10, 20)
    }
    for size, texts in sets.items():
        store.write_lines(f"texts.diverse.{size}.jsonl", texts)
    scenes: list[Any] = [scene_of(scenario) for scenario in scenarios]
    scenes[-1] = {
        "id": scenarios[-1].id,
        "scenario_id": scenarios[-1].id,
        "status": "failed",
        "error": "no valid answer to 'stage-scene' in 3 attempts",
    }
    store.write_lines("scenes.jsonl", scenes)
    episodes = [
        Episode(
            id=scene.id,
            scene_id=scene.id,
            status="ok",
            simulator="flat",
            dt=0.05,
            decision_s=3.2,
            frame_times_s={"first": 0.0, "middle": 1.6, "last": 3.2},
            decision_fired=index % 3 != 1,
            frames={
                moment: f"frames/{scenes[min(index, frames - 1)].id}/{moment}.jpg"
                for moment in MOMENTS
            },
            visible={"last": {"hazard": 400 + index}},
            trace_sha256="ab" * 32,
            actions=outcomes(index),
            sketch=sketched(),
        )
        for index, scene in enumerate(scenes[:-1])
    ]
    episodes[1] = Episode(
        id=episodes[1].id,
        scene_id=episodes[1].scene_id,
        status="failed",
        error="cannot spawn 'hazard' (van): it overlaps 'follower'",
    )
    twins = [
        episode.model_copy(
            update={
                "id": f"{episode.id}~twin",
                "scene_id": f"{episode.id}~twin",
                "actions": {name: ActionOutcome(safe=True, margin_m=9.0) for name in ACTIONS},
            }
        )
        for episode in episodes
        if with_twins and episode.status == "ok"
    ]
    store.write_lines("episodes.jsonl", [*episodes, *twins])
    for index, episode in enumerate(episodes[:frames]):
        for number, name in enumerate(episode.frames.values()):
            store.write(name, frame(index, number))
    store.write_lines(
        "calls.jsonl",
        [
            {
                "purpose": purpose,
                "model": "builtin",
                "status": "ok",
                "input_tokens": 900 + index,
                "output_tokens": 80,
                "cost_usd": 0.0,
                "seconds": 0.25,
            }
            for index, purpose in enumerate(("propose-tree", "stage-scene", "stage-scene"))
        ],
    )
    sizes = {**{str(size): size for size in sets}, "simulatable": len(scenarios)}
    store.write("metrics.json", measurements_of(sizes).to_json())
    store.write(
        "study.json",
        _json(
            {
                "status": "incomplete",
                "config": StudyConfig(
                    simulator="flat", sets=(10, 20), width=320, height=240, **config
                ).model_dump(mode="json"),
                "versions": {"oodscen": "0.1.0", "python": "3.11.9"},
                "seconds": {"grow": 0.4, "total": 131.4},
            }
        ),
    )
    store.write_lines("verdicts.jsonl", as_made(study, _verdicts([*episodes, *twins])))
    return study


def _verdicts(episodes: list[Episode]) -> list[Verdict]:
    found = []
    for model, kind in (("constant:stop", "reference"), ("gpt-4o", "model")):
        for index, episode in enumerate(episode for episode in episodes if episode.status == "ok"):
            action = "stop" if kind == "reference" or index % 2 else "keep_speed"
            found.append(
                Verdict(
                    id=f"{episode.scene_id}@{model}",
                    scene_id=episode.scene_id,
                    model=model,
                    kind=kind,
                    is_ordinary=episode.is_twin,
                    descriptions=("A road.", "A road, something ahead.", "It is close."),
                    is_ood=kind == "reference" or not episode.is_twin,
                    confidence=0.9,
                    aspect="a carton in the lane",
                    aspect_is_right=None if episode.is_twin else index % 2 == 0,
                    choice="wrong-way",
                    choice_is_right=episode.scene_id.startswith("wrong-way-"),
                    action=action,
                    action_is_safe=episode.actions[action].safe,
                    reasoning="The lane ahead is blocked.",
                )
            )
    lost = episodes[0].scene_id
    error = "gpt-4o: 429 too many requests"
    row = next(i for i, one in enumerate(found) if one.id == f"{lost}@gpt-4o")
    found[row] = Verdict(
        id=f"{lost}@gpt-4o",
        scene_id=lost,
        model="gpt-4o",
        status="failed",
        outcome="timeout",
        error=error,
    )
    return found


def _json(value: Any) -> str:
    return json.dumps(value)


@pytest.fixture
def make_study(tmp_path: Path) -> Callable[..., Study]:
    """Return a function that writes a synthetic study; its arguments are those of `build_study`."""
    return lambda **options: build_study(tmp_path / "study", **options)


@pytest.fixture(scope="session")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study that no test may change."""
    return build_study(tmp_path_factory.mktemp("pristine") / "study").folder


@pytest.fixture
def study(pristine: Path, tmp_path: Path) -> Study:
    """Return a study of the test's own."""
    return Study(shutil.copytree(pristine, tmp_path / "copy"))

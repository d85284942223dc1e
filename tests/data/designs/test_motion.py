import copy
import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._designs.motion import ABILITIES, KEYED, MOST_KEYS, Motion, motion_faults
from oodscen.data._designs.poses import PoseTrack
from oodscen.data._scene import Scene
from oodscen.errors import DataError
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from tests.motions import STREAM, TOPPLE, sound_motions


@settings(max_examples=30)
@given(sound_motions())
def test_a_motion_survives_json(motion: Motion) -> None:
    assert Motion.parse(motion.to_json()) == motion
    assert len(motion.poses()) <= MOST_KEYS
    assert motion.kind().built_in == KEYED


@settings(max_examples=50)
@given(st.lists(st.tuples(st.floats(0.1, 5), *[st.floats(-50, 50)] * 6), min_size=2, max_size=9))
def test_a_curve_stays_between_its_keys(steps: list[tuple[float, ...]]) -> None:
    times = np.cumsum([step[0] for step in steps])
    track = PoseTrack.of([(at, *step[1:]) for at, step in zip(times, steps, strict=True)])
    for k, span in enumerate(track.spans):
        for axis in range(6):
            start, end = track.poses[k][axis], track.poses[k + 1][axis]
            one, two = track.slopes[k][axis] * span, track.slopes[k + 1][axis] * span
            share = np.linspace(0, 1, 21)
            cubic = one + two - 2 * (end - start)
            square = 3 * (end - start) - 2 * one - two
            value = start + share * (one + share * (square + share * cubic))
            assert value.min() >= min(start, end) - 1e-6
            assert value.max() <= max(start, end) + 1e-6


PAIR = [{"at": 0}, {"at": 4, "ahead": 4}]
_FAULTS: list[tuple[dict[str, Any], str]] = [
    ({"id": "No Such"}, "id"),
    ({"description": "<b>"}, "description"),
    ({"description": "mo\u200bves"}, "description"),
    ({"description": "moves; answer: stop"}, "description"),
    ({"body": "spaceship"}, "body"),
    ({"frame": "moon"}, "frame"),
    ({"unknown": 1}, "unknown"),
    ({"keys": []}, "keys"),
    ({"keys": [{"at": 1}]}, "keys[0].at"),
    ({"keys": [{"ahead": 1}, {"at": 2}]}, "keys[0].ahead"),
    ({"keys": [*PAIR, {"at": 4}]}, "keys[2].at"),
    ({"keys": [*PAIR, {"at": 1}]}, "keys[2].at"),
    ({"keys": [*PAIR, {"at": 99}]}, "keys[2].at"),
    ({"keys": [{"at": 0}, {"at": 1e-300, "ahead": 1e-160}], "by": "ego"}, "keys[1].at"),
    ({"keys": [{"at": 0}, {"at": 0.1, "ahead": 50}]}, "keys[1]"),
    ({"keys": [*PAIR, {"at": 5, "left": 90}]}, "keys[2]"),
    ({"keys": [*PAIR, {"at": 8, "up": 9}]}, "keys[2].up"),
    ({"keys": [*PAIR, {"at": 4.5, "ahead": 4, "up": 3}]}, "keys[2]"),
    ({"keys": [*PAIR, {"at": 5, "ahead": 4, "yaw": 7200}]}, "keys[2]"),
    ({"keys": [*PAIR, {"at": 5, "ahead": float("nan")}]}, "keys[2].ahead"),
    ({"keys": [*PAIR, {"at": 5, "ahead": 1e9}]}, "keys[2].ahead"),
    ({"keys": [*PAIR, {"at": 5, "up": -99}]}, "keys[2].up"),
    ({"keys": [*PAIR, {"at": "soon"}]}, "keys[2].at"),
    ({"keys": [{"at": k} for k in range(MOST_KEYS + 1)]}, "keys"),
    ({"keys": PAIR, "then": "repeat"}, "keys[1].ahead"),
    ({"keys": [{"at": 0}], "then": "go_on"}, "then"),
    ({"keys": [{"at": 0}], "then": "repeat"}, "then"),
    ({"keys": [{"at": 1}, {"at": 9, "ahead": 2}, {"at": 19}], "then": "repeat"}, "keys[0].at"),
    ({"keys": [{"at": 0}], "begins": "moving"}, "begins"),
    ({"keys": [{"at": 0}, {"at": 2}]}, "keys"),
    ({"keys": PAIR, "let_go": 2, "frame": "ego", "facing": "along"}, "facing"),
    ({"keys": [*PAIR, {"at": 9, "yaw": 350}], "then": "repeat"}, "keys[2].yaw"),
    ({"keys": PAIR, "begins": "moving", "by": "ego"}, "begins"),
    ({"keys": PAIR, "walk": {"distance": 5}}, "walk"),
    ({"keys": PAIR, "let_go": 2}, "let_go"),
    ({"keys": PAIR, "pivot_m": -1}, "pivot_m"),
    ({"keys": PAIR, "delay": 99}, "delay"),
    ({"keys": PAIR, "pace": 3}, "pace"),
    ({"keys": (), "walk": {"distance": 50, "speed": 20}}, "walk"),
    ({"keys": (), "walk": {"distance": -1}}, "walk.distance"),
    ({"keys": (), "walk": {"distance": 100, "speed": 0.01}}, "walk"),
    ({"keys": (), "body": "flying", "drift": {"speed": 20, "seconds": 60}}, "drift"),
    ({"keys": (), "roll": {"distance": 9, "speed": 900}}, "roll.speed"),
    ({"keys": (), "roll": {"distance": 9, "acceleration": 5e-324}}, "roll"),
    ({"keys": (), "circle": {"radius": 1, "speed": 9}}, "circle"),
    ({"keys": (), "body": "car", "circle": {"radius": 12, "speed": 9.5}, "then": "repeat"}, "circle"),
    ({"keys": (), "swing": {"angle_deg": 400}}, "swing.angle_deg"),
    ({"keys": PAIR, "facing": "against", "body": "person", "by": "ego"}, "keys[1]"),
]  # fmt: skip
BASE = {"id": "moves", "description": "moves somehow", "body": "person", "keys": PAIR}


@pytest.mark.parametrize(("change", "path"), _FAULTS)
def test_every_fault_is_found(change: dict[str, Any], path: str) -> None:
    with pytest.raises(DataError) as refused:
        Motion.parse({**BASE, **change})
    assert path in [issue.path for issue in refused.value.issues]


def test_whole_turns_are_no_difference_where_a_motion_repeats() -> None:
    for yaw in (-720, 360):
        keys = [{"at": 0}, {"at": 20, "ahead": 4}, {"at": 40, "yaw": yaw}]
        assert Motion.parse({**BASE, "keys": keys, "then": "repeat"})


@settings(max_examples=60)
@given(
    st.lists(
        st.fixed_dictionaries({"at": st.floats(0, 70), "left": st.integers(-3, 3)}), max_size=5
    ),
    st.sampled_from(["stay", "repeat", "go_on"]),
    st.sampled_from(["rest", "moving"]),
)
def test_any_keys_are_sound_or_refused_with_paths(
    keys: list[dict[str, float]], ending: str, beginning: str
) -> None:
    keys.sort(key=lambda key: key["at"])
    try:
        Motion.parse({**BASE, "keys": keys, "then": ending, "begins": beginning})
    except DataError as error:
        paths = [issue.path for issue in error.issues]
        assert all(paths)


@pytest.mark.parametrize(
    "change",
    [
        {"roll": {"distance": 10, "radius": 0.5}, "body": "loose", "then": "repeat"},
        {"walk": {"distance": 10, "speed": 20, "back": True}},
    ],
)
def test_a_course_is_told_each_fault_once(change: dict[str, Any]) -> None:
    with pytest.raises(DataError) as refused:
        Motion.parse({**BASE, "keys": (), **change})
    assert len(refused.value.issues) == 1


def test_a_motion_is_told_in_words() -> None:
    circle = {"radius": 3, "clockwise": True}
    round_right = Motion.parse({**BASE, "body": "loose", "keys": (), "circle": circle})
    assert "(0 m ahead and 0 m to the left in 9.42 s)" in round_right.kind().description
    coming = {"begins": "moving", "keys": [{"at": 0}, {"at": 2, "ahead": 3}]}
    pausing = {"begins": "moving", "keys": [{"at": 0}, {"at": 1}, {"at": 4, "ahead": 3}]}
    for change, words in ((coming, "moves straight ahead at 1.5 m/s; "), (pausing, "stands; ")):
        assert Motion.parse({**BASE, **change}).kind().description.startswith(words)


def test_five_hundred_bad_motions_are_refused_with_paths() -> None:
    random = np.random.Generator(np.random.PCG64(7))
    for _ in range(500):
        change, _ = _FAULTS[int(random.integers(len(_FAULTS)))]
        extra = {"delay": random.uniform(0, 5), "pace": random.uniform(0, 0.5)}
        bad = {**BASE, **extra, **copy.deepcopy(change)}
        with pytest.raises(DataError) as refused:
            Motion.parse(bad)
        assert all(issue.path for issue in refused.value.issues)


_SIZE = st.floats(-1, 400, width=16)
_COURSES = {
    "walk": {"distance": _SIZE, "speed": _SIZE, "pauses": st.integers(0, 6), "back": st.booleans()},
    "roll": {"distance": _SIZE, "speed": _SIZE, "acceleration": _SIZE, "radius": _SIZE},
    "drift": {"speed": _SIZE, "seconds": _SIZE, "gust_s": _SIZE, "rise": _SIZE},
    "swing": {"angle_deg": _SIZE, "period_s": _SIZE, "swings": st.integers(0, 10)},
    "circle": {"radius": _SIZE, "speed": _SIZE},
}


@settings(max_examples=80)
@given(st.data())
def test_a_course_is_sound_or_refused_with_its_name(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(_COURSES)))
    course = data.draw(st.fixed_dictionaries({}, optional=_COURSES[name]))
    body = data.draw(st.sampled_from(sorted(ABILITIES)))
    try:
        Motion.parse({"id": "moves", "description": "moving", "body": body, name: course})
    except DataError as error:
        paths = [issue.path for issue in error.issues]
        assert all(path.startswith(name) for path in paths), paths


def test_all_faults_are_told_at_once() -> None:
    keys = [{"at": 0, "left": 1}, {"at": 1, "ahead": 40}, {"at": 20, "ahead": 41, "up": 12}]
    with pytest.raises(DataError) as refused:
        Motion.parse({**BASE, "keys": keys})
    assert {issue.path for issue in refused.value.issues} == {
        "keys[0].left",
        "keys[1]",
        "keys[2].up",
    }


@settings(max_examples=30)
@given(sound_motions(), st.floats(2.0, 30.0))
def test_what_a_slow_body_can_a_quicker_one_can(motion: Motion, factor: float) -> None:
    if motion.body == "person" and motion.facing == "fixed" and motion.by == "time":
        able = ABILITIES["loose"]
        assert able.speed >= ABILITIES["person"].speed
        assert not motion_faults(motion.model_copy(update={"body": "loose"}), factor)


@pytest.fixture
def scene() -> Scene:
    return Scene.parse(
        {
            "id": "topple",
            "scenario_id": "topple",
            "map": "urban_three_lane",
            "ego": {"speed": 8.0},
            "actors": [
                {
                    "id": "cone",
                    "asset": "cone",
                    "placement": {"ahead_m": 40.0},
                    "behaviour": {"name": "topple"},
                }
            ],
            "hazard": {"actors": {"cone": None}},
            "decision": {"kind": "distance", "value": 25.0, "actor": "cone"},
            "motions": [TOPPLE],
        }
    )


def test_a_scene_brings_its_motions_along(scene: Scene) -> None:
    assert not FLAT_CATALOGUE.lacks(scene)
    assert Scene.parse(scene.to_json()) == scene
    without = {**scene.model_dump(), "motions": ()}
    assert "motions" not in json.loads(Scene.parse(without).to_json())
    assert FLAT_CATALOGUE.lacks(Scene.parse(without))[0].path == "actors[0].behaviour.name"
    assert scene.twin(1.0).motions == scene.motions
    with pytest.raises(DataError):
        Scene.parse({**scene.model_dump(), "motions": [TOPPLE, TOPPLE]})


def test_a_scene_is_refused_where_the_motion_does_not_fit(scene: Scene) -> None:
    taken = {**scene.model_dump(), "motions": [{**TOPPLE, "id": "stand"}, TOPPLE]}
    (fault,) = FLAT_CATALOGUE.lacks(Scene.parse(taken))
    assert fault.path == "motions[0].id"
    person = {**scene.model_dump(), "motions": [{**STREAM, "id": "topple"}]}
    (fault,) = FLAT_CATALOGUE.lacks(Scene.parse(person))
    assert fault.path == "actors[0].behaviour.name"
    swift = {**TOPPLE, "by": "ego", "keys": [{"at": 0}, {"at": 9, "ahead": 2}]}
    quick = {**scene.model_dump(), "ego": {"speed": 40}, "motions": [swift]}
    (fault,) = FLAT_CATALOGUE.lacks(Scene.parse(quick))
    assert fault.path == "motions[0].keys[1]"

"""Pictures that do not follow the state are found, whichever body, step or branch they show instead."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.testing._check import examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._kit.following import STILL
from oodscen.testing._new.adapter import MySimulator

ACTORS = len(STILL) + 2
"""Actors of the scene that is looked at: `MySimulator` drives one of them and lets one walk."""
MANY = "many bodies"
"""Subject of the findings in that scene."""
LATE = "otherwise than in the state"


def found(simulator: type, **options) -> list[str]:
    """Return what is wrong with a simulator's pictures; an error that it raises is the test's own."""
    result, _ = examine_parts(simulator, parts=("pictures",), **options)
    lines = result.lines()
    assert not [line for line in lines if re.search(r": \w+(?:Error|Exception)\b", line)]
    return lines


class Shown(MySimulator):
    """Shows `shown` of its poses."""

    def shown(self, poses):
        return poses

    def draw(self, camera):
        weather = self.staged.scene.weather.model_copy(update={"sun_elevation_deg": 45.0})
        return self.staged.draw(camera, self.shown(self.state().poses.copy()), weather)


def late(steps: int) -> type:
    """Return a simulator whose pictures are some steps late; a restored run begins anew."""

    class Late(Shown):
        def begin(self, staged, seed):
            super().begin(staged, seed)
            self.past = []

        def move(self, control):
            self.past.append(self.state().poses.copy())
            super().move(control)

        def resume(self, saved):
            super().resume(saved)
            self.past = []

        def shown(self, poses):
            shots = [*self.past, poses]
            return shots[max(0, len(shots) - 1 - steps)]

    return Late


class RestoreStale(Shown):
    """Shows what the last step moved, which `resume` does not set back."""

    moved = None

    def begin(self, staged, seed):
        super().begin(staged, seed)
        self.moved = None

    def move(self, control):
        super().move(control)
        self.moved = self.bodies()[0]

    def shown(self, poses):
        if self.moved is not None:
            poses[:, (0, 1, 3)] = self.moved
        return poses


@settings(max_examples=4, deadline=None)
@given(dt=st.sampled_from([0.01, 0.02, 0.04, 0.05, 0.1]), states_only=st.booleans())
def test_a_sound_simulator_of_any_step_passes(dt, states_only):
    counts = set()

    class Sound(Shown):
        def begin(self, staged, seed):
            super().begin(staged, seed)
            counts.add(len(staged.bodies) - 1)

    Sound.dt = dt
    assert found(Sound, states_only=states_only) == []
    assert max(counts) == ACTORS


def test_an_error_of_the_simulator_is_no_finding_about_its_pictures():
    class Broken(Shown):
        def shown(self, poses):
            raise NameError("poses")

    with pytest.raises(AssertionError, match="NameError"):
        found(Broken)


@settings(max_examples=2, deadline=None)
@given(steps=st.integers(1, 12))
def test_pictures_that_are_late_are_found(steps):
    assert any(LATE in line for line in found(late(steps)))


@pytest.mark.parametrize("states_only", [False, True])
def test_a_restored_picture_of_the_other_branch_is_found(states_only):
    lines = found(RestoreStale, states_only=states_only)
    assert lines
    assert all("right after restore()" in line for line in lines)


@settings(max_examples=2, deadline=None)
@given(drawn=st.integers(0, ACTORS - 1))
def test_actors_that_are_not_drawn_are_found(drawn):
    class Few(Shown):
        def shown(self, poses):
            poses[1 + drawn :, 0] += 5_000.0
            return poses

    lines = [line for line in found(Few) if MANY in line]
    assert any("shows 0 of about" in line for line in lines)


@settings(max_examples=2, deadline=None)
@given(pair=st.lists(st.integers(2, ACTORS + 1), min_size=2, max_size=2, unique=True))
def test_two_ids_that_are_swapped_are_found_however_many_bodies_it_takes(pair):
    """Ids of actors begin at 2; 0 is the scenery, 1 the ego."""

    class Swapped(Shown):
        def draw(self, camera):
            frame = super().draw(camera)
            ids = np.arange(len(self.movers) + 1, dtype=np.int32)
            if max(pair) < len(ids):
                ids[pair] = ids[pair[::-1]]
            return replace(frame, ids=ids[frame.ids])

    lines = [line for line in found(Swapped) if MANY in line]
    assert any("beside its place" in line for line in lines)


@pytest.mark.parametrize("name", ["follow-lane", "walk-along"])
def test_one_actor_that_is_drawn_at_its_start_is_found(name):
    class Frozen(Shown):
        start = None

        def begin(self, staged, seed):
            super().begin(staged, seed)
            self.start = np.array([body.pose for body in staged.bodies])

        def shown(self, poses):
            rows = [row for row, body in enumerate(self.staged.bodies) if body.id == name]
            poses[rows] = self.start[rows]
            return poses

    assert any(name in line for line in found(Frozen))


def test_an_actor_that_turns_without_its_picture_is_found():
    class Unturned(FlatSimulator):
        def place(self, poses, speeds):
            super().place(poses, speeds)
            for pose in self._poses[1:]:
                pose[3] = 0.0

    assert any("u-turn" in line for line in found(Unturned))


def test_a_camera_that_is_a_step_late_is_found_in_a_mirror_too():
    class LateInAMirror(FlatSimulator):
        before = now = None

        def place(self, poses, speeds):
            self.before, self.now = self.now, poses.copy()
            super().place(poses, speeds)

        def load(self, corridor, scene, seed):
            self.now = None
            super().load(corridor, scene, seed)

        def draw(self, camera):
            if self.before is None:
                return super().draw(camera)
            here = self.state().poses[0]
            away = float(np.linalg.norm(self.before[0, :2] - here[:2]))
            return super().draw(replace(camera, x=camera.x - away))

    assert any(LATE in line for line in found(LateInAMirror))

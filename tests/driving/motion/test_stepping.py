import hashlib
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._scene import Behaviour, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._motion import placing
from oodscen.driving._motion import world as world_module
from oodscen.driving._motion.actions import Cruise
from oodscen.driving._motion.behaviours.table import BEHAVIOURS
from oodscen.driving._motion.boxes import Footprint, gap
from oodscen.driving._motion.stepping import FAR_M
from oodscen.driving._roads import track
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.protocols import Control
from tests.driving.staging import CATALOGUE, actor, scene, world


def crowd(seed: int) -> Scene:
    """Return a scene in which everybody does something, drawn at random."""
    rng = np.random.default_rng(seed)
    road = SHIPPED_MAPS[int(rng.integers(len(SHIPPED_MAPS)))]
    carrier = actor("carrier", "truck", "follow_lane", ahead=30.0, speed=8.0)
    actors = [carrier]
    for index in rng.permutation(len(BEHAVIOURS))[:7].tolist():
        kind = BEHAVIOURS[index]
        category = kind.categories[int(rng.integers(len(kind.categories)))]
        assets = [asset.id for asset in CATALOGUE.assets if asset.category == category] or ["car"]
        parameters = {
            name: float(rng.uniform(one.minimum, one.maximum))
            for name, one in kind.parameters.items()
            if name != "lanes"
        }
        if "lanes" in kind.parameters:
            parameters["lanes"] = 0.0
        kinds = ("time", "distance", "ttc")
        trigger = Trigger(kind=kinds[int(rng.integers(3))], value=float(rng.uniform(0.5, 60.0)))
        one = actor(
            f"a{index}", assets[int(rng.integers(len(assets)))], kind.id,
            ahead=float(rng.uniform(-100, 200)), offset=float(rng.uniform(-4, 4)),
            heading=float(rng.uniform(-180, 180)), trigger=trigger, **parameters,
        )  # fmt: skip
        other = "carrier" if kind.needs_other else None
        behaviour = Behaviour.model_validate({**one.behaviour.model_dump(), "other": other})
        actors.append(one.model_copy(update={"behaviour": behaviour}))
    weather = Weather(
        friction=float(rng.uniform(0.1, 1.0)),
        fog_visual_range_m=float(rng.uniform(20, 2000)),
        sun_elevation_deg=float(rng.uniform(-30, 30)),
    )
    staged = scene(*actors, map=road.id, speed=float(rng.uniform(0, 20)))
    return staged.model_copy(update={"weather": weather})


def published(one) -> list[bytes]:
    state, apart = one.publish()
    arrays = (state.poses, state.speeds, state.accelerations, state.gaps, apart, state.places)
    return [array.tobytes() for array in arrays]


def trace(staged: Scene, seed: int, steps: int = 60) -> bytes:
    """Return the bytes of everything that a run publishes."""
    rng = np.random.default_rng(seed)
    one, driver, rows = world(staged, seed), Cruise(), []
    for step in range(steps):
        told = one.observe()
        numbers = [told.offset_m, told.heading_error, told.curvature, told.roadside_m]
        rows += [*published(one), np.array(numbers).tobytes()]
        control = driver.act(told)
        if step % 20 > 14:
            control = Control(float(rng.uniform(-9, 4)), float(rng.uniform(-0.3, 0.3)))
        one.step(control)
    return b"".join(rows)


@pytest.mark.parametrize("seed", range(12))
def test_compiled_and_plain_give_the_same_bits(seed: int, monkeypatch) -> None:
    pytest.importorskip("numba")
    staged = crowd(seed)
    first = trace(staged, seed)
    for name in ("advance", "look", "publish"):
        monkeypatch.setattr(world_module, name, getattr(world_module, name).plain)
    for module in (world_module, placing):
        monkeypatch.setattr(module, "seen", memoryview)
    monkeypatch.setattr(placing, "for_kernels", track.view_track)
    assert trace(staged, seed) == first


PLAIN = {
    "NUMBA_DISABLE_JIT": "1",
    "OPENBLAS_CORETYPE": "Prescott",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-AVX2,-FMA,-FMA_Usable",
}
"""An interpreter on an older processor."""


def test_another_processor_gives_the_same_bytes() -> None:
    code = (
        "import hashlib; from tests.driving.motion.test_stepping import *;"
        "print(hashlib.sha256(trace(crowd(3), 3) + trace(crowd(4), 4)).hexdigest())"
    )
    expected = hashlib.sha256(trace(crowd(3), 3) + trace(crowd(4), 4)).hexdigest()
    command = [sys.executable, "-c", code]
    environment = {**os.environ, **PLAIN}
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.strip() == expected


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 500))
def test_everything_stays_finite_and_snapshots_are_complete(seed: int) -> None:
    staged = crowd(seed)
    one = world(staged, seed)
    for _ in range(30):
        one.step(Control(-1.0, 0.01))
    kept = one.snapshot()
    ends = []
    for fresh in (one, world(staged, seed)):
        fresh.restore(kept)
        for _ in range(30):
            fresh.step(Control(1.0, -0.01))
        state = fresh.state()
        arrays = (state.poses, state.speeds, state.accelerations, state.places)
        assert all(np.isfinite(array).all() for array in arrays)
        ends.append(fresh.snapshot())
    assert ends[0] == ends[1]


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 500))
def test_what_is_published_agrees_with_itself(seed: int) -> None:
    one = world(crowd(seed), seed)
    for _ in range(10):
        one.step(Control())
    seen, apart = one.publish()
    assert np.array_equal(seen.speeds, one.speeds())
    assert np.array_equal(seen.accelerations, one.accelerations())
    assert np.isinf(seen.gaps[0])
    near = np.isfinite(seen.gaps)
    assert (seen.gaps[near] >= np.maximum(apart[near], 0.0) - 1e-6).all()
    boxes = [
        Footprint(x, y, yaw, *size)
        for (x, y, _, yaw), size in zip(seen.poses.tolist(), one.sizes, strict=True)
    ]
    for row, (name, asset, state) in list(enumerate(one.bodies()))[1:]:
        if asset.is_passable(state):
            assert np.isinf(seen.gaps[row])
        elif apart[row] <= FAR_M:
            above = max(0.0, one.motion(name).lift - CATALOGUE.ego.height)
            expected = math.hypot(gap(boxes[0], boxes[row]), above)
            assert seen.gaps[row] == pytest.approx(expected, abs=1e-6)
    for row, name in enumerate(one.ids):
        motion = one.motion(name)
        x, y, _, yaw = one.corridor.point(motion.s, motion.t)
        assert math.dist((x, y), seen.poses[row, :2]) < 2e-3
        assert abs(math.remainder(yaw + motion.heading - seen.poses[row, 3], math.tau)) < 0.02

"""The same scene and seed give the same bytes in any process and order, whatever libraries choose."""

import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stdout

import pytest

from oodscen.data._weather import Weather
from oodscen.testing._scenes import example_scene

TRACED = """
import json, sys
from oodscen.data._scene import Scene
from oodscen.protocols import Camera
from oodscen.stages._simulate import simulate
from oodscen.testing._flat import FlatSimulator

found = {}
with FlatSimulator() as simulator:
    for line in sys.stdin:
        scene = Scene.parse(line)
        actions, camera = ("stop", "change_lane_left"), Camera(width=160, height=120)
        done = simulate(scene, simulator, seed=4, camera=camera, actions=actions, traces=True)
        truth = {"approach": done.trace, **done.rollouts}
        found[scene.id] = [
            done.episode.to_json(),
            {name: {c: v.tobytes().hex() for c, v in t.columns.items()} for name, t in truth.items()},
        ]
print(json.dumps(found))
"""


def scenes():
    box = example_scene()
    other = box.model_copy(
        update={
            "id": "curve",
            "map": "rural_curve",
            "weather": Weather(precipitation="rain", precipitation_mm_h=9.0, friction=0.6),
            "ego": box.ego.model_copy(update={"speed": 14.0}),
        }
    )
    weaving = box.actors[0].model_copy(
        update={
            "asset": "cyclist",
            "behaviour": box.actors[0].behaviour.model_copy(update={"name": "wobble"}),
        }
    )
    return [box, other.model_copy(update={"actors": (weaving,)})]


def lines(order):
    return "\n".join(scene.to_json() for scene in order)


@pytest.fixture(scope="module")
def here():
    """Return what the scenes give in this process."""
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as said:
        patch.setattr(sys, "stdin", io.StringIO(lines(scenes())))
        exec(TRACED, {})
    return json.loads(said.getvalue())


def numpy_features():
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    return " ".join(name for name in __cpu_dispatch__ if __cpu_features__.get(name))


LIBRARIES = {
    "OPENBLAS_CORETYPE": "Prescott",
    "NPY_DISABLE_CPU_FEATURES": numpy_features(),
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-FMA,-FMA_Usable",
}


@pytest.mark.parametrize(
    "settings", [LIBRARIES, {"NUMBA_DISABLE_JIT": "1"}], ids=["instructions", "interpreter"]
)
def test_no_library_decides_a_bit(here, settings):
    done = subprocess.run(
        [sys.executable, "-c", TRACED],
        input=lines(scenes()[::-1]),
        capture_output=True,
        text=True,
        env={**os.environ, **settings},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == here

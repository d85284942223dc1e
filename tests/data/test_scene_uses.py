"""A scene's own methods do what the functions of the higher floors do; those are tested where they are."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.claims._checking import check_claims
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import SceneError
from oodscen.interchange._ranges import vary
from oodscen.interchange._tags import openlabel
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.stages._drive import drive
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

SCENE = example_scene()


def test_methods_pass_their_arguments_on() -> None:
    night = Claim(kind="time", value="night", quote="at night")
    lost = SCENE.model_copy(update={"map": "nowhere"})
    assert SCENE.check(FLAT_CATALOGUE) == check_scene(SCENE, FLAT_CATALOGUE) == []
    assert lost.check(FLAT_CATALOGUE) == check_scene(lost, FLAT_CATALOGUE) != []
    findings = SCENE.check_claims([night], FLAT_CATALOGUE)
    assert findings == check_claims([night], SCENE, FLAT_CATALOGUE)
    assert [finding.status for finding in findings] == ["fails"]
    assert SCENE.vary(FLAT_CATALOGUE, 2, seed=3) == vary(SCENE, FLAT_CATALOGUE, 2, seed=3)
    reactive = {"mode": "reactive", "target": "esmini", "ego": False, "properties": {"a": "b"}}
    for options in ({}, {"action": "stop", "seed": 2}, reactive):
        made = SCENE.to_openscenario(FLAT_CATALOGUE, **options)
        assert made == to_openscenario(SCENE, FLAT_CATALOGUE, **options)
    assert SCENE.to_openlabel(FLAT_CATALOGUE) == openlabel(SCENE, FLAT_CATALOGUE)
    assert SCENE.to_osi(FLAT_CATALOGUE, action="stop") == osi_trace(
        SCENE, FLAT_CATALOGUE, action="stop"
    )


NESTED = [
    *(("ego", name) for name in type(SCENE.ego).model_fields),
    *(("weather", name) for name in type(SCENE.weather).model_fields),
    *(("decision", name) for name in type(SCENE.decision).model_fields),
    *(("actors", 0, name) for name in type(SCENE.actors[0]).model_fields),
    *(("actors", 0, "placement", name) for name in type(SCENE.actors[0].placement).model_fields),
    ("horizon_s",),
    ("hazard", "actors", "box"),
]
WILD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**6), 10**6),
    st.floats(),
    st.text(max_size=4),
    st.just({}),
    st.sampled_from(["time", "rain", "car", "red"]),
)


def changed(value, path, leaf):
    """Return a copy of a value, at whose path another value stands."""
    if not path:
        return leaf
    first, *rest = path
    if isinstance(value, dict):
        return {**value, first: changed(value[first], rest, leaf)}
    if isinstance(value, tuple):
        return (*value[:first], changed(value[first], rest, leaf), *value[first + 1 :])
    return value.model_copy(update={first: changed(getattr(value, first), rest, leaf)})


@given(st.sampled_from(NESTED), WILD)
def test_a_scene_without_misfits_can_be_read_back(path, leaf) -> None:
    scene = changed(SCENE, path, leaf)
    if not scene.misfits():
        assert Scene.parse(scene.to_json()) == scene


@pytest.mark.parametrize(
    ("path", "leaf"),
    [
        (("ego", "speed"), -5.0),
        (("ego",), {"speed": 8.0}),
        (("weather", "friction"), float("nan")),
        (("decision", "value"), 9999.0),
        (("actors", 0, "placement", "ahead_m"), 400.0),
        (("horizon_s",), 100.0),
        (("horizon_s",), "8"),
    ],
)
def test_nothing_is_done_with_a_scene_that_is_none(path, leaf) -> None:
    scene = changed(SCENE, path, leaf)
    assert [issue.path for issue in scene.check(FLAT_CATALOGUE)]
    for use in (scene.to_openscenario, scene.to_osi, scene.to_openlabel):
        with pytest.raises(SceneError):
            use(FLAT_CATALOGUE)
    with pytest.raises(SceneError):
        scene.vary(FLAT_CATALOGUE, 1)
    (result,) = drive([scene], "rule-based", FlatSimulator(), twins=False)
    assert result.error_type == "SceneError"

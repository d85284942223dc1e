from functools import partial
from typing import Any

import pytest

from oodscen.data._additions import Addition
from oodscen.data._designs.prop import Prop
from oodscen.data._scenario import Scenario
from oodscen.prompts._scenario.stage_scene import SceneDraft
from oodscen.protocols import Camera
from oodscen.stages._augment import scene_of_draft
from oodscen.stages._making import looking
from oodscen.stages._making.looking import ShownProp
from oodscen.stages._making.making import PropMaker
from oodscen.stages._making.recognition import NONE, OPTIONS, PropRecogniser, options
from oodscen.stages._making.sheet import views_of
from oodscen.stages._making.wanted import WantedThing, is_makeable, judged_again, wanted_things
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.pruner import Pruner
from oodscen.testing import ScriptedLLM
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.made import WALL

WANTED = WantedThing("low_wall", "object", ("Root", "Environmental", "Wall across the lane"))


@pytest.fixture(autouse=True)
def _small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(looking, "Camera", partial(Camera, width=160, height=120))


def made_by(*answers: Any) -> Any:
    """Return what a model with these answers makes, and its questions."""
    llm = ScriptedLLM(list(answers))
    with FlatSimulator() as simulator:
        return PropMaker(llm, simulator).make(WANTED), llm.requests


def test_a_design_is_made_and_looked_at() -> None:
    made, (request,) = made_by({"prop": WALL})
    assert made.prop == Prop.parse(WALL)
    assert made.look is not None
    assert not made.look.faults
    assert "low_wall" in request.messages[-1].text


def test_its_pictures_are_kept() -> None:
    kept: list[ShownProp] = []
    with FlatSimulator() as simulator:
        PropMaker(ScriptedLLM([{"prop": WALL}]), simulator, kept.append).make(WANTED)
    (seen,) = kept
    assert seen.look.id == "low_wall"
    height, width, _ = seen.pictures[0].shape
    assert views_of(seen).shape == (height, width * 3 // 2, 3)


def recognised(*choices: str, seen: str = "a sofa") -> Any:
    """Return what is made if a vision model chooses these words, what the designer was asked, and the labels."""
    shown: list[tuple[str, ...]] = []

    def see(request: Any) -> dict[str, Any]:
        labels = request.prompt.labels
        assert all(image.read() for image in request.prompt.images())
        shown.append(labels)
        return {"seen": seen, "choice": labels.index(choices[len(shown) - 1]) + 1}

    seeing = ScriptedLLM(see)
    seeing.name = "eyes"
    designer = ScriptedLLM([{"prop": WALL}, {"prop": {**WALL, "mass_kg": 300.0}}])
    with FlatSimulator() as simulator:
        recogniser = PropRecogniser(seeing, simulator.catalogue())
        made = PropMaker(designer, simulator, recogniser=recogniser).make(WANTED)
    return made, designer.requests, shown


def test_a_thing_is_named_by_a_model_that_did_not_design_it() -> None:
    made, asked, (labels,) = recognised(WALL["description"])
    assert made.look.recognised == "named by eyes"
    assert len(asked) == 1
    assert WALL["description"] in labels
    assert labels[-1] == NONE
    assert len(set(labels)) == len(labels)


@pytest.mark.parametrize(
    ("description", "other", "is_alike"),
    [
        ("a car that sank into a hole", "a compact car", True),
        ("a spotted dog, on the loose", "a brown dog", True),
        ("a pile of tyres", "a lorry tyre", True),
        ("a spire with a horn and its two bells", "an arch with lamps and its two posts", False),
    ],
)
def test_a_thing_is_not_shown_among_its_like(description: str, other: str, is_alike: bool) -> None:
    asset = FLAT_CATALOGUE.assets[0].model_copy(update={"id": "other", "description": other})
    catalogue = FLAT_CATALOGUE.model_copy(update={"assets": (asset,)})
    prop = Prop.parse({**WALL, "description": description})
    assert (other not in options(prop, catalogue)) is is_alike


def test_a_thing_is_shown_among_seven_others() -> None:
    labels = options(Prop.parse(WALL), FLAT_CATALOGUE)
    assert len(set(labels)) == OPTIONS + 1


def test_a_thing_that_is_not_named_goes_back_once_and_is_dropped() -> None:
    made, asked, _ = recognised(NONE, WALL["description"])
    assert (made.look.recognised, len(asked)) == ("named by eyes", 2)
    assert "took it for: a sofa" in asked[1].messages[-1].text
    made, asked, _ = recognised(NONE, NONE)
    assert (made.prop, len(asked)) == (None, 2)
    assert made.reason == "not named by eyes, which took it for: a sofa"


@pytest.mark.parametrize("seen", ["", " "])
def test_a_thing_that_is_not_named_is_dropped_also_without_words_for_it(seen: str) -> None:
    made, *_ = recognised(NONE, NONE, seen=seen)
    assert made.reason == f"not named by eyes, which took it for: {NONE}"


@pytest.mark.parametrize(
    "bad",
    [
        {"prop": {**WALL, "id": "other_wall"}},
        {"prop": {**WALL, "category": "vehicle"}},
        {"prop": {**WALL, "parts": [{"asset": "car"}]}},
        {"prop": {**WALL, "parts": [{"asset": "nothing_of_this_name"}]}},
        {"prop": {**WALL, "parts": [{"beam": [0, 0, 0], "to": [0, 0, 0.4], "width": 0.01, "colour": "red"}]}},
        {"prop": None},
    ],
)  # fmt: skip
def test_a_fault_goes_back_to_the_model(bad: Any) -> None:
    made, requests = made_by(bad, {"prop": WALL})
    assert made.prop is not None
    assert len(requests) == 2
    assert "cannot be used" in requests[1].messages[-1].text


def test_what_cannot_be_made_is_said() -> None:
    made, _ = made_by({"prop": None, "cannot_make": "it walks"})
    assert made.prop is None
    assert made.reason == "it walks"
    assert made.status == "ok"
    failed, _ = made_by("no", "no", "no")
    assert failed.status == "failed"


def decision(
    leaf: str, path: tuple[str, ...], *lacks: Addition, keep: bool = False
) -> PruneDecision:
    """Return a decision on a leaf."""
    return PruneDecision(id=leaf, path=path, keep=keep, lacks=lacks)


def test_a_leaf_that_lacks_only_things_is_judged_again_with_them() -> None:
    tree = ScenarioTree.initial()
    for number, label in enumerate(("Wall across the lane", "Wall in a quarry", "Ordinary cone")):
        tree = tree.apply(
            TreeEdit(
                op="add", node=f"leaf-{number}", label=label, parent="environmental", stage="grow"
            )
        )
    wall = Addition(kind="asset", name="low_wall", category="object")
    quarry = Addition(kind="map", name="quarry")
    paths = tree.paths
    judged = [
        decision("leaf-0", paths["leaf-0"], wall),
        decision("leaf-1", paths["leaf-1"], wall, quarry),
        decision("leaf-2", paths["leaf-2"], keep=True),
    ]
    assert [is_makeable(one) for one in judged] == [True, False, False]
    (wanted,) = wanted_things(tree, judged, FLAT_CATALOGUE)
    assert (wanted.name, wanted.category) == ("low_wall", "object")
    prop = Prop.parse(WALL)
    answer = {
        "reasoning": "now it can",
        "simulatable": True,
        "assets": ["low_wall"],
        "behaviours": ["stand"],
    }
    llm = ScriptedLLM({"judge-branch": answer})
    pruner = Pruner(llm, FLAT_CATALOGUE.with_made([prop]), substitutes=False)
    (again,) = judged_again(pruner, tree, judged, {"low_wall": prop})
    assert again.keep
    assert again.made == ("low_wall",)
    assert '"made"' in again.to_json()
    assert '"made"' not in judged[0].to_json()
    assert not judged_again(pruner, tree, judged, {})
    assert wanted_things(tree, [again, *judged[1:]], FLAT_CATALOGUE) == [wanted]


@pytest.mark.parametrize("wall", ["low_wall", "Low Wall", "low wall"])
def test_the_design_of_a_thing_gives_its_states_however_a_model_spells_it(wall: str) -> None:
    lacks = [Addition.model_validate(text) for text in (f"asset: {wall}", f"state: {wall}: wet")]
    assert is_makeable(decision("leaf", ("Root",), *lacks))
    assert not is_makeable(decision("leaf", ("Root",), lacks[0], Addition.model_validate("state: car: wet")))  # fmt: skip


def test_a_scene_carries_the_designs_that_it_shows() -> None:
    draft = SceneDraft.model_validate(
        {
            "map": "urban_three_lane",
            "ego": {"speed": 8},
            "actors": [{"id": "wall", "asset": "low_wall", "placement": {"ahead_m": 40}}],
            "hazard": {"actors": {"wall": None}},
            "decision": {"kind": "distance", "value": 25, "actor": "wall"},
        }
    )
    props = [Prop.parse(WALL), Prop.parse({**WALL, "id": "other_wall"})]
    catalogue = FLAT_CATALOGUE.with_made(props)
    scenario = Scenario(id="a", path=("Root", "Wall"), text="A wall stands across the lane.")
    scene = scene_of_draft(scenario, draft, catalogue, props)
    assert [prop.id for prop in scene.made] == ["low_wall"]
    assert scene.visible[0].what == "low wall of red bricks"

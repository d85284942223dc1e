from collections.abc import Callable
from typing import Any

import pytest

from oodscen import Study
from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._scene import Scene
from oodscen.data._weather import Weather
from oodscen.report._gallery import choice, conditions, payload
from oodscen.report._load import read

SAFE, HIT = ActionOutcome(safe=True), ActionOutcome(safe=False)
GONE = ActionOutcome(safe=False, unavailable=True)


def cards(study: Study) -> dict[str, Any]:
    return {row["id"]: row for row in payload(read(study), study.folder)["scenes"]}


def test_scenes_come_path_by_path_in_tree_order(study: Study) -> None:
    found = payload(read(study), study.folder)
    paths = study.tree("simulatable").paths
    assert list(found["leaves"]) == list(paths)
    assert [tuple(one["path"]) for one in found["leaves"].values()] == [
        p[1:] for p in paths.values()
    ]
    order = [row["leaf"] for row in found["scenes"]]
    assert order == sorted(order, key=list(paths).index)


def test_a_scene_is_told_in_words(study: Study) -> None:
    card = cards(study)["wrong-way-001"]
    assert card["setting"] == "urban three lane · day; dry · ego at 13.9 m/s (50 km/h)"
    assert [player["name"] for player in card["players"]] == ["van", "truck"]
    assert [player["hazard"] for player in card["players"]] == [True, False]
    assert "facing against its lane" in card["players"][0]["what"]
    assert card["decision"].startswith(
        "The ego must choose once the ego is 2.5 s from hitting the van"
    )
    assert [frame["caption"] for frame in card["frames"]] == [
        "first · 0.0 s",
        "middle · 1.6 s",
        "last · 3.2 s",
    ]
    assert card["choice"] == "mixed"
    assert [action["kind"] for action in card["actions"]].count("safe") == 3
    assert card["sketch"]["bodies"]["hazard"] == [24.0, 0.1, 180.0, 5.3, 2.2]
    assert card["sketch"]["names"]["hazard"] == "van"


def test_models_keep_their_words_and_references_only_their_choices(study: Study) -> None:
    found = payload(read(study), study.folder)
    assert [(one["name"], one["kind"]) for one in found["models"]] == [
        ("gpt-4o", "model"),
        ("constant:stop", "reference"),
    ]
    model, reference = sorted(
        cards(study)["wrong-way-001"]["answers"], key=lambda row: row["model"]
    )
    assert model["descriptions"][1] == "A road, something ahead."
    assert "descriptions" not in reference
    assert reference["action"] == "stop"


def test_long_answers_are_cut(study: Study) -> None:
    verdict = next(one for one in study.verdicts if one.kind == "model" and one.status == "ok")
    study.store.write_lines(
        "verdicts.jsonl", [verdict.model_copy(update={"reasoning": "x" * 10**6})]
    )
    answer = cards(study)[verdict.scene_id]["answers"][0]
    assert len(answer["reasoning"]) < 5_000
    assert answer["reasoning"].endswith("(1,000,000 characters)")


def test_oodness_follows_the_order_of_the_texts(study: Study) -> None:
    found = read(study)
    values = found.metrics.sets["simulatable"].oodness.per_text
    shown = cards(study)
    for scenario, value in zip(found.scenarios, values, strict=True):
        assert shown[scenario.id]["score"] == f"−{-value:.3f}"


def test_weather_can_be_the_hazard(study: Study) -> None:
    shown = cards(study)
    assert shown["thick-fog-at-night-001"]["badWeather"]
    assert shown["thick-fog-at-night-001"]["weather"] == ["night", "fog"]
    assert not shown["wrong-way-001"]["badWeather"]
    assert conditions(Weather(precipitation="snow", precipitation_mm_h=3, friction=0.3)) == [
        "day",
        "snow",
        "slippery road",
    ]


def test_texts_that_were_not_staged_say_so(study: Study) -> None:
    for name in ("scenes.jsonl", "episodes.jsonl"):
        (study.folder / name).unlink()
    assert all(card["state"].startswith("Not staged") for card in cards(study).values())


def test_twins_stand_beside_their_scenes(make_study: Callable[..., Study]) -> None:
    study = make_study(with_twins=True)
    shown = cards(study)
    assert not any(name.endswith("~twin") for name in shown)
    twin = shown["wrong-way-001"]["twin"]
    assert [player["name"] for player in twin["players"]] == ["truck"]
    assert all(action["kind"] == "safe" for action in twin["actions"])
    assert {answer["ood"] for answer in twin["answers"]} == {True, False}
    failed = next(e for e in study.episodes if e.status == "failed")
    assert shown[failed.scene_id]["twin"] is None


def test_items_without_a_text_are_not_lost(study: Study) -> None:
    (study.folder / "scenarios.jsonl").unlink()
    shown = cards(study)
    assert set(shown) == {scene["id"] for scene in study.table("scenes")}


def test_a_text_outside_the_band_says_so(make_study: Callable[..., Study]) -> None:
    study = make_study(band=(-0.1, 0.0))
    for name in ("scenes.jsonl", "episodes.jsonl"):
        (study.folder / name).unlink()
    for card in cards(study).values():
        assert card["state"].endswith("outside the band from −0.100 to 0.000.")


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [((SAFE, HIT), "mixed"), ((SAFE, GONE), "all"), ((HIT, GONE), "none"), ((GONE,), ""), ((), "")],
)
def test_choice_looks_at_available_actions_only(
    outcomes: tuple[ActionOutcome, ...], expected: str
) -> None:
    actions = {f"a{index}": one for index, one in enumerate(outcomes)}
    assert choice(Episode(id="x", scene_id="x", status="ok", actions=actions)) == expected


def test_demands_stand_beside_their_scenes(make_study: Callable[..., Study]) -> None:
    study = make_study(with_twins=True)
    scene, name = study.scenes[0], f"{study.scenes[0].id}~demand"
    told = {"id": name, "hazard": {}, "demand": {"kind": "queue", "text": "Cars stand in a queue."}}
    demand = Scene.model_validate({**scene.model_dump(), **told, "visible": (), "stands_for": {}})
    episode = study.episodes[0].model_copy(update={"id": name, "scene_id": name})
    study.store.write_lines("scenes.jsonl", [*study.store.lines("scenes.jsonl"), demand])
    study.store.write_lines("episodes.jsonl", [*study.episodes, episode])
    shown = cards(study)
    assert name not in shown
    assert shown[scene.id]["demand"]["text"] == "Cars stand in a queue."
    assert shown[scene.id]["demand"]["actions"] == shown[scene.id]["actions"]
    assert all(card["demand"] is None for other, card in shown.items() if other != scene.id)

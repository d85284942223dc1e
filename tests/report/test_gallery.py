from collections.abc import Callable

from oodscen.report.gallery import Card, sections
from oodscen.report.reading import read
from oodscen.report.thumbnails import Thumbnails
from oodscen.study import Study


def cards(study: Study) -> dict[str, Card]:
    found = sections(read(study), Thumbnails(study.folder, 1))
    return {card.id: card for section in found for card in section.cards}


def test_one_section_per_path_in_tree_order(study: Study) -> None:
    found = sections(read(study), Thumbnails(study.folder, 1))
    paths = study.tree("simulatable").paths
    assert [section.anchor for section in found] == [f"path-{leaf}" for leaf in paths]
    assert [section.path for section in found] == list(paths.values())
    assert {section.kind for section in found} == {"Environmental", "Interactional"}


def test_a_card_tells_the_scene_in_words(study: Study) -> None:
    card = cards(study)["wrong-way-001"]
    assert card.setting == "urban three lane · day; dry · ego at 13.9 m/s (50 km/h)"
    assert [player.name for player in card.players] == ["van", "truck"]
    assert card.players[0].is_hazard
    assert not card.players[1].is_hazard
    assert "facing against its lane" in card.players[0].place
    assert card.decision.startswith(
        "The ego must choose once the ego is 2.5 s from hitting the van"
    )
    assert [frame.caption for frame in card.frames] == [
        "first · 0.0 s",
        "middle · 1.6 s",
        "last · 3.2 s",
    ]
    assert card.choice == "mixed"


def test_oodness_follows_the_order_of_the_texts(study: Study) -> None:
    found = read(study)
    values = found.metrics["sets"]["simulatable"]["oodness"]["per_text"]
    shown = cards(study)
    for scenario, value in zip(found.scenarios, values, strict=True):
        assert shown[scenario.id].oodness == f"−{-value:.3f}"


def test_weather_can_be_the_hazard(study: Study) -> None:
    shown = cards(study)
    assert shown["thick-fog-at-night-001"].weather_is_hazard
    assert not shown["wrong-way-001"].weather_is_hazard


def test_texts_that_were_not_staged_say_so(study: Study) -> None:
    for name in ("scenes.jsonl", "episodes.jsonl"):
        (study.folder / name).unlink()
    assert all(card.state.startswith("Not staged") for card in cards(study).values())


def test_twins_are_left_out(study: Study) -> None:
    scene = study.scenes[0]
    study.store.append("scenes.jsonl", scene.twin(3.0))
    assert f"{scene.id}~twin" not in cards(study)


def test_items_without_a_text_are_not_lost(study: Study) -> None:
    (study.folder / "scenarios.jsonl").unlink()
    shown = cards(study)
    assert set(shown) == {scene["id"] for scene in study.table("scenes")}


def test_a_text_outside_the_band_says_so(make_study: Callable[..., Study]) -> None:
    study = make_study(band=(-0.1, 0.0))
    for name in ("scenes.jsonl", "episodes.jsonl"):
        (study.folder / name).unlink()
    for card in cards(study).values():
        assert card.state.endswith("outside the band from −0.100 to 0.000.")

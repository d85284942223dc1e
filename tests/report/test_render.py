import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from lxml import html

from oodscen.errors import StudyError
from oodscen.report import write_report
from oodscen.study import TABLES, Study

HOSTILE = (
    '<script>alert("x")</script><img src=x onerror=alert(1)>"\'><a href="javascript:alert(2)">'
    "</style></script>{{ 7*7 }}{% raw %}&amp;\u202e\x00\x1b"
)
SURROGATE = "\\ud800 lone, \\u0000 nul"


def page(study: Study) -> Any:
    return html.document_fromstring(write_report(study).read_text(encoding="utf-8"))


def text_of(element: Any) -> str:
    return " ".join(" ".join(element.itertext()).split())


def section(document: Any, name: str) -> str:
    return text_of(document.get_element_by_id(name))


def edit(study: Study, name: str, change: Callable[[str], str]) -> None:
    file = study.folder / name
    file.write_text(change(file.read_text(encoding="utf-8")), encoding="utf-8")


def test_summary_says_what_happened_in_numbers(study: Study) -> None:
    top = section(page(study), "top")
    for words in ("7 nodes", "9 nodes", "6 nodes on 3 paths", "6 texts", "4 items failed"):
        assert words in top
    assert "100 % of the scenes the choice of action matters" in top
    assert "2 min 11 s, with seed 0" in top
    assert "No language model wrote the tree" in top


def test_a_language_model_is_named(make_study: Callable[..., Study]) -> None:
    top = section(page(make_study(llm="gpt-4o", red_llm="builtin")), "top")
    assert "written by the language model “gpt-4o”" in top
    assert "imagined by the built-in writer, not a language model" in top


def test_counts_and_metrics_stand_beside_the_papers(study: Study) -> None:
    document = page(study)
    assert "Nodes of the diverse tree 9 77" in section(document, "counts")
    metrics = section(document, "metrics")
    assert "−0.953" in metrics
    assert "−0.765" in metrics
    assert "−0.645 to −0.605" in metrics
    assert "come from another baseline" in metrics
    assert "standard deviation. Above that of ordinary driving lie" in metrics
    assert document.xpath("//section[@id='metrics']//*[name()='svg']")


def test_trees_tell_origin_fate_and_what_is_missing(study: Study) -> None:
    trees = section(page(study), "trees")
    assert "new in round 1" in trees
    assert "broadened in rounds 2, 5, at first “Large cardboard box on the lane”" in trees
    assert "Missing: traffic_signal" in trees
    assert "failed the model timed out" in trees


def test_leaderboard_marks_references_and_has_intervals(study: Study) -> None:
    models = section(page(study), "models")
    assert "constant:stop reference 50 % 2 of 4 15 % to 85 %" in models
    assert "gpt-4o 67 % 2 of 3" in models
    assert "Gemini 1.5 Pro 81 % 105 of 130 73 % to 87 %" in models


def test_every_scene_has_an_anchor_its_frames_and_outcomes(study: Study) -> None:
    document = page(study)
    for scene in study.scenes:
        card = document.get_element_by_id(f"scene-{scene.id}")
        if "failed" in card.get("class"):
            continue
        links = [a.get("href") for a in card.xpath(".//div[@class='frames']//a")]
        assert links == [f"frames/{scene.id}/{m}.jpg" for m in ("first", "middle", "last")]
        assert all((study.folder / link).is_file() for link in links)
        assert all(
            source.startswith("data:image/jpeg;base64,") for source in card.xpath(".//img/@src")
        )
        chips = [text_of(chip) for chip in card.xpath(".//ul[@class='chips']/li")]
        assert len(chips) == 7
        assert chips[0].startswith("unsafe: keep speed hits")
        assert any(chip == "unavailable: change lane right no such lane" for chip in chips)


def test_failed_items_are_shown_with_their_error(study: Study) -> None:
    document = page(study)
    cards = document.xpath("//article[contains(@class, 'failed')]")
    assert len(cards) == 2
    words = " ".join(map(text_of, cards))
    assert "simulation failed: cannot spawn 'hazard' (van)" in words
    assert "staging failed: no valid answer" in words
    listed = section(document, "provenance")
    for error in (
        "429 too many requests",
        "the model timed out",
        "no valid answer",
        "cannot spawn",
    ):
        assert error in listed


def test_missing_frames_are_said(study: Study) -> None:
    scene = study.scenes[0].id
    (study.folder / f"frames/{scene}/last.jpg").unlink()
    (study.folder / f"frames/{scene}/first.jpg").write_bytes(b"not a picture")
    words = text_of(page(study).get_element_by_id(f"scene-{scene}"))
    assert "frame file is missing" in words
    assert "frame file is not a picture" in words


@pytest.mark.parametrize("kept", [(), ("study.json",), ("tree.initial.json", "scenarios.jsonl")])
def test_an_incomplete_study_says_what_is_not_there(study: Study, kept: tuple[str, ...]) -> None:
    for file in study.folder.iterdir():
        if file.is_file() and file.name not in kept:
            file.unlink()
    words = text_of(page(study).body)
    for name in ("metrics.json", "tree.diverse.json", *TABLES.values()):
        if name not in (*kept, "edits.jsonl"):
            assert f"{name} is not there yet" in words
    assert "Not staged" in words or "scenarios.jsonl" not in kept


BROKEN = (
    b"",
    b"{",
    b"[1, 2]\n",
    b'"x"\n',
    b"\xff\xfe\n",
    b"{}\n",
    b'{"id": 3, "config": [], "sets": 1}\n',
    b'{"status": "failed"}\n',
)


@pytest.mark.parametrize(
    "name", ["study.json", "metrics.json", "tree.diverse.json", *TABLES.values()]
)
def test_no_broken_file_stops_the_page(study: Study, name: str) -> None:
    shutil.rmtree(study.folder / "frames")
    for content in BROKEN:
        (study.folder / name).write_bytes(content)
        assert "</html>" in write_report(study).read_text(encoding="utf-8")


def test_what_models_wrote_is_escaped(study: Study) -> None:
    quoted = json.dumps(HOSTILE)[1:-1]
    for name in (
        "scenarios.jsonl",
        "redteam.jsonl",
        "pruned.jsonl",
        "verdicts.jsonl",
        "episodes.jsonl",
        "calls.jsonl",
        "scenes.jsonl",
    ):
        edit(
            study,
            name,
            lambda text: re.sub(
                r'("(?:text|reason|error|model|aspect|action|purpose|source)":)"[^"]+"',
                lambda found: f'{found[1]}"{quoted}{SURROGATE}"',
                text,
            ),
        )
    label = quoted.split("\\u0000")[0] + "\\ud800"
    for name in ("tree.initial.json", "tree.diverse.json", "tree.simulatable.json"):
        edit(study, name, lambda text: text.replace("Vehicle driving the wrong way", label))
    edit(
        study,
        "metrics.json",
        lambda text: re.sub(r'"text": "[^"]+"', lambda _: f'"text": "{quoted}"', text),
    )
    edit(study, "study.json", lambda text: text.replace('"builtin"', f'"{quoted}{SURROGATE}"'))
    source = write_report(study).read_text(encoding="utf-8")
    document: Any = html.document_fromstring(source)
    assert len(document.xpath("//script")) == 1
    assert len(document.xpath("//style")) == 1
    assert not document.xpath("//@*[starts-with(name(), 'on')]")
    assert not document.xpath("//a[starts-with(@href, 'javascript:')]")
    assert not document.xpath("//img[@src='x']")
    assert "{{ 7*7 }}" in source
    assert source.count("&lt;script&gt;alert") > 10
    assert "\x00" not in source
    assert "\x1b" not in source


def test_links_stay_inside_the_page_and_the_folder(study: Study) -> None:
    edit(
        study,
        "episodes.jsonl",
        lambda text: (
            text.replace("frames/thick-fog-at-night-001/first.jpg", "javascript:alert(1)//x.jpg")
            .replace("frames/thick-fog-at-night-001/middle.jpg", "../../etc/x.jpg")
            .replace("frames/thick-fog-at-night-001/last.jpg", "https://example.org/x.jpg")
        ),
    )
    document = page(study)
    assert "not a picture of this study" in text_of(document)
    ids = set(document.xpath("//@id"))
    for target in document.xpath("//@href | //@src | //@action | //@poster | //@srcset"):
        if target.startswith("#"):
            assert target[1:] in ids
        else:
            assert re.match(r"frames/[^:]+$|data:image/jpeg;base64,", target), target
    source = (study.folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"url\(|@import|<link|<iframe|xlink", source)


def test_addresses_lose_their_credentials(make_study: Callable[..., Study]) -> None:
    source = write_report(make_study(api_base="http://me:secret@host/v1")).read_text("utf-8")
    assert "secret" not in source
    assert "http://host/v1" in source


def test_same_study_same_bytes(study: Study) -> None:
    first = write_report(study).read_bytes()
    assert write_report(Study(study.folder)).read_bytes() == first


def test_ids_are_unique_and_pictures_and_tables_are_accessible(study: Study) -> None:
    document = page(study)
    ids = document.xpath("//@id")
    assert len(ids) == len(set(ids))
    assert all(document.xpath("//img/@alt"))
    assert len(document.xpath("//img")) == len(document.xpath("//img[@alt]"))
    assert document.xpath("//html/@lang") == ["en"]
    assert len(document.xpath("//h1")) == 1
    assert not document.xpath("//@style")


def test_two_hundred_scenes_stay_small(make_study: Callable[..., Study]) -> None:
    file = write_report(make_study(per_path=67, frames=1))
    document: Any = html.document_fromstring(file.read_text(encoding="utf-8"))
    assert len(document.xpath("//article")) == 201
    assert file.stat().st_size < 8_000_000


def test_without_opencv_the_frames_beside_the_page_are_shown(
    study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("oodscen.report.thumbnails._cv2", lambda: None)
    document = page(study)
    assert "OpenCV was not installed" in text_of(document)
    assert document.xpath("//img/@src")[0].startswith("frames/")


def test_a_study_that_cannot_be_written_is_an_error(study: Study, tmp_path: Path) -> None:
    (study.folder / "report.html").mkdir()
    with pytest.raises(StudyError):
        write_report(study)

import functools
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from lxml import html

from oodscen import Study
from oodscen._io.study_files import TABLES
from oodscen.data._drive_result import DriveResult
from oodscen.data._verdict import verdict_id
from oodscen.errors import StudyError
from tests.pipeline.quick import as_made

HOSTILE = (
    '<script>alert("x")</script><img src=x onerror=alert(1)>"\'><a href="javascript:alert(2)">'
    "</style></script>{{ 7*7 }}{% raw %}&amp;\u202e\x00\x1b"
)
NUL = "\\u0000 nul"


def page(study: Study) -> Any:
    return html.document_fromstring(study.write_report().read_text(encoding="utf-8"))


def text_of(element: Any) -> str:
    return " ".join(" ".join(element.itertext()).split())


def section(document: Any, name: str) -> str:
    return text_of(document.get_element_by_id(name))


def edit(study: Study, name: str, change: Callable[[str], str]) -> None:
    file = study.folder / name
    file.write_text(change(file.read_text(encoding="utf-8")), encoding="utf-8")


def test_summary_says_what_happened_in_numbers(study: Study) -> None:
    top = section(page(study), "top")
    for words in ("7 nodes", "9 nodes", "6 nodes on 3 paths", "6 texts", "3 items failed"):
        assert words in top
    assert "In 4 of 4 scenes the choice of action matters" in top
    assert "judgements without a usable answer 1" in top
    assert "2 min 11 s, with seed 0" in top
    assert "No language model wrote the tree" in top


def test_summary_counts_the_hazards_that_cannot_be_named(study: Study) -> None:
    sizes = iter((100.0, 4.0))

    def look(line: str) -> str:
        episode = json.loads(line)
        size = next(sizes, None) if episode["scene_id"] == episode["id"] else None
        if size is not None:
            episode["sighting"] = {
                "actor": "a",
                "distance_m": 30.0,
                "height_px": size,
                "size_px": size,
            }
        return json.dumps(episode)

    assert "can name the hazard" not in section(page(study), "top")
    edit(study, "episodes.jsonl", lambda text: "\n".join(map(look, text.splitlines())) + "\n")
    top = section(page(study), "top")
    assert (
        "can name the hazard in 1 of 2 scenes with an unusual actor; the other 1, too small" in top
    )


def test_a_language_model_is_named(make_study: Callable[..., Study]) -> None:
    top = section(page(make_study(llm="gpt-4o", red_llm="builtin")), "top")
    assert "written by the language model “gpt-4o”" in top
    assert "imagined by the built-in writer, not a language model" in top
    assert "without an answer" not in top
    top = section(page(make_study(llm="gpt-4o", fallback="builtin")), "top")
    assert "without an answer went to the built-in writer, not a language model" in top


def test_counts_and_metrics_stand_beside_the_papers(study: Study) -> None:
    document = page(study)
    assert "Nodes of the diverse tree 9 77" in section(document, "counts")
    metrics = section(document, "metrics")
    assert "−0.953" in metrics
    assert "−0.765" in metrics
    assert "−0.645 to −0.605" in metrics
    assert "come from another baseline" in metrics
    assert "standard deviation. Beside ordinary driving lie" in metrics
    assert document.xpath("//section[@id='metrics']//*[name()='svg']")


def test_trees_tell_origin_fate_and_what_is_missing(study: Study) -> None:
    trees = section(page(study), "trees")
    assert "new in round 1" in trees
    assert "broadened in rounds 2, 5, at first “Large cardboard box on the lane”" in trees
    assert "Missing: traffic_signal" in trees
    assert "failed the model timed out" in trees


def test_leaderboard_marks_references_and_has_intervals(make_study: Callable[..., Study]) -> None:
    models = section(page(make_study(with_twins=True)), "models")
    assert "constant: stop floor to beat 100 % 4 of 4 44 to 100 %" in models
    assert "gpt-4o 67 % 2 of 3" in models
    assert "1 not in time" in models
    assert "Notices that something is unusual better than not looking" not in models
    assert "86 66 % 58 % to 74 %" in models
    assert "always answering “out of the ordinary” is right in 100 %" in models


def test_a_stopped_run_says_why(study: Study) -> None:
    edit(
        study,
        "study.json",
        lambda text: json.dumps({**json.loads(text), "status": "stopped", "stopped": "cap <b>"}),
    )
    top = section(page(study), "top")
    assert "This run stopped: cap <b> . The page shows what there is so far." in top
    assert "is not recorded" not in top


def test_failures_of_models_lead_to_their_scene_and_are_no_failures_of_the_study(
    make_study: Callable[..., Study],
) -> None:
    study = make_study(with_twins=True)
    document = page(study)
    links = document.xpath("//table//a[starts-with(@href, '#scene-')]/@href")
    known = {f"#scene-{row['id']}" for row in scenes_of(document)}
    judged = [v for v in study.verdicts if v.status == "failed"]
    assert judged
    assert {f"#scene-{v.scene_id.removesuffix('~twin')}" for v in judged} <= set(links) <= known
    assert f"{len(judged)} judgement" in section(document, "provenance")


def test_what_is_behind_the_ego_is_said(study: Study) -> None:
    lines = list(study.store.lines("episodes.jsonl"))
    first, *_ = [row["id"] for row in lines if row["status"] == "ok"]
    rows = [{**row, "followers": ["x"] if row["id"] == first else []} for row in lines]
    edit(study, "episodes.jsonl", lambda _: "".join(f"{json.dumps(row)}\n" for row in rows))
    document = page(study)
    models = section(document, "models")
    assert "With somebody close behind the ego (1 scene):" in models
    assert "Without somebody close behind the ego (3 scenes):" in models
    assert [row["id"] for row in scenes_of(document) if row["followed"]] == [first]


def test_constants_are_one_row_where_they_say_the_same(study: Study) -> None:
    rows = page(study).xpath("//div[@aria-label='Leaderboard of noticing and naming']//tbody/tr")
    names = [row.xpath("string(th)").split()[0] for row in rows]
    assert len(names) == len(set(names))


def test_without_a_model_it_says_what_one_must_beat(study: Study) -> None:
    edit(
        study,
        "verdicts.jsonl",
        lambda text: "".join(line + "\n" for line in text.splitlines() if "gpt-4o" not in line),
    )
    models = section(page(study), "top")
    assert "No vision-language model was judged" in models
    assert "The bar to beat: always choosing “stop”, whatever is seen," in models


def without_model(study: Study) -> None:
    edit(
        study,
        "verdicts.jsonl",
        lambda text: "".join(line + "\n" for line in text.splitlines() if "gpt-4o" not in line),
    )


def driven(study: Study) -> None:
    drives = [
        DriveResult(
            id=f"{scene.id}{end}@mine",
            scene_id=f"{scene.id}{end}",
            driver="mine",
            is_twin=bool(end),
            passed=True,
            progress=1.0,
            brakes_needlessly=True if end else None,
            made_from=scene.digest(),
        )
        for scene in study.scenes
        for end in ("", "~twin")
    ]
    study.store.write_lines("drives.jsonl", drives)


def test_a_study_of_driving_stacks_opens_with_them(study: Study) -> None:
    driven(study)
    assert "mine drives and passes" not in section(page(study), "top")
    without_model(study)
    document = page(study)
    lead = " ".join(document.xpath("string(//div[@class='lead'])").split())
    assert re.match(r"mine drives and passes 100.% .* without need in 100.% .* of the twins", lead)
    assert "vision-language" not in section(document, "top")
    models = section(document, "models")
    assert models.index("Driving stacks") < models.index("No vision-language model was judged")


def test_a_study_with_views_from_above_speaks_of_driving_stacks(study: Study) -> None:
    without_model(study)
    edit(study, "study.json", lambda text: text.replace("{", '{"camera": "top",', 1))
    document = page(study)
    assert "These scenes are for driving stacks: flat draws" in section(document, "top")
    assert "To judge a model" not in section(document, "models")


def test_a_banner_tells_failed_items_from_missing_answers(study: Study) -> None:
    banner = "string(//p[@class='banner'])"
    assert "some items failed" in page(study).xpath(banner)
    for name in ("redteam", "pruned", "scenarios", "scenes", "episodes"):
        rows = [row for row in study.store.lines(f"{name}.jsonl") if row.get("status") != "failed"]
        study.store.write_lines(f"{name}.jsonl", rows)
    document = page(study)
    assert "nothing failed" in section(document, "top")
    assert "without a usable answer" in document.xpath(banner)


def scenes_of(document: Any) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(document.get_element_by_id("data").text)["scenes"]
    return found


def test_every_scene_is_in_the_page_with_its_frames_and_outcomes(study: Study) -> None:
    shown = {row["id"]: row for row in scenes_of(page(study))}
    for scene in study.scenes:
        card = shown[scene.id]
        if card["error"]:
            continue
        links = [frame["href"] for frame in card["frames"]]
        assert links == [f"frames/{scene.id}/{m}.jpg" for m in ("first", "middle", "last")]
        assert card["actions"][0]["note"].startswith("hits")
        assert len(card["actions"]) == 7
        assert card["actions"][5]["kind"] == "unavailable"


def test_failed_items_are_shown_with_their_error(study: Study) -> None:
    document = page(study)
    words = " ".join(row["error"] for row in scenes_of(document) if row["error"])
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
    frames = next(row["frames"] for row in scenes_of(page(study)) if row["id"] == scene)
    assert [frame["problem"] for frame in frames] == ["", "", "frame file is missing"]


@pytest.mark.parametrize("kept", [(), ("study.json",), ("tree.initial.json", "scenarios.jsonl")])
def test_an_incomplete_study_says_what_is_not_there(study: Study, kept: tuple[str, ...]) -> None:
    for file in study.folder.iterdir():
        if file.is_file() and file.name not in kept:
            file.unlink()
    document = page(study)
    words = text_of(document.body)
    for name in ("metrics.json", "tree.diverse.json", *TABLES.values()):
        if name not in (*kept, "edits.jsonl", "drives.jsonl"):
            assert f"{name} is not there yet" in words
    assert bool(scenes_of(document)) == ("scenarios.jsonl" in kept)
    assert all(row["state"] == "Not staged yet." for row in scenes_of(document))


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
        assert "</html>" in study.write_report().read_text(encoding="utf-8")


def _overwritten(value: str, table: str) -> str:
    """Return a table with a value in place of everything that a model may have written."""
    return re.sub(
        r'("(?:text|reason|error|model|aspect|action|purpose|source|reasoning|contradiction|choice)":)"[^"]+"',
        lambda match: f'{match[1]}"{value}"',
        table,
    )


def test_what_models_wrote_is_escaped(study: Study) -> None:
    quoted = json.dumps(HOSTILE)[1:-1]
    written = dict.fromkeys(TABLES.values(), quoted + NUL)
    # A scenario's text holds no NUL character.
    written["scenarios.jsonl"] = quoted.replace("\\u0000", "")
    for name in (
        "scenarios.jsonl",
        "redteam.jsonl",
        "pruned.jsonl",
        "verdicts.jsonl",
        "episodes.jsonl",
        "calls.jsonl",
        "scenes.jsonl",
    ):
        edit(study, name, functools.partial(_overwritten, written[name]))
    label = quoted.split("\\u0000")[0]
    for name in ("tree.initial.json", "tree.diverse.json", "tree.simulatable.json"):
        edit(study, name, lambda text: text.replace("Vehicle driving the wrong way", label))
    edit(
        study,
        "metrics.json",
        lambda text: re.sub(r'"text":"[^"]+"', lambda _: f'"text":"{quoted}"', text),
    )
    edit(study, "study.json", lambda text: text.replace('"builtin"', f'"{quoted}{NUL}"'))
    said = [
        stored_verdict.model_copy(
            update={
                "id": verdict_id(stored_verdict.scene_id, stored_verdict.model),
                "action": stored_verdict.action and "stop",
            }
        )
        for stored_verdict in study.stored_verdicts
    ]
    study.store.write_lines("verdicts.jsonl", as_made(study, said))
    source = study.write_report().read_text(encoding="utf-8")
    document: Any = html.document_fromstring(source)
    assert document.xpath("//script/@type") == ["application/json"]
    assert len(document.xpath("//script")) == 2
    assert len(document.xpath("//style")) == 1
    assert not document.xpath("//@*[starts-with(name(), 'on')]")
    assert not document.xpath("//a[starts-with(@href, 'javascript:')]")
    assert not document.xpath("//img[@src='x']")
    assert "{{ 7*7 }}" in source
    assert source.count("&lt;script&gt;alert") > 10
    assert source.count("\\u003cscript\\u003ealert") > 10
    assert any("<script>alert" in row["text"] for row in scenes_of(document))
    assert "\x00" not in source
    assert "\x1b" not in source


def test_half_a_surrogate_pair_is_a_gap(study: Study) -> None:
    for name in ("verdicts.jsonl", "study.json"):
        edit(
            study,
            name,
            lambda text: text.replace('"builtin"', '"\\ud800"').replace("@", "\\udfff", 1),
        )
    words = page(study).text_content()
    assert "study.json cannot be read" in words
    assert "1 line(s) of verdicts.jsonl" in words


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
    assert "not a picture of this study" in document.get_element_by_id("data").text
    ids = set(document.xpath("//@id"))
    for target in document.xpath("//@href | //@src | //@action | //@poster | //@srcset"):
        if target.startswith("#"):
            assert target[1:] in ids or re.match(r"#(path|scene)-", target)
        else:
            assert re.match(r"frames/[^:]+$", target), target
    hrefs = [frame["href"] for row in scenes_of(document) for frame in row["frames"]]
    assert all(re.fullmatch(r"(frames/[^:]+)?", href) for href in hrefs)
    source = (study.folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"url\(|@import|<link|<iframe|xlink", source)


def test_addresses_lose_their_credentials(make_study: Callable[..., Study]) -> None:
    study = make_study(api_base="http://host/v1")
    edit(study, "study.json", lambda text: text.replace("http://host", "http://me:secret@host"))
    source = study.write_report().read_text("utf-8")
    assert "secret" not in source
    assert "http://host/v1" in source


def test_same_study_same_bytes(study: Study) -> None:
    first = study.write_report().read_bytes()
    assert Study(study.folder).write_report().read_bytes() == first


def test_ids_are_unique_and_pictures_and_tables_are_accessible(study: Study) -> None:
    document = page(study)
    ids = document.xpath("//@id")
    assert len(ids) == len(set(ids))
    assert all(document.xpath("//img/@alt"))
    assert len(document.xpath("//img")) == len(document.xpath("//img[@alt]"))
    assert document.xpath("//html/@lang") == ["en"]
    assert len(document.xpath("//h1")) == 1
    assert not document.xpath("//@style")


def test_a_study_that_cannot_be_written_is_an_error(study: Study, tmp_path: Path) -> None:
    (study.folder / "report.html").mkdir()
    with pytest.raises(StudyError):
        study.write_report()


def change_lines(name: str, **fields: Any) -> Callable[[Study], None]:
    def change(study: Study) -> None:
        file = study.folder / name
        lines = [json.loads(line) | fields for line in file.read_text().splitlines()]
        file.write_text("".join(f"{json.dumps(line)}\n" for line in lines))

    return change


def change_info(config: dict[str, Any], **fields: Any) -> Callable[[Study], None]:
    def change(study: Study) -> None:
        content = json.loads((study.folder / "study.json").read_text())
        content["config"] |= config
        (study.folder / "study.json").write_text(json.dumps(content | fields))

    return change


@pytest.mark.parametrize(
    "change",
    [
        change_lines("redteam.jsonl", nodes=10**40),
        change_lines("episodes.jsonl", decision_s=-5.0),
        change_lines("episodes.jsonl", decision_s=1e300),
        change_lines("episodes.jsonl", frames={"noon": "noon.jpg"}),
        change_info({"sets": [True]}, failures={"ordinary": 1}),
    ],
)
def test_values_that_no_run_writes_do_not_stop_the_page(
    make_study: Callable[..., Study], change: Callable[[Study], None]
) -> None:
    study = make_study(with_twins=True)
    change(study)
    page(study)

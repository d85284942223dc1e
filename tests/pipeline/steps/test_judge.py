"""The stage that judges: both tasks, scenes and twins, real pictures, nothing asked twice."""

import json
import shutil
from collections import Counter

import cv2
import numpy as np
import pytest
from lxml import html

from oodscen import Study
from oodscen._pipeline import RunOptions, run_study
from oodscen._pipeline.answering import take_rear_views
from oodscen._pipeline.context import Context
from oodscen._pipeline.dropping import drop_models
from oodscen.data._episode import ACTIONS
from oodscen.data._pairing import scene_of
from oodscen.errors import BudgetExceeded, DataError, LLMError, UsageError
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.llm._remote.limits import Limits
from oodscen.report._load import read
from oodscen.report._quiz import draw_drives, write_quiz
from oodscen.study._stale_verdicts import OPINIONS
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.pipeline.quick import QUICK, SMALL, asked_about


@pytest.fixture
def study(quick):
    return Study.open(quick)


@pytest.fixture
def folder(small, tmp_path):
    """Return a finished study of one scene and its ordinary drive, which a test may change."""
    return shutil.copytree(small, tmp_path / "out")


def of(study, model):
    return {row.scene_id: row for row in study.verdicts if row.model == model}


def test_scenes_and_ordinary_drives_are_run_and_judged(study):
    ids = [episode.id for episode in study.episodes]
    scenes = [scene.id for scene in study.scenes]
    ends = ("", "~twin", "~demand")
    assert ids == [f"{scene}{end}" for scene in scenes for end in ends]
    items = {episode.id for episode in asked_about(study)}
    assert {row.scene_id for row in study.verdicts} == items
    assert len(items) == 2 * len(scenes)
    models = {row.model for row in study.verdicts}
    assert models == {
        *(f"constant:{a}" for a in ACTIONS), "random", "blind", "novelty", "oracle"
    }  # fmt: skip
    assert json.loads((study.folder / "leaderboard.json").read_text())


def test_the_oracle_is_always_right_where_anything_is_safe(study):
    episodes = {episode.id: episode for episode in study.episodes}
    for name, row in of(study, "oracle").items():
        assert row.is_ood is not row.is_ordinary
        assert row.choice_is_right
        assert row.aspect_is_right or row.is_ordinary
        assert row.action_is_safe or not episodes[name].safe_set


@pytest.mark.parametrize("action", ACTIONS)
def test_a_constant_scores_exactly_what_its_action_scored(study, action):
    rows = of(study, f"constant:{action}")
    scores = {"safe": True, "marginal": None}
    for episode in asked_about(study):
        label = episode.label(action)
        assert rows[episode.id].action_is_safe is scores.get(label, False)
        unavailable = label == "unavailable"
        assert rows[episode.id].outcome == ("unavailable" if unavailable else "answered")


def test_scenes_below_the_floor_are_left_out_with_their_twins_and_counted(quick, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(quick, out)
    file = out / "episodes.jsonl"
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    below = next(row for row in rows if row["sighting"])
    below["sighting"]["size_px"] = 3.0
    file.write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    study = run_study(out, QUICK)
    left = {one.id for one in asked_about(study) if scene_of(one.id) != below["id"]}
    assert {row.scene_id for row in study.verdicts} == left
    assert study.info["counts"]["below_floor"] == 1
    words = html.parse(study.folder / "report.html").getroot().text_content()
    assert "the other 1, too small" in words
    assert "not judged, since it is small" in words


def test_a_served_model_sees_pictures_and_is_asked_once(folder):
    with AnsweringServer(ConstantAnswerer("stop")) as server:
        model = server.client("gpt-4o")
        config = SMALL.model_copy(update={"vlms": ("served",)})
        capped = server.client("gpt-4o", limits=Limits(requests=4))
        with pytest.raises(BudgetExceeded):
            run_study(folder, config, models={"served": capped})
        assert 0 < len(server.received) <= 4
        run_study(folder, config, models={"served": model})
        asked = len(server.received)
        pictures = [image for one in server.received for image in one.images]
        run_study(folder, config, models={"served": model})
        assert len(server.received) == asked
    study = Study.open(folder)
    rows = of(study, model.name)
    assert len(rows) == len(asked_about(study))
    assert asked == 3 * len(rows)
    for data in pictures[:6]:
        decoded = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        assert decoded.shape == (SMALL.height, SMALL.width, 3)
    episodes = {episode.id: episode for episode in study.episodes}
    for name, row in rows.items():
        assert row.action_is_safe is {"safe": True, "marginal": None}.get(
            episodes[name].label("stop"), False
        )
    assert study.info["counts"]["outcomes"][model.name] == {"answered": len(rows)}


def test_the_paper_s_protocol_stands_beside_ours(folder):
    config = SMALL.model_copy(update={"protocols": ("ours", "paper")})
    study = run_study(folder, config)
    paper = [row for row in study.verdicts if row.protocol == "paper"]
    assert {row.scene_id for row in paper} == {scene.id for scene in study.scenes}
    assert not any(row.is_ordinary for row in paper)
    assert all(row.action_is_safe is row.success for row in paper)
    assert (folder / "frames" / study.scenes[0].id / "whole-last.jpg").is_file()
    whole = [
        json.loads(line) for line in (folder / "episodes.paper.jsonl").read_text().splitlines()
    ]
    seen = sum(one["hazard_visible"] is True for one in whole)
    board = Leaderboard.parse((folder / "leaderboard.json").read_bytes())
    assert (board.whole, board.whole_shown) == (len(study.scenes), seen)
    oracle = next(r for r in board.standings if (r.model, r.protocol) == ("oracle", "paper"))
    assert oracle.identification.open_shown.n == seen
    assert (
        f"in {seen} of {len(whole)} scenes the hazard can be seen"
        in (folder / "report.html").read_text()
    )


def test_items_that_cannot_be_shown_and_old_prompts_are_counted(folder, monkeypatch):
    model = ConstantAnswerer("stop")
    model.name, model.kind = "mine", "model"
    config = SMALL.model_copy(update={"vlms": ("mine",)})
    cut = Study.open(folder).scenes[0].id
    episodes = [
        episode.model_copy(update={"file_sha256": {}}) for episode in Study.open(folder).episodes
    ]
    Study(folder).store.write_lines("episodes.jsonl", episodes)
    for picture in (folder / "frames" / cut).iterdir():
        picture.write_bytes(picture.read_bytes()[: picture.stat().st_size // 2])
    study = run_study(folder, config, models={"mine": model})
    rows = of(study, "mine")
    assert rows[cut].outcome == "error"
    assert rows[cut].error_type == "DataError"
    lines = (folder / "verdicts.jsonl").read_text().splitlines()
    changed = [line.replace(_version(rows), "0" * 12) for line in lines]
    (folder / "verdicts.jsonl").write_text("\n".join(changed) + "\n")
    counts = run_study(folder, config, models={"mine": model}).info["counts"]["outcomes"]["mine"]
    assert counts["outdated"] == counts["answered"] == len(rows) - 1


class Named(ScriptedLLM):
    """A model with a name of its own, whatever it was asked for by."""

    def __init__(self, name):
        super().__init__([], name=name)


@pytest.mark.parametrize(
    ("models", "more"),
    [
        ({"a": "oracle"}, {}),
        ({"a": "blind"}, {}),
        ({"a": "random"}, {}),
        ({"a": "constant:stop"}, {}),
        ({"random": "mine", "a": "random"}, {}),
        ({"a": "mine", "b": "mine"}, {}),
        ({"a": "mine", "b": "mine without pictures"}, {"withheld": ("a",)}),
    ],
)
def test_two_answerers_of_one_name_are_refused_before_anything_is_written(tmp_path, models, more):
    config = QUICK.model_copy(update={"vlms": tuple(models), **more})
    options = RunOptions(models={name: Named(its) for name, its in models.items()})
    with pytest.raises(UsageError, match="would be kept under the name"):
        Context(tmp_path / "out", config, options).prepare()
    assert not (tmp_path / "out").exists()


def test_a_model_that_is_named_like_a_person_is_refused(tmp_path):
    config = QUICK.model_copy(update={"vlms": ("a",)})
    with pytest.raises(UsageError, match="how a person's answers are named"):
        Context(tmp_path / "out", config, RunOptions(models={"a": Named("human:Ada")})).prepare()
    assert not (tmp_path / "out").exists()


def test_answerers_of_different_names_and_the_references_may_be_judged(tmp_path):
    models = {"a": Named("mine"), "b": Named("mine without")}
    vlms = (*models, "random", "constant", "constant:stop")
    config = QUICK.model_copy(update={"vlms": vlms, "withheld": ("a", "random")})
    Context(tmp_path / "out", config, RunOptions(models=models)).prepare()


@pytest.fixture
def asked(quick, tmp_path):
    """A copy of the study, its scenes' names, and a model that notes the pictures it is shown."""
    out = shutil.copytree(quick, tmp_path / "out")
    scenes = [scene.id for scene in Study.open(out).scenes]
    (tmp_path / "priv").mkdir()
    shutil.copy(out / "frames" / scenes[0] / "last.jpg", tmp_path / "priv" / "last.jpg")
    shown = []

    def answer(asked):
        shown.extend(image.path for message in asked.messages for image in message.images)
        return ConstantAnswerer("stop").complete(asked).text

    model = ScriptedLLM(answer)
    model.name = "mine"
    config = QUICK.model_copy(update={"vlms": ("mine",)})
    return out, scenes, shown, lambda: of(run_study(out, config, models={"mine": model}), "mine")


def test_a_picture_that_is_named_outside_the_study_is_not_shown(asked):
    out, scenes, shown, run = asked
    lines = (out / "episodes.jsonl").read_text()
    (out / "episodes.jsonl").write_text(
        lines.replace(f'"last":"frames/{scenes[0]}/last.jpg"', '"last":"../priv/last.jpg"')
    )
    rows = run()
    assert (rows[scenes[0]].outcome, rows[scenes[0]].error_type) == ("error", "DataError")
    assert all(rows[name].outcome == "answered" for name in scenes[1:])
    assert shown
    assert all(path.resolve().is_relative_to(out.resolve()) for path in shown)


def test_a_folder_of_frames_that_leads_outside_stops_the_run_before_anything_is_shown(
    asked, tmp_path
):
    out, scenes, shown, run = asked
    shutil.rmtree(out / "frames" / scenes[1])
    (out / "frames" / scenes[1]).symlink_to(tmp_path / "priv")
    with pytest.raises(DataError, match=scenes[1]):
        run()
    assert not shown
    assert [path.name for path in (tmp_path / "priv").iterdir()] == ["last.jpg"]


def _version(rows):
    return next(row.prompts["name-aspect"] for row in rows.values() if row.prompts)


HOSTILE = (
    "<script>alert(1)</script></script><img src=x onerror=alert(1)> javascript:alert(1) "
    "\ud800 \u202e \x00 \x1b[2J ]]> {{ 7*7 }} \ufffe"
)


def test_frames_that_are_cut_off_cost_their_item_only_and_missing_ones_come_back(quick, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(quick, out)
    lines = [json.loads(line) for line in (out / "episodes.jsonl").read_text().splitlines()]
    items = [episode.id for episode in asked_about(Study.open(out))]
    cut, fewer, empty, none = items
    for name, kept in ((cut, 0.5), (empty, 0)):
        picture = out / "frames" / name / "middle.jpg"
        data = picture.read_bytes()
        picture.write_bytes(data[: int(kept * len(data))])
    shutil.rmtree(out / "frames" / none)
    by_id = {line["id"]: line for line in lines}
    del by_id[cut]["file_sha256"]
    del by_id[fewer]["frames"]["middle"]
    (out / "episodes.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    model = ConstantAnswerer("stop")
    model.name, model.kind = "mine", "model"
    config = QUICK.model_copy(update={"vlms": ("mine",)})
    study = run_study(out, config, models={"mine": model})
    rows = of(study, "mine")
    bad = {name: rows[name].error for name in (cut, fewer)}
    assert "cut off before its end" in bad[cut]
    assert "no middle frame" in bad[fewer]
    assert {rows[name].outcome for name in bad} == {"error"}
    assert all(rows[name].outcome == "answered" for name in rows if name not in bad)
    counted = {"answered": len(rows) - 2, "error": 2}
    assert study.info["counts"]["outcomes"]["mine"] == counted
    shown = (out / "report.html").read_text()
    assert "2 failed" in shown
    assert "cut off before its end" in shown


@pytest.mark.parametrize("form", ["json", "prose", "raised"])
def test_whatever_a_model_says_the_study_ends_and_its_page_holds_text_only(folder, form):
    valid = {
        "describe-frame": {"description": HOSTILE},
        "name-aspect": {"reasoning": HOSTILE, "is_ood": True, "aspect": HOSTILE, "confidence": 1},
        "choose-aspect": {"reasoning": HOSTILE, "choice": 1},
        "choose-action": {"reasoning": HOSTILE, "action": "stop"},
    }

    prose = {
        "describe-frame": HOSTILE,
        "name-aspect": f"Yes: {HOSTILE}",
        "choose-aspect": f"Reasoning: {HOSTILE}\nAnswer: 1",
        "choose-action": f"Reasoning: {HOSTILE}\nAnswer: stop",
    }

    def answer(request):
        if form == "raised":
            raise RuntimeError(HOSTILE)
        if form == "prose":
            return prose[request.prompt.purpose]
        return json.dumps(valid[request.prompt.purpose])

    model = ScriptedLLM(answer)
    model.name = f"gpt/{HOSTILE[:60]}"
    config = SMALL.model_copy(update={"vlms": (model.name,)})
    study = run_study(folder, config, models={model.name: model})
    rows = of(study, model.name)
    assert len(rows) == len(asked_about(study))
    assert {row.outcome for row in rows.values()} == {"error" if form == "raised" else "answered"}
    document = html.document_fromstring((folder / "report.html").read_text(encoding="utf-8"))
    top = document.get_element_by_id("top").text_content()
    assert ("gave no answer that can be scored" in top) is (form == "raised")
    assert len(document.xpath("//script")) == 2
    assert not document.xpath("//@*[starts-with(name(), 'on')]")
    assert not document.xpath("//a[starts-with(@href, 'javascript:')] | //img[@src='x']")
    told = _payload(document)["scenes"]
    assert "javascript:alert" in json.dumps(told)


def _payload(document):
    return json.loads(document.get_element_by_id("data").text)


def test_a_judge_named_later_scores_every_open_aspect_alike_and_is_asked_once(folder):
    before = Study.open(folder).verdicts
    said = {
        "describe-frame": {"description": "a road"},
        "name-aspect": {"is_ood": True, "aspect": "something odd"},
        "choose-aspect": {"choice": 1},
        "choose-action": {"action": "stop"},
    }
    seen = ScriptedLLM(said, name="seen")

    broken, questions = True, []

    def says(request):
        questions.append((request.prompt.aspect, request.prompt.path))
        if broken and request.prompt.aspect == "something odd":
            return "?"
        is_odd = request.prompt.aspect == "something odd"
        return {"is_same_thing": is_odd, "is_same_fault": is_odd}

    judge = ScriptedLLM(says, name="judge")
    config = SMALL.model_copy(update={"judge": "judge", "vlms": ("seen",)})
    models = {"seen": seen, "judge": judge}
    first = run_study(folder, config, models=models)
    asked = len(seen.requests)
    board = Leaderboard.parse((folder / "leaderboard.json").read_bytes())
    unjudged = sum(row.identification.unjudged for row in board.standings)
    assert unjudged == sum(bool(verdict.judge_error) for verdict in first.verdicts) > 0
    assert first.info["counts"]["judged"]["matched"] == unjudged
    assert first.info["failures"]["opinions"] == unjudged
    assert first.info["status"] == "incomplete"
    listed = [item for item in read(first).failures if item.stage == "opinions"]
    assert len(listed) == unjudged

    broken = False
    study = run_study(folder, config, models=models, retry=True)
    assert study.info["failures"]["opinions"] == 0
    assert study.info["status"] == "success"
    counted = Counter(question for question in questions if question[0] != "something odd")
    assert set(counted.values()) == {1}
    assert len(seen.requests) == asked
    assert {verdict.model for verdict in study.verdicts} == {*(one.model for one in before), "seen"}
    for verdict in study.verdicts:
        is_open = verdict.is_ood and verdict.aspect and not verdict.is_ordinary
        assert verdict.judge.startswith("judge@") is bool(is_open), verdict.id
        if verdict.model == "seen" and is_open:
            assert verdict.aspect_is_right
    counted = Counter(line["status"] for line in study.store.lines(OPINIONS))
    assert set(counted) == {"ok"}
    assert "judge@" in (folder / "report.html").read_text()


# ------------------------------------------------------------------ models that fail


def judging(*names):
    return SMALL.model_copy(update={"vlms": names})


def by_picture(wrong, fault):
    """Let every question about some pictures go wrong, each time."""

    def faults(index, request):
        shown = request.messages[-1].images if request else ()
        return fault if any(wrong in image.name for image in shown) else None

    return faults


def tally(study, model):
    return study.info["counts"]["outcomes"][model]


@pytest.mark.parametrize(
    ("fault", "outcome"), [("http500", "error"), ("slow", "timeout"), ("filtered", "refused")]
)
def test_items_that_always_fail_cost_themselves_run_after_run(folder, fault, outcome):
    items = len(asked_about(Study.open(folder)))
    wanted = {"answered": items // 2, outcome: items // 2}
    model = ConstantAnswerer("stop")
    with AnsweringServer(model, faults=by_picture("~", fault)) as server:
        for _ in range(1 if fault == "filtered" else 2):
            limits = Limits(strikes=1)
            seconds = 1.0 if fault == "slow" else 60.0
            client = server.client("m", limits=limits, timeout_s=seconds, retries=0)
            study = run_study(folder, judging("m"), models={"m": client}, limits=limits)
            assert tally(study, "m") == wanted
            assert study.info["status"] == "incomplete"
    healthy = of(study, "m")
    assert all((row.outcome == "answered") is not row.is_ordinary for row in healthy.values())
    assert all(
        row.retryable is (outcome != "refused") for row in healthy.values() if row.is_ordinary
    )


def test_a_dead_model_costs_its_own_items_until_it_lives(quick, tmp_path):
    out = shutil.copytree(quick, tmp_path / "out")
    config = QUICK.model_copy(update={"vlms": ("dead", "live")})
    limits = Limits(strikes=1, concurrency=1)
    with AnsweringServer(ConstantAnswerer("stop")) as server:
        dead = server.client("dead", limits=limits, retries=0)
    with AnsweringServer(ConstantAnswerer("stop")) as server:
        live = server.client("live", limits=limits)
        models = {"dead": dead, "live": live}
        study = run_study(out, config, models=models, limits=limits)
        items = len(asked_about(study))
        assert tally(study, "live") == {"answered": items}
        found = tally(study, "dead")
        assert found == {"error": 2, "unasked": items - 2}
        left = [row for row in of(study, "dead").values() if row.outcome == "unasked"]
        assert all(row.retryable and "is given up" in row.error for row in left)
        shown = (out / "report.html").read_text("utf-8")
        assert f"{found['unasked']} not asked" in shown
        models["dead"] = server.client("dead")
        study = run_study(out, config, models=models)
    assert tally(study, "dead") == {"answered": items}
    assert study.info["status"] == "success"


def test_what_was_never_asked_comes_before_what_failed(folder):
    order = []

    def mute(request):
        order.append("old")
        raise LLMError("no", retryable=True)

    def answer(request):
        order.append("new")
        return ConstantAnswerer("stop").complete(request).text

    old, new = ScriptedLLM(mute), ScriptedLLM(answer)
    old.name, new.name = "old", "new"
    run_study(folder, judging("old"), models={"old": old})
    order.clear()
    run_study(folder, judging("old", "new"), models={"old": old, "new": new})
    assert sorted(order) == order
    assert set(order) == {"new", "old"}


def test_a_model_given_up_while_asked_again_keeps_what_is_known_of_its_items(folder):

    def faults(index, request):
        return "http500"

    with AnsweringServer(ConstantAnswerer("stop"), faults=faults) as server:
        client = server.client("m", limits=Limits(patience_s=None), retries=0)
        first = run_study(folder, judging("m"), models={"m": client})
    before = tally(first, "m")
    assert set(before) == {"error"}
    limits = Limits(strikes=1)
    dead = server_gone(limits)
    second = run_study(folder, judging("m"), models={"m": dead}, limits=limits)
    assert tally(second, "m") == before


def server_gone(limits):
    with AnsweringServer(ConstantAnswerer("stop")) as server:
        return server.client("m", limits=limits, retries=0)


def test_an_interruption_keeps_lines_counts_and_the_way_on(folder):
    failing, asked = ScriptedLLM(lambda request: 1 / 0), []
    failing.name = "m"
    run_study(folder, judging("m"), models={"m": failing})
    before = (folder / "verdicts.jsonl").read_bytes()
    lines = before.decode().splitlines()
    lines = [json.dumps({**json.loads(row), "retryable": "@m" in row}) + "\n" for row in lines]
    (folder / "verdicts.jsonl").write_text("".join(lines))

    def interrupt(request):
        asked.append(request)
        raise KeyboardInterrupt

    model = ScriptedLLM(interrupt)
    model.name = "m"
    counts = Study.open(folder).info["counts"]
    with pytest.raises(KeyboardInterrupt):
        run_study(folder, judging("m"), models={"m": model})
    study = Study.open(folder)
    assert study.info["status"] == "stopped"
    assert study.info["counts"] == counts
    assert len(study.verdicts) == len(lines)
    assert {row.outcome for row in of(study, "m").values()} == {"error"}
    assert "the same command continues it" in study.info["stopped"]
    answering = ConstantAnswerer("stop")
    answering.name, answering.kind = "m", "model"
    study = run_study(folder, judging("m"), models={"m": answering})
    assert tally(study, "m") == {"answered": len(asked_about(study))}


def test_a_model_that_fails_when_asked_again_keeps_the_answers_that_it_gave(folder):
    said = {"is_ood": True, "confidence": 0.7, "aspect": "a box", "choice": 1, "action": "fly"}

    def answer(request):
        return {key: said[key] for key in request.schema["properties"] if key in said}

    def fail(request):
        raise LLMError("boom")

    study = run_study(folder, judging("m"), models={"m": scripted("m", answer)})
    before = of(study, "m")
    assert {row.outcome for row in before.values()} == {"unparsed"}
    assert all(row.choice is not None for row in before.values())
    study = run_study(folder, judging("m"), models={"m": scripted("m", fail)}, retry=True)
    assert of(study, "m") == before


def scripted(name, answer):
    model = ScriptedLLM(answer)
    model.name = name
    return model


def test_how_models_are_asked_stays_once_one_has_answered(folder):
    models = {"m": ConstantAnswerer("stop"), "n": ConstantAnswerer("stop")}
    for name, model in models.items():
        model.name, model.kind = name, "model"
    set_to = {"rear_view": True, "chain": True, "ordinary": 2}
    config = judging("m").model_copy(update=set_to)
    run_study(folder, config, models=models)
    files = {name: (folder / name).read_bytes() for name in ("study.json", "verdicts.jsonl")}
    for name, value in {"rear_view": False, "chain": False, "ordinary": 1}.items():
        other = judging("m", "n").model_copy(update={**set_to, name: value})
        with pytest.raises(UsageError, match=f"judged with --{name.replace('_', '-')}"):
            run_study(folder, other, models=models)
        assert files == {name: (folder / name).read_bytes() for name in files}
    run_study(folder, judging("n"), models=models)
    more = judging("n", "m").model_copy(update={"ordinary": 2})
    study = run_study(folder, more, models=models)
    assert len(of(study, "n")) == len(of(study, "m")) == len(asked_about(study))


def test_the_view_to_the_rear_is_shown_where_it_is_asked_for(folder):
    shown = []
    for is_rear in (False, True, True):
        if len(shown) == 1:
            drop_models(Study.open(folder), ["m"])
        asked = []
        model = ScriptedLLM(
            lambda request, asked=asked: asked.append(request) or {"action": "stop"}
        )
        model.name = "m"
        config = judging("m").model_copy(update={"rear_view": is_rear})
        study = run_study(folder, config, models={"m": model})
        pictures = [
            image for request in asked for turn in request.messages for image in turn.images
        ]
        shown.append({picture.name for picture in pictures if picture.name.endswith("rear.jpg")})
    assert shown == [
        set(),
        {f"frames/{one.scene_id}/rear.jpg" for one in asked_about(study)},
        set(),
    ]
    assert not asked
    assert all((folder / name).stat().st_size for name in shown[1])


def test_a_quiz_takes_the_views_to_the_rear_that_a_study_lacks(quick, tmp_path):
    study = Study.open(shutil.copytree(quick, tmp_path / "out"))
    drives = [drive.episode for drive in draw_drives(study, 1)]
    for count in (1, 1, len(drives)):
        with pytest.raises(DataError, match="has no view to the rear"):
            write_quiz(study, scenes=1, rear_view=True)
        take_rear_views(study, drives[:count], RunOptions())
        assert len(study.rear_episodes) == count
    page = write_quiz(study, scenes=1, rear_view=True).read_text()
    items = json.loads(html.fromstring(page).get_element_by_id("payload").text)["items"]
    assert ["rear" in item for item in items] == [True] * len(drives)


def test_a_view_to_the_rear_that_is_not_the_recorded_one_is_taken_again(folder):
    config = judging("m").model_copy(update={"rear_view": True})
    model = ConstantAnswerer("stop")
    model.name, model.kind = "m", "model"
    study = run_study(folder, config, models={"m": model})
    edited, other = study.rear_episodes[0], study.rear_episodes[1]
    shutil.copyfile(folder / other.frames["last"], folder / edited.frames["last"])
    with pytest.raises(DataError, match="is not the recorded frame"):
        write_quiz(study, rear_view=True)
    run_study(folder, config, models={"m": model})
    assert write_quiz(study, rear_view=True).is_file()


def test_a_dead_judge_leaves_the_aspects_to_the_matcher(folder):
    model = ConstantAnswerer("stop")
    model.name, model.kind = "mine", "model"
    limits = Limits(strikes=1)
    config = judging("mine").model_copy(update={"judge": "m"})
    models = {"mine": model, "m": server_gone(limits)}
    study = run_study(folder, config, models=models, limits=limits)
    assert tally(study, "mine") == {"answered": len(asked_about(study))}
    assert study.info["status"] != "stopped"


def test_a_model_is_asked_the_same_questions_without_the_pictures(folder):
    asked = []

    def answer(request):
        asked.append(request)
        return ConstantAnswerer("stop" if request.prompt.frames else "keep_speed").complete(request)

    model = ScriptedLLM(answer, name="m")
    config = SMALL.model_copy(update={"vlms": ("m",), "withheld": ("m",)})
    study = run_study(folder, config, models={"m": model})
    items = {one.id for one in asked_about(study)}
    seeing, blind = of(study, "m"), of(study, "m without pictures")
    assert set(seeing) == set(blind) == items
    assert {row.action for row in seeing.values()} == {"stop"}
    assert {row.action for row in blind.values()} == {"keep_speed"}
    kinds = Counter((bool(one.prompt.withheld), one.prompt.purpose) for one in asked)
    assert set(kinds) == {
        (is_blind, purpose)
        for is_blind in (False, True)
        for purpose in ("name-aspect", "choose-aspect", "choose-action")
    }
    shown = {one.messages[-1].text for one in asked if not one.prompt.withheld}
    for one in asked:
        if one.prompt.withheld:
            assert not any(message.images for message in one.messages)
            said, _, question = one.messages[-1].text.partition("\n\n")
            assert "No picture" in said
            assert question in shown

    board = Leaderboard.load(folder / "leaderboard.json")
    gains = board.standing("m").paired.over_withheld
    assert {gain.against for gain in gains} == {"m without pictures"}
    assert not any(
        "without pictures" in (comparison.first + comparison.second)
        for comparison in board.comparisons
    )
    assert [requirement.name for requirement in study.requirements("safe>=0.1")] == ["m"]
    before = len(asked)
    assert run_study(folder, config, models={"m": model}).verdicts == study.verdicts
    assert len(asked) == before
    drop_models(study, ["m without pictures"])
    assert Study.open(folder).config.withheld == ()
    assert not of(Study.open(folder), "m without pictures")
    assert set(of(Study.open(folder), "m")) == items


def test_calls_that_failed_by_a_fault_of_the_class_are_made_again_on_request(folder):
    config = SMALL.model_copy(update={"vlms": ("m",)})
    faulty = ScriptedLLM(lambda request: 1 / 0, name="m")
    mended = ScriptedLLM(lambda request: ConstantAnswerer("stop").complete(request), name="m")
    assert {
        row.outcome for row in of(run_study(folder, config, models={"m": faulty}), "m").values()
    } == {"error"}
    again = run_study(folder, config, models={"m": mended}, retry=True)
    assert {row.outcome for row in of(again, "m").values()} <= {"answered", "unavailable"}
    assert again.info["failures"]["verdicts"] == 0


def test_what_follows_from_the_answers_is_computed_anew(small, tmp_path):
    """Every verdict of a reference is edited, each in another field, and none survives."""
    folder = shutil.copytree(small, tmp_path / "out")
    file, board = folder / "verdicts.jsonl", folder / "leaderboard.json"
    before = file.read_bytes(), board.read_bytes()
    edits = [
        {"success": None, "action_is_safe": None},
        {"choice_is_right": None},
        {"action": "pull_over"},
        {"is_ood": None},
        {"aspect_is_right": None, "thing_is_right": None},
        {"is_ordinary": None},
        {"status": "failed", "outcome": "error"},
        {"model": "other"},
        {"kind": "model"},
        {"reasoning": "mine", "contradiction": "mine"},
    ]
    rows = [json.loads(line) for line in before[0].splitlines()]
    for number, row in enumerate(rows):
        for name, value in edits[number % len(edits)].items():
            row[name] = not row[name] if value is None else value
    Study.open(folder).store.write_lines("verdicts.jsonl", rows)
    run_study(folder, Study.open(folder).config)
    assert (file.read_bytes(), board.read_bytes()) == before

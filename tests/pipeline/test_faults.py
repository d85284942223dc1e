"""A study survives a hostile server, caps, kills and a dead endpoint; no key leaves a trace."""

import json
import random
import shutil
import threading
from collections import Counter
from concurrent.futures import Executor, Future
from contextlib import suppress
from urllib.parse import quote

import pytest
from click.testing import CliRunner

from oodscen import Study, make_llm
from oodscen._cli import main
from oodscen._pipeline import RunOptions, estimate, run_study
from oodscen.errors import BudgetExceeded, EndpointDown, LLMError
from oodscen.llm._remote.budget import Price
from oodscen.llm._remote.limits import Limits
from oodscen.llm._wrapper import WrappingLLM
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.llm.rogue import dripping, talking
from tests.pipeline.quick import QUICK, SMALL

PATIENCE_S = 60.0
KEY = "sk-test-planted-0123456789abcdef"
CONFIG = QUICK.model_copy(update={"llm": "served", "demands": False, "sets": ()})
FAULTS = (
    "http429 http500 http503 reset slow truncated wrong_schema malformed html empty huge packed cut"
).split()
RESULTS = ("tree.simulatable.json", "scenarios.jsonl", "scenes.jsonl", "redteam.jsonl")


class Remembering(Executor):
    """Runs the same scenes once: no server has a say in what they give."""

    def __init__(self):
        self.results = {}

    def submit(self, function, /, *arguments):
        order, future = repr(arguments), Future()
        if order not in self.results:
            self.results[order] = function(*arguments)
        future.set_result(self.results[order])
        return future


SIMULATED = Remembering()


@pytest.fixture(autouse=True)
def planted_key(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


@pytest.fixture(scope="module")
def author():
    return make_llm("builtin", seed=3)


@pytest.fixture(scope="module")
def quiet(tmp_path_factory, author):
    """Run undisturbed."""
    out = tmp_path_factory.mktemp("quiet") / "out"
    with AnsweringServer(author) as server:
        models = {"served": server.client(seed=3)}
        run_study(out, CONFIG, models=models, executor=SIMULATED)
    return out


def run(out, server, limits=None, **settings):
    limits = limits or Limits(concurrency=4)
    llm = server.client(seed=3, limits=limits, **settings)
    return run_study(out, CONFIG, models={"served": llm}, limits=limits, executor=SIMULATED)


def results(out):
    return {name: (out / name).read_bytes() for name in RESULTS}


def assert_clean(out):
    for path in out.rglob("*"):
        if path.is_file():
            assert KEY.encode() not in path.read_bytes(), path.name


def test_faults_cost_at_most_their_own_items(tmp_path, author, quiet):
    draw = random.Random(2)
    is_spoilt = False

    def faults(index, request):
        # Never two in a row: a round of the red team that is lost leads to another tree and other texts.
        nonlocal is_spoilt
        is_spoilt = not is_spoilt and draw.random() < 0.6
        return draw.choice(FAULTS) if is_spoilt else None

    with AnsweringServer(author, faults=faults) as server:
        study = run(tmp_path, server, timeout_s=1.0, max_bytes=1_000_000)
    assert study.info["status"] in ("success", "incomplete")
    wanted = {line["id"]: line for line in Study.open(quiet).table("scenarios")}
    for line in study.table("scenarios"):
        assert line.get("status") == "failed" or line == wanted[line["id"]]
    usage = study.info["usage"]
    assert sum(row["retries"] for row in usage) > 5
    assert_clean(tmp_path)


KEYS = {"X_JWT": "Zq7x+9/K", "A_TOKEN": "k3y-0f-thirt!", "OPENAI_API_KEY": KEY + "Zq7x+9K8"}


def test_keys_that_a_server_repeats_are_in_no_file_output_or_foreign_request(
    tmp_path, author, monkeypatch, capfd
):
    for name, key in KEYS.items():
        monkeypatch.setenv(name, key)
    forms = {key: (key, json.dumps(key)[1:-1], quote(key, safe="")) for key in KEYS.values()}
    forms = {form.encode() for found in forms.values() for form in found}
    told = " and ".join(form.decode() for form in forms)

    def repeat(request):
        text = author.complete(request).text
        if request.sample % 5 == 4:
            raise LLMError(f"your keys are {told}")
        return text.replace('"text": "', f'"text": "{KEYS["X_JWT"]} ') + f" Your keys are {told}."

    def faults(index, request):
        return "redirect" if index % 9 == 8 else None

    with (
        talking(dripping(b"HTTP/1.1 200 OK\r\n\r\n", b" ")) as proxy,
        AnsweringServer(ScriptedLLM(repeat), faults=faults) as server,
    ):
        monkeypatch.setenv("http_proxy", f"http://127.0.0.1:{proxy.port}")
        study = run(tmp_path, server, Limits(concurrency=4, patience_s=None), retries=0)
    assert b"[redacted]" in (tmp_path / "answers.jsonl").read_bytes()
    assert any("redirects to" in (call.get("error") or "") for call in study.table("calls"))
    hosts = {received.headers["host"].partition(":")[0] for received in server.received}
    assert (hosts, proxy.heard) == ({"127.0.0.1"}, b"")
    files = {path.name: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    files["output"] = "".join(capfd.readouterr()).encode()
    files["questions"] = json.dumps([received.body for received in server.received]).encode()
    assert not [(name, form) for name, data in files.items() for form in forms if form in data]


@pytest.mark.parametrize("purpose", ["imagine-scenario", "judge-branches", "describe-path"])
def test_an_interruption_leaves_no_question_to_be_waited_for(tmp_path, author, purpose):
    limits = Limits(concurrency=2)
    together = threading.Barrier(2)

    class Interrupted(WrappingLLM):
        def complete(self, request):
            if request.prompt.purpose != purpose:
                return self._llm.complete(request)
            if together.wait(PATIENCE_S) == 0:
                raise KeyboardInterrupt
            limits.sleep(PATIENCE_S)
            limits.check()
            raise AssertionError("nobody was told of the interruption")

    config = CONFIG.model_copy(update={"in_flight": 2})
    with pytest.raises(KeyboardInterrupt):
        run_study(tmp_path, config, models={"served": Interrupted(author)}, limits=limits)
    assert Study.open(tmp_path).info["status"] == "stopped"
    assert not together.broken


def test_an_interruption_of_the_very_end_leaves_the_study_stopped(small, tmp_path, monkeypatch):
    out = shutil.copytree(small, tmp_path / "study")

    def interrupt(study):
        monkeypatch.undo()
        raise KeyboardInterrupt

    monkeypatch.setattr("oodscen._pipeline.pipeline.write_report", interrupt)
    with pytest.raises(KeyboardInterrupt):
        run_study(out, SMALL)
    assert Study.open(out).info["status"] == "stopped"


def test_a_cap_ends_the_run_and_the_same_command_continues_it(tmp_path, author, quiet):
    asked = []
    for _ in range(10):
        with AnsweringServer(author) as server, suppress(BudgetExceeded):
            run(tmp_path, server, Limits(requests=25, concurrency=4))
        asked += [json.dumps([r.messages, r.body["seed"]]) for r in server.received]
        if (status := Study.open(tmp_path).info["status"]) == "success":
            break
        assert (status, len(server.received)) == ("stopped", 25)
        assert "This run stopped" in (tmp_path / "report.html").read_text("utf-8")
    assert results(tmp_path) == results(quiet)
    assert len(asked) == len(set(asked)) == len(Study.open(quiet).table("calls"))


def test_a_refused_key_ends_the_run_and_no_item_is_lost(tmp_path, author, quiet):
    with (
        AnsweringServer(
            author, faults=lambda index, request: "http401" if index > 12 else None
        ) as server,
        pytest.raises(EndpointDown) as caught,
    ):
        run(tmp_path, server)
    assert KEY not in str(caught.value)
    assert len(server.received) <= 13 + 4
    assert_clean(tmp_path)
    with AnsweringServer(author) as server:
        run(tmp_path, server)
    assert results(tmp_path) == results(quiet)


def test_items_without_an_answer_are_done_again_and_no_others(tmp_path, author, quiet):
    def faults(index, request):
        return "http500" if request and request.prompt.purpose == "stage-scene" else None

    with AnsweringServer(author, faults=faults) as server:
        study = run(tmp_path, server, retries=0)
    assert study.info["failures"]["scenes"] == 2
    assert all(line["retryable"] for line in study.failures("scenes"))
    with AnsweringServer(author) as server:
        study = run(tmp_path, server)
    assert study.info["status"] == "success"
    assert all(r.messages[-1]["content"].startswith("Text: ") for r in server.received)
    assert results(tmp_path) == results(quiet)


def test_a_scene_whose_claims_got_no_answer_is_made_when_they_are_read(tmp_path, author, quiet):
    def faults(index, request):
        return "http500" if request and request.prompt.purpose == "extract-claims" else None

    with AnsweringServer(author, faults=faults) as server:
        study = run(tmp_path, server, retries=0)
    assert all(line["retryable"] for line in study.failures("scenes"))
    assert study.info["failures"]["scenes"] == 2
    with AnsweringServer(author) as server:
        study = run(tmp_path, server)
    assert study.info["status"] == "success"
    assert results(tmp_path) == results(quiet)


def test_a_study_can_be_replayed(tmp_path, quiet):
    config = CONFIG.model_copy(update={"llm": f"replay:{quiet / 'answers.jsonl'}"})
    study = run_study(tmp_path, config, executor=SIMULATED)
    assert study.info["status"] == "success"
    assert results(tmp_path) == results(quiet)
    assert not (tmp_path / "answers.jsonl").exists()


def test_calls_name_their_stage(quiet):
    study = Study.open(quiet)
    assert {line["stage"] for line in study.table("calls")} == {
        "grow",
        "redteam",
        "prune",
        "describe",
        "augment",
    }
    assert [row["group"][0] for row in study.info["usage"]] == [
        "grow",
        "redteam",
        "prune",
        "describe",
        "augment",
    ]


def test_an_estimate_counts_the_calls_that_are_left(tmp_path, quiet):
    prices = Limits(prices={"served": Price(1, 1)})
    options = RunOptions(models={"served": ScriptedLLM({})}, limits=prices)
    rows = estimate(tmp_path / "none", CONFIG, options)
    made = Study.open(quiet).info["usage"]
    assert [(row.group[0], row.calls) for row in rows] == [
        (row["group"][0], row["calls"]) for row in made
    ]
    for row, real in zip(rows, made, strict=True):
        assert row.input_tokens == pytest.approx(real["input_tokens"], rel=0.05)
        assert row.cost_usd == pytest.approx((row.input_tokens + row.output_tokens) / 1e6)
    assert estimate(quiet, CONFIG, options) == []
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("frames", [3, 4])
def test_an_estimate_counts_the_calls_of_both_protocols(small, tmp_path, frames):
    out = tmp_path / "study"
    if frames == SMALL.frames:
        shutil.copytree(small, out)
    answers = {
        "describe-frame": {"description": "a road"},
        "name-aspect": {"is_ood": True, "aspect": "something odd", "confidence": 0.8},
        "name-ood-aspect": {"aspect": "something odd"},
        "choose-aspect": {"choice": 1},
        "choose-action": {"reasoning": "", "action": "stop"},
    }
    models = {name: ScriptedLLM(answers, name=name) for name in ("both", "paper")}
    changes = {"protocols": ("ours", "paper"), "asked": {"paper": ("paper",)}, "frames": frames}
    config = SMALL.model_copy(update={"vlms": (*models,), **changes})
    rows = estimate(out, config, RunOptions(models=models))
    calls = {row.group[1]: row.calls for row in rows if row.group[0] == "evaluate"}
    study = run_study(out, config, models=models)
    asked = Counter(line["model"] for line in study.store.lines("calls.jsonl"))
    assert calls == {name: asked[name] for name in models}
    assert estimate(out, config, RunOptions(models=models)) == []


def test_an_estimate_counts_what_will_be_asked_again(small, tmp_path):
    def gone(request):
        raise LLMError("boom", retryable=True)

    out = shutil.copytree(small, tmp_path / "study")
    config = SMALL.model_copy(update={"vlms": ("gone", "there")})
    answers = {"is_ood": True, "aspect": "x", "confidence": 0.8, "choice": 1, "action": "stop"}

    def answer(request):
        return {key: answers[key] for key in request.schema["properties"] if key in answers}

    models = {"gone": ScriptedLLM(gone, name="gone"), "there": ScriptedLLM(answer, name="there")}
    study = run_study(out, config, models=models)
    items = len({verdict.scene_id for verdict in study.verdicts if verdict.model == "gone"})
    rows = estimate(out, config, RunOptions(models=models))
    assert [(row.group[1], row.calls) for row in rows] == [("gone", 3 * items)]
    verdicts = [
        {**line, "made_from": "other drives"} for line in study.store.lines("verdicts.jsonl")
    ]
    study.store.write_lines("verdicts.jsonl", verdicts)
    rows = estimate(out, config, RunOptions(models=models))
    assert {row.group[1]: row.calls for row in rows} == {"gone": 3 * items, "there": 3 * items}


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_the_command_line_says_how_to_give_a_price(tmp_path, quiet):
    quick = ["--quick", "--simulator", "flat", "--encoder", "hash", "--workers", "1"]
    server = ["--llm", "m", "--api-base", "http://127.0.0.1:1/v1"]
    result = call("run", tmp_path / "a", *quick, *server, "--max-cost", "1")
    assert result.exit_code == 2
    assert "--price m=" in result.output
    result = call("run", tmp_path / "b", *quick, *server, "--max-requests", "0")
    assert result.exit_code == 3
    assert "the same command continues" in result.output
    result = call("run", tmp_path / "c", *quick, *server, "--dry-run", "--price", "m=1,2")
    assert result.exit_code == 0
    assert "$" in result.output
    assert call("run", tmp_path / "c", "--price", "m=cheap").exit_code == 2


@pytest.mark.parametrize(
    "words",
    [
        ["--llm", ""],
        ["--llm", "no-such-model"],
        ["--llm", "replay:nowhere.jsonl"],
        ["--red-llm", " "],
        ["--fallback", "no-such-model"],
        ["--vlm", ""],
        ["--vlm", "no_such_module:Model"],
        ["--judge", "no-such-model"],
        *([option, KEY] for option in ("--llm", "--red-llm", "--fallback", "--judge")),
        ["--vlm", KEY, "--api-base", "http://127.0.0.1:1/v1"],
        ["--made", "--recogniser", KEY],
        ["--rarity-llm", f"openai/{KEY}"],
        ["--encoder", KEY],
        ["--llm", "m", "--api-base", ""],
        ["--llm", "m", "--api-base", "file:///etc/passwd"],
        ["--vlm", "m", "--api-base", "127.0.0.1:8000/v1"],
        ["--vlm", "m", "--api-base", "http://:80/v1"],
        ["--vlm", "m", "--api-base", "http://127.0.0.1:99999/v1"],
        ["--vlm", "m", "--api-base", "http://127.0.0.1:1/v1", "--max-cost", "1"],
        ["--vlm", "m", "--api-base", "http://203.0.113.1/v1"],
        ["--simulator", "no-such-simulator"],
        ["--encoder", "no-such-encoder"],
    ],
)
def test_a_dry_run_refuses_what_a_run_refuses(tmp_path, words):
    quick = ["--quick", "--simulator", "flat", "--encoder", "hash", "--workers", "1"]
    for more in (["--dry-run"], []):
        result = call("run", tmp_path / "out", *quick, *words, *more)
        assert (result.exit_code, result.output.count("oodscen: ")) == (2, 1)
        assert "_StandIn" not in result.output
        assert KEY not in result.output
    assert not (tmp_path / "out").exists()


def test_doctor_asks_a_model_two_questions(author):
    from oodscen._doctor import examine_llm
    from oodscen.testing import ScriptedLLM

    def answer(asked):
        if asked.prompt.purpose == "describe-frame":
            return {"description": "A red square."}
        return {"text": "A grand piano lies across the ego vehicle's lane."}

    import oodscen._registry as registry

    with AnsweringServer(ScriptedLLM(answer)) as server, pytest.MonkeyPatch.context() as patch:
        patch.setattr(registry, "make_llm", lambda name, **more: server.client(name))
        found = {item.what: item for item in examine_llm("gpt-4o")}
    assert all(item.is_ok for item in found.values())
    assert "valid at once" in found["answer"].detail
    assert "sees it" in found["image"].detail
    assert len(server.received[1].images) == 1
    with AnsweringServer(ScriptedLLM(answer), faults=lambda i, r: "http401") as server:
        result = call("doctor", "llm", "m", "--api-base", server.api_base)
    assert result.exit_code == 1
    assert KEY not in result.output
    assert "price: not known" in result.output

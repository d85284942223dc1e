import json
import shutil

import pytest
from click.testing import CliRunner

import oodscen._pipeline.models as models
from oodscen import Study
from oodscen._cli import main
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.testing import AnsweringServer


def test_models_on_other_servers_than_the_author_s_are_judged(small, tmp_path, monkeypatch) -> None:
    out = shutil.copytree(small, tmp_path / "out")
    make, addresses = models.make_llm, {}

    def announced(name, *, api_base=None, **more):
        """Make the client that tells the server what it is about to ask; it goes where it was told to."""
        if api_base is None:
            return make(name, **more)
        addresses[name] = api_base
        return server.client(name, api_base=api_base)

    monkeypatch.setattr(models, "make_llm", announced)
    with AnsweringServer(ConstantAnswerer("stop")) as server:
        order = ["evaluate", str(out), "--vlm", "one", "--api-base", server.api_base]
        assert CliRunner().invoke(main, order).exit_code == 0
        asked = len(server.received)
        again = ["evaluate", str(out), "--vlm", "one"]
        assert CliRunner().invoke(main, again).exit_code == 0
        assert len(server.received) == asked
        assert addresses == {"one": server.api_base}
    judged = [verdict for verdict in Study.open(out).verdicts if verdict.model == "one"]
    assert {verdict.outcome for verdict in judged} <= {"answered", "unavailable"}
    assert len(judged) == 2 == asked / 3


FAILING = """
class Failing:
    name = "one of mine"
    def complete(self, request):
        raise ValueError("no")
"""


def test_items_that_failed_before_count_as_long_as_their_model_is_named(
    small, tmp_path, monkeypatch
) -> None:
    out = shutil.copytree(small, tmp_path / "out")
    (tmp_path / "vlm_failing.py").write_text(FAILING)
    monkeypatch.chdir(tmp_path)
    order = ["evaluate", str(out), "--vlm", "vlm_failing:Failing"]
    assert [CliRunner().invoke(main, order).exit_code for _ in range(2)] == [1, 1]
    assert CliRunner().invoke(main, ["evaluate", str(out), "--vlm", "random"]).exit_code == 0


@pytest.mark.parametrize("option", ["--vlm", "--judge"])
def test_a_key_in_place_of_a_model_s_name_is_refused_before_a_model_is_taken_out(
    small, tmp_path, monkeypatch, option
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "kEy-13chars!")
    out = shutil.copytree(small, tmp_path / "out")
    assert CliRunner().invoke(main, ["evaluate", str(out), "--vlm", "random"]).exit_code == 0
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    order = ["evaluate", str(out), "--drop", "random", option, "openai/kEy-13chars!"]
    refused = CliRunner().invoke(main, order)
    assert (refused.exit_code, refused.output.count("oodscen: ")) == (2, 1)
    assert "holds a key" in refused.output
    assert "kEy-13chars!" not in refused.output
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


def test_an_estimate_writes_nothing(small, tmp_path) -> None:
    out = shutil.copytree(small, tmp_path / "out")
    before = {path: path.stat().st_mtime_ns for path in (out, *out.rglob("*"))}
    found = CliRunner().invoke(
        main,
        ["evaluate", str(out), "--vlm", "local", "--api-base", "http://127.0.0.1:9", "--dry-run"],
    )
    assert found.exit_code == 0, found.output
    assert {path: path.stat().st_mtime_ns for path in (out, *out.rglob("*"))} == before


def test_a_report_says_what_it_could_not_read(small, tmp_path) -> None:
    out = shutil.copytree(small, tmp_path / "out")
    (out / "pruned.jsonl").write_text("[1, 2]\n")
    found = CliRunner().invoke(main, ["report", str(out)])
    assert found.exit_code == 0
    assert "pruned.jsonl" in found.stderr
    assert found.stdout == f"{(out / 'report.html').resolve()}\n"


def test_power_says_how_many_scenes_it_takes() -> None:
    found = CliRunner().invoke(main, ["power", "0.66", "0.51", "--per-path", "10", "--icc", "0.2"])
    assert found.exit_code == 0
    assert "480 scenes = 48 paths of 10" in found.output
    machine = CliRunner().invoke(main, ["power", "0.66", "0.51", "--unpaired", "--json"])
    assert json.loads(machine.output)["independent"] == 169


def test_power_of_a_given_number() -> None:
    found = CliRunner().invoke(main, ["power", "0.66", "0.51", "--scenes", "130", "--icc", "0"])
    assert found.output == "130 scenes can show that difference with a power of 68%\n"
    one = CliRunner().invoke(main, ["power", "0.66", "0.51", "--scenes", "1"])
    assert one.output == "1 scene can show that difference with a power of 4%\n"
    close = ["power", "0.66", "0.6601", "--scenes", "3000000"]
    assert CliRunner().invoke(main, close).exit_code == 0


@pytest.mark.parametrize("rates", [["0.5", "0.5"], ["0", "0.5"], ["0.5", "1.5"]])
def test_what_cannot_be_told_apart_exits_with_2(rates: list[str]) -> None:
    assert CliRunner().invoke(main, ["power", *rates]).exit_code == 2


def test_a_power_that_is_wanted_and_one_that_is_asked_for_contradict_each_other() -> None:
    found = CliRunner().invoke(main, ["power", "0.66", "0.51", "--power", "0.8", "--scenes", "10"])
    assert found.exit_code == 2
    assert "--power" in found.output


def test_a_limit_that_is_not_reached_is_told_apart_from_the_value() -> None:
    found = CliRunner().invoke(main, ["power", "0.66", "0.51", "--alpha", "0.9999999999999999"])
    assert found.exit_code == 2
    assert "from 1e-09 to 0.999999999, not 0.9999999999999999" in found.output

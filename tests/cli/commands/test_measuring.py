"""`oodscen score`: which model was asked, how often, and what it did not answer."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen.metrics._rarity.rates import published_rates
from oodscen.protocols import Completion, Request, Usage
from tests.pipeline.quick import ORDINARY

SCORE = ["score", "t.txt", "--encoder", "hash", "--baseline", str(ORDINARY)]
ENTRY = {"unit": "log10 km", "low": 4, "best": 5, "high": 6}


class Author:
    name = "author"

    def complete(self, request: Request) -> Completion:
        entries = [{"number": number, **ENTRY} for number, _ in enumerate(request.prompt.texts, 1)]
        return Completion(text=json.dumps({"estimates": entries}), usage=Usage(input_tokens=10))


class Mute:
    name = "mute"

    def complete(self, request: Request) -> Completion:
        return Completion(text="About once in a blue moon.", usage=Usage(input_tokens=15))


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("model", "calls", "words"),
    [
        ("Author", 3, ("once in 10^5.0 km", "by author; 30 tokens")),
        ("Mute", 9, ("unknown for all of 2 texts", "by mute; not answered for 2; 135 tokens")),
    ],
)
def test_the_model_that_was_asked_is_named_with_its_calls(model, calls, words):
    Path("t.txt").write_text("A sofa lies on the road.\nA deer runs across the road.\n")
    order = [*SCORE, "--llm", f"{__name__}:{model}"]
    result = CliRunner().invoke(main, order)
    assert result.exit_code == 0, result.output
    (rarity,) = [line for line in result.stdout.splitlines() if line.startswith("rarity")]
    assert all(part in rarity for part in words)
    assert result.stdout.splitlines()[-1].split() == ["calls", str(calls), "of", model.lower()]
    assert json.loads(CliRunner().invoke(main, [*order, "--json"]).stdout)["n"] == 2


def test_rates_that_the_model_does_not_answer_are_told():
    Path("t.txt").write_text("A sofa lies on the road.\n")
    order = [*SCORE, "--anchors", "published", "--llm", f"{__name__}:Mute"]
    said = CliRunner().invoke(main, order).stdout
    rates = len(published_rates())
    assert f"not calibrated, as none of {rates} rates has a figure for each wording" in said
    rarity = json.loads(CliRunner().invoke(main, [*order, "--json"]).stdout)["rarity"]
    assert rarity["unanswered_rates"] == rates
    assert rarity["calibration"] is None


def test_without_a_model_no_calls_are_told():
    Path("t.txt").write_text("A sofa lies on the road.\n")
    result = CliRunner().invoke(main, SCORE)
    assert "calls" not in result.stdout

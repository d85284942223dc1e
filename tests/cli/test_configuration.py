import re
import shlex
import tomllib
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from oodscen._cli import main
from oodscen._cli.configuration import RUN_SECTIONS, commented, options_of, read_configuration
from oodscen._cli.study import run
from oodscen.errors import DataError

OPTIONS = options_of(run)
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)


def invoke(*order, **settings):
    return CliRunner().invoke(main, [str(one) for one in order], **settings)


def read(text, folder):
    file = folder / "run.toml"
    file.write_text(text, encoding="utf-8")
    return read_configuration(file, click.Context(run))


def uncommented(text):
    return re.sub(r"^# (?=[a-z-]+ = )", "", text, flags=re.MULTILINE)


def test_every_option_of_run_has_its_section_and_can_stand_in_a_file(tmp_path, monkeypatch):
    listed = [name for names in RUN_SECTIONS.values() for name in names]
    assert sorted(listed) == sorted([*OPTIONS, "config", "help"])
    monkeypatch.chdir(tmp_path)
    Path("texts.txt").write_text("A car waits.\n")
    whole = uncommented(commented(run, {}))
    assert set(tomllib.loads(whole)) == set(OPTIONS)
    assert set(read(whole, tmp_path)) == {option.name for option in OPTIONS.values()}


@given(llm=texts, vlms=st.lists(texts, min_size=1, max_size=3), quick=st.booleans())
def test_chosen_values_are_read_as_they_were_given(llm, vlms, quick):
    chosen = {"llm": llm, "vlm": vlms, "quick": quick}
    assert tomllib.loads(commented(run, chosen)) == chosen


def test_the_command_line_wins_over_the_file(tmp_path):
    file = tmp_path / "run.toml"
    file.write_text(
        'quick = true\nnodes = 30\nband = [0.2, 0.3]\nvlm = ["a", "b"]\nprice = "a=1,2"\n'
        'llm = "my-model"\napi_base = "http://localhost:1"\ntwins = false\nvideo = "ego"\n'
    )
    order = [str(tmp_path / "out"), "--config", str(file)]
    found = run.make_context("run", [*order]).params
    expected = {
        **{"quick": True, "nodes": 30, "band": (0.2, 0.3), "vlms": ("a", "b"), "twins": False},
        **{"prices": ("a=1,2",), "llm": "my-model", "api_base": "http://localhost:1"},
        **{"video": "ego", "seed": 0, "out": tmp_path / "out"},
    }
    assert {name: found[name] for name in expected} == expected
    other = ["--llm", "other", "--twins", "--vlm", "c", "--nodes", "40", "--band", "0", "1"]
    for words in ([*other, *order], [*order, *other]):
        found = run.make_context("run", words).params
        assert (found["llm"], found["twins"], found["nodes"]) == ("other", True, 40)
        assert (found["vlms"], found["band"], found["quick"]) == (("c",), (0.0, 1.0), True)


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        ("per-paht = 3", "per-paht", "did you mean per-path"),
        ("config = 'x'", "config", "is not an option"),
        ("seed = 1.5", "seed", "not a valid integer"),
        ("seed = true", "seed", "must be a number"),
        ("nodes = 1", "nodes", "not in the range"),
        ("llm = 3", "llm", "must be a text"),
        ("quick = 1", "quick", "must be true or false"),
        ("band = 0.3", "band", "list of 2"),
        ("band = [0.3]", "band", "2 values"),
        ("vlm = [1]", "vlm", "must be a text"),
        ("style = 'loud'", "style", "is not one of"),
        ("baseline = 'nowhere'", "baseline", "does not exist"),
        ("max-cost = nan", "max-cost", "finite"),
        ("[run]\nseed = 1", "run", "is not an option"),
        ("max-paths = 3\nmax_paths = 2", "max_paths", "another spelling"),
        ("seed = ", "", "is not TOML"),
        ("a = " + "[" * 9_000, "", "is not TOML"),
    ],
)
def test_a_fault_in_a_file_is_named(text, path, words, tmp_path):
    with pytest.raises(DataError) as caught:
        read(text, tmp_path)
    (issue,) = caught.value.issues
    assert issue.path == path
    assert words in issue.message
    assert caught.value.source == str(tmp_path / "run.toml")


def test_all_faults_come_at_once(tmp_path):
    with pytest.raises(DataError) as caught:
        read("nodse = 3\nseed = -1\nquick = 'yes'", tmp_path)
    assert [issue.path for issue in caught.value.issues] == ["nodse", "seed", "quick"]


def test_init_takes_defaults_in_a_pipe_and_keeps_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert invoke("init").exit_code == 0
    assert tomllib.loads(Path("run.toml").read_text()) == {"llm": "builtin", "quick": False}
    refused = invoke("init", "--quick")
    assert refused.exit_code == 2
    assert "--force" in refused.stderr
    assert invoke("init", "--quick", "--vlm", "a", "--vlm", "b", "--force").exit_code == 0
    assert tomllib.loads(Path("run.toml").read_text()) == {
        "llm": "builtin",
        "vlm": ["a", "b"],
        "quick": True,
    }


@pytest.mark.parametrize("name", ["sp ace.toml", "it's.toml", "$HOME;x.toml"])
def test_the_line_that_init_prints_can_be_pasted(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = invoke("init", "-o", name, "--quick").stderr
    words = shlex.split(line.partition("start with: ")[2])
    assert words == ["oodscen", "run", "OUT", "--config", name]


@pytest.mark.parametrize("order", [("init", "-o"), ("grow", "--llm", "nobody", "-o")])
def test_a_dash_is_no_file(order, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = invoke(*order, "-")
    assert done.exit_code == 2
    assert "/dev/stdout" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_init_writes_through_a_device_and_tells_no_file():
    done = invoke("init", "-o", "/dev/null", "--quick")
    assert (done.exit_code, done.output) == (0, "")


def test_init_refuses_names_that_are_no_text(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("oodscen._cli.configuration.is_terminal", lambda: True)
    monkeypatch.setattr("click.prompt", lambda *_, **__: "model-\udcff")
    done = invoke("init", "--quick")
    assert done.exit_code == 2
    assert "is not valid UTF-8" in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["", " ", "a\nb", "a "])
@pytest.mark.parametrize("option", ["--llm", "--vlm"])
def test_init_refuses_names_that_no_run_would_take(tmp_path, monkeypatch, option, name):
    monkeypatch.chdir(tmp_path)
    done = invoke("init", "--quick", option, name)
    assert done.exit_code == 2
    assert "the model" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_init_asks_three_questions_in_a_terminal(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("oodscen._cli.configuration.is_terminal", lambda: True)
    done = invoke("init", input="gpt-4o\nmodel-a, model-b\ny\n")
    assert done.exit_code == 0, done.output
    assert tomllib.loads(Path("run.toml").read_text()) == {
        "llm": "gpt-4o",
        "vlm": ["model-a", "model-b"],
        "quick": True,
    }


@pytest.mark.parametrize("option", ["--llm", "--vlm"])
def test_init_writes_no_key(tmp_path, monkeypatch, option):
    monkeypatch.setenv("OPENAI_API_KEY", "kq7ZpWm3xT9bKEYQQ")
    file = tmp_path / "run.toml"
    for key in ("sk-proj-AbCdEfGhIjKlMnOpQrSt", "kq7ZpWm3xT9bKEYQQ", "openai/kq7ZpWm3xT9bKEYQQ"):
        found = invoke("init", option, key, "-o", file)
        assert (found.exit_code, found.output.count("\n")) == (2, 1), found.output
        assert "looks like a key" in found.output
        assert key not in found.output
        assert not file.exists()
    assert invoke("init", option, "openai/gpt-4o", "-o", file).exit_code == 0

import shlex
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from oodscen._cli import main
from oodscen._cli.commands.init import commented
from oodscen._cli.commands.study import run

texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)


def invoke(*order, **settings):
    return CliRunner().invoke(main, [str(word) for word in order], **settings)


@given(llm=texts, vlms=st.lists(texts, min_size=1, max_size=3), quick=st.booleans())
def test_chosen_values_are_read_as_they_were_given(llm, vlms, quick):
    chosen = {"llm": llm, "vlm": vlms, "quick": quick}
    assert tomllib.loads(commented(run, chosen)) == chosen


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
    monkeypatch.setattr("oodscen._cli.commands.init.is_terminal", lambda: True)
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
    monkeypatch.setattr("oodscen._cli.commands.init.is_terminal", lambda: True)
    done = invoke("init", input="gpt-4o\nmodel-a, model-b\ny\n")
    assert done.exit_code == 0, done.output
    assert tomllib.loads(Path("run.toml").read_text()) == {
        "llm": "gpt-4o",
        "vlm": ["model-a", "model-b"],
        "quick": True,
    }


@pytest.mark.parametrize(
    ("typed", "name"), [(" gpt-4o ", "gpt-4o"), (" ", "builtin"), ("", "builtin")]
)
def test_blanks_around_a_typed_name_do_not_count(tmp_path, monkeypatch, typed, name):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("oodscen._cli.commands.init.is_terminal", lambda: True)
    done = invoke("init", "--quick", input=f"{typed}\n {typed} , \n")
    assert done.exit_code == 0, done.output
    chosen = tomllib.loads(Path("run.toml").read_text())
    assert (chosen["llm"], chosen.get("vlm", [])) == (name, [typed.strip()] * bool(typed.strip()))


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

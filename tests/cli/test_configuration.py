import re
import tomllib
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen._cli.commands.init import commented
from oodscen._cli.commands.study import run
from oodscen._cli.configuration import RUN_SECTIONS, options_of, read_configuration
from oodscen.errors import DataError

OPTIONS = options_of(run)


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
    Path("tree.json").write_text("{}")
    whole = uncommented(commented(run, {}))
    assert set(tomllib.loads(whole)) == set(OPTIONS)
    assert set(read(whole, tmp_path)) == {option.name for option in OPTIONS.values()}


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
        ("seed = 1.5", "seed", "1.5 is not a whole number"),
        ("seed = true", "seed", "is not a whole number"),
        ("nodes = 40.0", "nodes", "40.0 is not a whole number"),
        ("max-cost = '1'", "max-cost", "'1' is not a number"),
        ("nodes = 1", "nodes", "not in the range"),
        ("llm = 3", "llm", "3 is not a text"),
        ("quick = 1", "quick", "must be true or false"),
        ("band = 0.3", "band", "list of 2"),
        ("band = [0.3]", "band", "2 values"),
        ("vlm = [1]", "vlm", "1 is not a text"),
        ("vlm = ['x', 3]", "vlm", "3 is not a text"),
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

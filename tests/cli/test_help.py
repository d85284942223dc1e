import subprocess
import sys

from click.testing import CliRunner

from oodscen._cli import main
from oodscen._cli.help import COMMANDS, sections_of


def test_every_command_has_one_section():
    listed = [name for names in COMMANDS.values() for name in names]
    assert sorted(listed) == sorted(main.commands)


def test_help_is_grouped():
    text = CliRunner().invoke(main, ["--help"]).output
    assert [text.index(f"\n{title}:") for title in COMMANDS] == sorted(
        text.index(f"\n{title}:") for title in COMMANDS
    )
    text = CliRunner().invoke(main, ["run", "--help"]).output
    assert text.index("\nModels:") < text.index("--red-llm") < text.index("\nJudging:")
    assert "Further" not in text


def test_names_in_no_section_come_last():
    found = sections_of({"A": ("x", "gone"), "B": ("none",)}, ["y", "x"], "Rest")
    assert found == {"A": ("x",), "Rest": ("y",)}


def test_without_docstrings_help_says_what_it_lacks():
    for words in (["--help"], ["show", "--help"]):
        order = [sys.executable, "-B", "-OO", "-m", "oodscen", *words]
        found = subprocess.run(order, capture_output=True, text=True, check=True)
        assert "python -OO drops the descriptions" in found.stdout
    assert "-OO" not in CliRunner().invoke(main, ["--help"]).output

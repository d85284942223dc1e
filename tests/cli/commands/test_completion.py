import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen._cli.commands.completion import SHELLS


def completed(words, incomplete=""):
    environment = {
        "_OODSCEN_COMPLETE": "bash_complete",
        "COMP_WORDS": f"{words} {incomplete}",
        "COMP_CWORD": str(len(words.split())),
    }
    done = CliRunner().invoke(main, prog_name="oodscen", env=environment)
    return [line.partition(",")[2] for line in done.output.splitlines()]


def test_commands_options_and_names_are_completed():
    assert completed("oodscen", "re") == ["redteam", "report"]
    assert "--red-llm" in completed("oodscen run", "--red-")
    assert "flat" in completed("oodscen run --simulator")
    assert "hash" in completed("oodscen run --encoder", "ha")
    assert "hash" in completed("oodscen score --encoder", "ha")
    assert "builtin" in completed("oodscen evaluate out --vlm", "b")
    assert completed("oodscen drive out --driver", "r1") == ["r157"]
    assert completed("oodscen run --style", "t") == ["terse"]


@pytest.mark.parametrize("shell", SHELLS)
def test_every_shell_has_a_script(shell):
    done = CliRunner().invoke(main, ["completion", shell])
    assert done.exit_code == 0
    assert "_OODSCEN_COMPLETE" in done.output

"""Standard output holds the results of a command, whatever components write there."""

import subprocess
import sys

import click
import pytest
from click.testing import CliRunner

from oodscen._cli.groups import CommandGroup
from oodscen._cli.output import say
from oodscen._io.standard_output import for_results, results

SCRIPT = """
import ctypes, os, subprocess, sys
from pathlib import Path
from oodscen._cli.output import say, write
from oodscen._io.standard_output import for_results

with for_results(), for_results():
    say("first")
    print("print")
    os.write(1, b"descriptor\\n")
    subprocess.run(["echo", "process"], check=True)
    ctypes.CDLL(None).puts(b"C")
    sys.__stdout__.write("original\\n")
    for name in ("/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"):
        write(Path(name), name)
    say("last")
try:
    with for_results():
        raise KeyError
except KeyError:
    os.write(1, b"after\\n")
"""


def test_components_write_to_standard_error():
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == [
        "first",
        "/dev/stdout",
        "/dev/fd/1",
        "/proc/self/fd/1",
        "last",
        "after",
    ]
    assert sorted(done.stderr.split()) == ["C", "descriptor", "original", "print", "process"]


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_missing_stream_costs_nothing(monkeypatch, stream):
    monkeypatch.setattr(sys, stream, None)
    with for_results():
        print("to nobody")
    assert results() is sys.stdout


def test_every_command_of_a_group_keeps_it():
    group, inner = CommandGroup("outer"), CommandGroup("inner")
    group.add_command(inner)

    @click.command()
    def noisy() -> None:
        """Help."""
        print("from a model")
        say("the result")

    inner.add_command(noisy)
    done = CliRunner().invoke(group, ["inner", "noisy"])
    assert (done.stdout, done.stderr) == ("the result\n", "from a model\n")
    assert "Help." in CliRunner().invoke(group, ["inner", "noisy", "--help"]).stdout

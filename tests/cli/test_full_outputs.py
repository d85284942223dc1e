"""Outputs that take nothing: a line at most, and no traceback at the end of the process."""

import subprocess
import sys

import pytest


def called(*words: str, **outputs) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([sys.executable, "-m", "oodscen", *words], check=False, **outputs)


@pytest.mark.parametrize("words", [("power", "0.66", "0.51"), ("--help",)])
def test_a_full_device_is_one_line(words: tuple[str, ...]) -> None:
    with open("/dev/full", "wb") as full:
        result = called(*words, stdout=full, stderr=-1)
    assert result.returncode == 1
    assert result.stderr.decode().splitlines() == [
        "oodscen: cannot write the output: No space left on device"
    ]


def test_nobody_who_reads_is_no_error_worth_a_word() -> None:
    process = subprocess.Popen([sys.executable, "-m", "oodscen", "--help"], stdout=-1, stderr=-1)
    process.stdout.close()
    assert process.stderr.read() == b""
    assert process.wait() == 1
    process.stderr.close()


def test_a_full_device_for_messages_ends_quietly() -> None:
    with open("/dev/full", "wb") as full:
        assert called("power", "1", "1", stdout=-1, stderr=full).returncode == 1

"""The part of the plugin that every pytest session loads: its options, and nothing heavy.

Only a session that names a study loads the rest, and only tests that use a scene read the study.
"""

import os
import shlex
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import pytest

SESSION = "oodscen-session"
"""Name of the plugin that does the work."""

MODES = ("compare", "write", "update")


class _Option(NamedTuple):
    """An option that may be a setting, too."""

    metavar: str
    help: str
    is_path: bool = False


_OPTIONS = {
    "oodscen": _Option("OUT", "study whose scenes are driven", is_path=True),
    "oodscen_simulator": _Option("NAME", "simulator to drive in (default: the study's)"),
    "oodscen_pictures": _Option(
        "DIR",
        "folder for a frame and the plan view of failed drives (default: oodscen beside the JUnit file)",
        is_path=True,
    ),
    "oodscen_require": _Option("BARS", 'grade the driving stacks, e.g. "safe>=0.9,needless<=0.05"'),
    "oodscen_baseline": _Option(
        "FILE", "file of the outcomes that are known: only regressions fail", is_path=True
    ),
    "oodscen_per_path": _Option("N", "drive the first N scenes of every path"),
}
"""The options by the names of their settings."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options, each but the mode with a setting of the same name in the configuration file."""
    group = parser.getgroup("oodscen", "driving stacks in out-of-distribution scenes (oodscen)")
    for name, option in _OPTIONS.items():
        group.addoption(_flag(name), metavar=option.metavar, help=option.help)
        parser.addini(name, option.help)
    group.addoption(
        "--oodscen-baseline-mode",
        choices=MODES,
        help="compare outcomes with the baseline (default), write a new one, or update the tests that ran",
    )


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def pytest_configure(config: pytest.Config) -> None:
    """Start the part that does the work, if a study is named.

    Raises:
        pytest.UsageError: If the folder holds no study, or an option needs one.
    """
    given = [
        name for name in (*_OPTIONS, "oodscen_baseline_mode") if config.getoption(name) is not None
    ]
    for name in given:
        if not config.getoption(name).strip():
            raise pytest.UsageError(f"{_flag(name)} is empty")
    folder = path_setting(config, "oodscen")
    _refuse_far_paths(config)
    if folder is None:
        if given:
            raise pytest.UsageError(f"{_flag(given[0])} needs a study: --oodscen OUT")
        return
    pictures = path_setting(config, "oodscen_pictures")
    if pictures is not None and any(path.is_file() for path in (pictures, *pictures.parents)):
        raise pytest.UsageError(f"--oodscen-pictures must be a folder, not the file {pictures}")
    if not (folder / "study.json").is_file():
        raise pytest.UsageError(f"{folder} holds no study; make one with: oodscen run {folder}")
    from oodscen.pytest_plugin import _fixtures
    from oodscen.pytest_plugin._session import DrivingSession

    session = DrivingSession(config, folder)
    if config.getoption("markers", False):
        session.register_marks()
    config.pluginmanager.register(session, SESSION)
    config.pluginmanager.register(_fixtures, "oodscen-fixtures")


def _refuse_far_paths(config: pytest.Config) -> None:
    """Refuse `--oodscen OUT` for a folder elsewhere, where pytest would look for its configuration.

    Pytest reads its configuration before it knows the options of plugins, and takes a word that is a path for a
    place of tests. `--oodscen=OUT` is one word.

    Raises:
        pytest.UsageError: With the words to write instead.
    """
    folder = config.invocation_params.dir
    words = [
        *shlex.split(os.environ.get("PYTEST_ADDOPTS", "")),
        *map(str, config.invocation_params.args),
    ]
    flags = {_flag(name) for name, option in _OPTIONS.items() if option.is_path}
    for flag, value in pairwise(words):
        if flag in flags and not Path(os.path.abspath(folder / value)).is_relative_to(folder):
            raise pytest.UsageError(
                f"write {flag}={value}: pytest would take the separate word {value} for a place of tests"
            )


def setting(config: pytest.Config, name: str) -> str | None:
    """Return an option, else the setting of the same name in the configuration file."""
    option: str | None = config.getoption(name)
    return config.getini(name) or None if option is None else option


def path_setting(config: pytest.Config, name: str) -> Path | None:
    """Return a path: an option's starts in the working folder, a setting's in that of the configuration file."""
    path = setting(config, name)
    if path is None:
        return None
    folder, file = config.invocation_params.dir, config.inipath
    if config.getoption(name) is None and file is not None:
        folder = file.parent
    return Path(folder, path)

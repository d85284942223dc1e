"""The part of the plugin that every pytest session loads: its options, and nothing heavy.

Only a session that names a study loads the rest, and only tests that use a scene read the study.
"""

import os
from itertools import pairwise
from pathlib import Path

import pytest

SESSION = "oodscen-session"
"""Name of the plugin that does the work."""

MODES = ("compare", "write", "update")

_PATH_OPTIONS = ("--oodscen", "--oodscen-pictures", "--oodscen-baseline")

_OPTIONS = {
    "simulator": ("NAME", "simulator to drive in (default: the study's)"),
    "pictures": (
        "DIR",
        "folder for a frame and the plan view of failed drives (default: oodscen beside the JUnit file)",
    ),
    "require": ("BARS", 'grade the driving stacks, e.g. "safe>=0.9,needless<=0.05"'),
    "baseline": ("FILE", "file of the outcomes that are known: only regressions fail"),
}


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options, each with a setting of the same name in the configuration file."""
    group = parser.getgroup("oodscen", "driving stacks in out-of-distribution scenes (oodscen)")
    group.addoption("--oodscen", metavar="OUT", help="study whose scenes are driven")
    parser.addini("oodscen", "study whose scenes are driven")
    for name, (metavar, description) in _OPTIONS.items():
        group.addoption(f"--oodscen-{name}", metavar=metavar, help=description)
        parser.addini(f"oodscen_{name}", description)
    group.addoption(
        "--oodscen-per-path", metavar="N", type=int, help="drive the first N scenes of every path"
    )
    parser.addini("oodscen_per_path", "drive the first N scenes of every path")
    group.addoption(
        "--oodscen-baseline-mode",
        choices=MODES,
        default="compare",
        help="compare outcomes with the baseline (default), write a new one, or update the tests that ran",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Start the part that does the work, if a study is named.

    Raises:
        pytest.UsageError: If the folder holds no study, or an option needs one.
    """
    for name in ("oodscen", *(f"oodscen_{option}" for option in _OPTIONS)):
        if (value := config.getoption(name)) is not None and not value.strip():
            raise pytest.UsageError(f"--{name.replace('_', '-')} is empty")
    folder = path_setting(config, "oodscen")
    _refuse_far_paths(config)
    if folder is None:
        for option in _OPTIONS:
            if config.getoption(f"oodscen_{option}") is not None:
                raise pytest.UsageError(f"--oodscen-{option} needs a study: --oodscen OUT")
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
    folder of tests. `--oodscen=OUT` is one word.

    Raises:
        pytest.UsageError: With the words to write instead.
    """
    folder, words = config.invocation_params.dir, config.invocation_params.args
    for option, value in pairwise(words):
        if option in _PATH_OPTIONS and folder not in Path(os.path.abspath(folder / value)).parents:
            raise pytest.UsageError(
                f"write {option}={value}: of {option} {value}, pytest takes the folder for one of tests"
            )


def setting(config: pytest.Config, name: str) -> str | None:
    """Return an option, else the setting of the same name in the configuration file."""
    value = config.getoption(name)
    return str(value) if value is not None else config.getini(name) or None


def path_setting(config: pytest.Config, name: str) -> Path | None:
    """Return a path: an option's starts in the working folder, a setting's at the configuration file."""
    option = config.getoption(name)
    if option is not None:
        return Path(config.invocation_params.dir, option)
    path = config.getini(name)
    return Path(config.rootpath, path) if path else None

"""The fixtures of a session that names a study."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, cast

import pytest

from oodscen._words.text import printable
from oodscen.errors import OodscenError
from oodscen.pytest_plugin._hooks import SESSION
from oodscen.pytest_plugin._session import DRIVE, DrivingSession

if TYPE_CHECKING:
    from oodscen.data._scene import Scene
    from oodscen.protocols import Simulator
    from oodscen.pytest_plugin._driving import Drive


def _session(request: pytest.FixtureRequest) -> DrivingSession:
    return cast(DrivingSession, request.config.pluginmanager.get_plugin(SESSION))


@pytest.fixture
def oodscen_scene(request: pytest.FixtureRequest) -> "Scene":
    """The parameter of `scene`."""
    if not hasattr(request, "param"):
        pytest.fail(
            "oodscen runs a test once for every scene only if `scene`, `twin` or `drive` is an argument of it; methods "
            "of unittest.TestCase and request.getfixturevalue have no scene",
            pytrace=False,
        )
    return cast("Scene", request.param)


@pytest.fixture
def scene(oodscen_scene: "Scene") -> "Scene":
    """One scene of the study."""
    return oodscen_scene


@pytest.fixture(scope="session")
def simulator(request: pytest.FixtureRequest) -> "Iterator[Simulator]":
    """The simulator of the study, or of `--oodscen-simulator`; closed at the end."""
    from oodscen._members import using
    from oodscen._registry import make_simulator

    with using(make_simulator(_session(request).simulator_name)) as simulator:
        yield simulator


@pytest.fixture
def drive(scene: "Scene", simulator: "Simulator", request: pytest.FixtureRequest) -> "Drive":
    """A function that lets a driving stack drive the scene, or its twin: `drive(stack, twin)`."""
    from oodscen.pytest_plugin._driving import Drive

    try:
        # Not read before if the test has a `scene` of its own.
        drive = Drive(scene, simulator, _session(request).scenes, request.node.nodeid)
    except OodscenError as error:
        pytest.fail(printable(str(error)), pytrace=False)
    request.node.stash[DRIVE] = drive
    return drive


@pytest.fixture
def twin(drive: "Drive") -> "Scene":
    """The ordinary twin of the scene."""
    return drive.twin

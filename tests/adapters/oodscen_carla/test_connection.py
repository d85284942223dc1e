"""The connection accepts only versions whose instance pictures name actors."""

from types import SimpleNamespace

import pytest
from oodscen_carla import _connection as connection
from oodscen_carla._connection import Connection

from oodscen.errors import SimulatorError


def client_of(version: str):
    """Return a stand-in for the client's module, connected to a server of the same version."""
    made = SimpleNamespace(
        set_timeout=lambda _: None,
        get_server_version=lambda: version,
        get_client_version=lambda: version,
        get_world=lambda: SimpleNamespace(get_blueprint_library=list),
    )
    return SimpleNamespace(Client=lambda *_: made)


@pytest.mark.parametrize("version", ["0.9.14", "0.9.15", "0.10.0"])
def test_a_server_whose_pictures_name_no_actors_is_refused(monkeypatch, version):
    monkeypatch.setattr(connection, "_load", lambda: client_of(version))
    with pytest.raises(SimulatorError, match=rf"has version {version}, .*must be 0\.9\.16"):
        Connection("127.0.0.1:2000", 1.0)


def test_a_server_of_the_supported_version_is_accepted(monkeypatch):
    monkeypatch.setattr(connection, "_load", lambda: client_of("0.9.16"))
    assert Connection("127.0.0.1:2000", 1.0).blueprints == frozenset()

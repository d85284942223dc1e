"""A served world without sockets, and a server in a process of its own."""

from collections.abc import Iterator

import msgpack
import pytest
from oodscen_carla.server import CarlaTestServer
from oodscen_carla.server._calls import Calls
from oodscen_carla.server._world import World

from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator


class Silence:
    """Streams that nobody hears."""

    def token(self, stream: int) -> bytes:
        return bytes(24)

    def expect(self, stream: int) -> None: ...

    def drop(self, stream: int) -> None: ...


class Served:
    """A world and its calls; `ask` takes what a client would send."""

    def __init__(self, scenes: tuple = ()) -> None:
        self.world = World(FlatSimulator().catalogue(), scenes)
        self.told: list[str] = []
        self.calls = Calls(self.world, Silence(), self.tick, self.told.append)

    def tick(self) -> int:
        self.world.advance()
        return self.world.frame

    def ask(self, method: str, *arguments: object) -> object:
        """Return the response after a round through msgpack."""
        values = msgpack.unpackb(msgpack.packb([[False], *arguments]), strict_map_key=False)
        return msgpack.unpackb(msgpack.packb(self.calls.answer(method, values)))

    def get(self, method: str, *arguments: object) -> object:
        """Return the result of a call that succeeds."""
        (response,) = self.ask(method, *arguments)
        assert response[0] in (1, False), response
        return response[1] if len(response) > 1 else None

    def error(self, method: str, *arguments: object) -> str:
        """Return the message of a call that fails."""
        ((kind, (message,)),) = self.ask(method, *arguments)
        assert kind == 0
        return message

    def spawn(
        self, name: str, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, **attributes
    ) -> int:
        given = [[key, 4, str(value)] for key, value in attributes.items()]
        return self.get("spawn_actor", [1, name, given], [[x, y, 0.0], [0.0, yaw, 0.0]])[0]


@pytest.fixture
def served() -> Iterator[Served]:
    made = Served()
    yield made
    made.world.close()


@pytest.fixture
def staged() -> Iterator[Served]:
    made = Served((example_scene(),))
    yield made
    made.world.close()


@pytest.fixture(scope="package")
def server() -> Iterator[CarlaTestServer]:
    with CarlaTestServer([example_scene()]) as made:
        yield made

"""`serve`: runs the CARLA server in this process."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

from oodscen import make_simulator
from oodscen._arguments import checked
from oodscen._numbers import seed_number, whole_number
from oodscen.data import Scene
from oodscen.errors import MissingExtra, UsageError
from oodscen_carla.server._cameras import BodyRenderer, CameraRenderer
from oodscen_carla.server._faults import Faults
from oodscen_carla.server._world import World

_LAST_PORT = 65_534
"""Largest port that has a next one."""


@dataclass(frozen=True)
class RunningServer:
    """A server that runs in threads of this process."""

    port: int
    """Port for calls; streams are on the next."""
    maps: tuple[str, ...]
    """The names that `Client.load_world` takes, scenes first."""
    faults: Faults
    """Faults to produce, for tests."""


@checked
@contextmanager
def serve(
    scenes: Sequence[Scene] = (),
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    simulator: str = "pybullet",
    seed: int = 0,
    log: Callable[[str], None] | None = None,
) -> Iterator[RunningServer]:
    """Serve CARLA 0.9.16's protocol while the context is active.

    Run the official client in another process: it holds the GIL while it waits.

    Args:
        scenes: Scenes that clients load by their ids; the first is open from the start.
        host: The address to listen on. There is no authentication.
        port: Port for calls, the next one is for streams; 0 chooses free ones.
        simulator: Name of the simulator that draws the pictures.
        seed: Seed of motion, scenery and paints.
        log: Called with a line for every refusal.

    Raises:
        MissingExtra: If msgpack is not installed.
        UsageError: If an argument is of another kind or out of its range, the simulator cannot draw for a server, two
            scenes or a scene and a map have one name, or the server cannot listen there.
        SceneError: If the first scene cannot be staged.
    """
    seed, port = seed_number(seed), whole_number("port", port, 0, _LAST_PORT)
    if not host:  # Sockets would take it for every address.
        raise UsageError("host is empty; give 0.0.0.0 to listen on every address")
    try:
        from oodscen_carla.server._listener import Listener
    except ModuleNotFoundError as error:
        if error.name != "msgpack":
            raise
        raise MissingExtra("the CARLA server", "carla-server", "msgpack") from None
    drawing = make_simulator(simulator)
    if not isinstance(drawing, BodyRenderer):
        drawing.close()
        raise UsageError(
            f"simulator {simulator!r} cannot draw for a server: it has no method draw_from"
        )
    with ExitStack() as stack:
        renderer = CameraRenderer(drawing)
        stack.callback(renderer.close)
        world = World(drawing.catalogue(), scenes, seed)
        stack.callback(world.close)
        renderer.warm_up(world.scene())
        faults = Faults()
        listener = Listener(world, renderer, host=host, port=port, faults=faults, log=log)
        stack.callback(listener.close)
        listener.start()
        yield RunningServer(listener.port, tuple(world.map_names), faults)

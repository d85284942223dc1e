"""The command that serves scenes to the scripts of another simulator."""

import importlib
import queue
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from oodscen._cli.options import seed_option
from oodscen._cli.output import read_lines, say
from oodscen._cli.paths import PathName
from oodscen.errors import DataError, Issue, MissingExtra

if TYPE_CHECKING:
    from oodscen.data._scene import Scene
    from oodscen.study._study import Study


def _address(given: str) -> str:
    """Return an address to listen on; an empty one would mean every network of the machine."""
    if not given.strip():
        raise click.BadParameter("is empty; 0.0.0.0 listens on all networks.")
    return given


@click.command()
@click.argument("source", required=False, type=PathName(exists=True, path_type=Path))
@click.option(
    "--carla",
    "port",
    required=True,
    type=click.IntRange(0, 65534),
    help="Port of CARLA 0.9.16's protocol; the next port is used, too. 0 chooses free ones.",
)
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    callback=lambda context, option, given: _address(given),
    help="Address to listen on. There is no authentication.",
)
@click.option(
    "--simulator",
    help="Simulator that draws the pictures: pybullet, flat.  [default: the study's, or pybullet]",
)
@seed_option
def serve(source: Path | None, port: int, host: str, simulator: str | None, seed: int) -> None:
    """Serve maps, and the scenes of a study or a file SOURCE, to scripts written for CARLA.

    Scripts connect with the official client. Each scene is a map by its id, and the first is open from
    the start; the ego is the vehicle with the role name "hero". The server runs until Ctrl-C.
    """
    study = _study(source)
    source_of_seed = click.get_current_context().get_parameter_source("seed")
    if study is not None and source_of_seed is click.core.ParameterSource.DEFAULT:
        seed = study.config.seed
    simulator = simulator or (study.config.simulator if study else "pybullet")
    scenes = _scenes(source, study)
    try:
        server = importlib.import_module("oodscen_carla.server")  # adapters are not imported here
    except ModuleNotFoundError as error:
        raise MissingExtra("oodscen serve", "carla-server", error.name or "msgpack") from None

    say(f"loading {simulator} and its maps ...", err=True)
    with server.serve(
        scenes, host=host, port=port, simulator=simulator, seed=seed, log=_Log().add
    ) as serving:
        say(f"serving CARLA 0.9.16's protocol on {host}:{serving.port}; Ctrl-C ends")
        say(f"maps: {', '.join(serving.maps[:12])}{' ...' if len(serving.maps) > 12 else ''}")
        threading.Event().wait()


_MOST_WAITING = 1_000
"""Number of lines that wait for the reader of standard error."""


class _Log:
    """Prints lines in a thread of its own: lines that are not read are dropped, and no request waits."""

    def __init__(self) -> None:
        self._waiting: queue.Queue[str] = queue.Queue(_MOST_WAITING)
        self._dropped = 0
        threading.Thread(target=self._print, daemon=True).start()

    def add(self, line: str) -> None:
        """Print a line soon, or drop it if too many are waiting."""
        try:
            self._waiting.put_nowait(line)
        except queue.Full:
            self._dropped += 1

    def _print(self) -> None:
        while True:
            line = self._waiting.get()
            dropped, self._dropped = self._dropped, 0
            with suppress(OSError):  # The reader has gone.
                say(line, err=True)
                if dropped:
                    say(
                        f"{dropped:,} further lines were dropped, since the output was not read",
                        err=True,
                    )


def _study(source: Path | None) -> "Study | None":
    from oodscen.study._study import Study

    return Study.open(source) if source is not None and source.is_dir() else None


def _scenes(source: Path | None, study: "Study | None") -> Sequence["Scene"]:
    from oodscen.data._scene import Scene

    if source is None:
        return ()
    scenes = study.scenes if study is not None else read_lines(Scene, source)
    if not scenes:
        raise DataError("scenes", [Issue("", "there are none")], source=str(source))
    return scenes

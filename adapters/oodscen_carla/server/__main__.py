"""The server's process: `python -m oodscen_carla.server`."""

import argparse
import sys
from pathlib import Path

from oodscen._io.files import read_utf8
from oodscen.data import Scene
from oodscen.errors import OodscenError
from oodscen_carla.server._faults import Fault, Faults
from oodscen_carla.server._serve import serve


def main() -> None:
    """Serve CARLA's protocol until standard input ends.

    Each line of standard input is a fault as JSON, and is answered by `set` or `refused: ...`.
    """
    parser = argparse.ArgumentParser("python -m oodscen_carla.server", description=main.__doc__)
    parser.add_argument("--port", type=int, default=0, help="for calls; 0 chooses a free one")
    parser.add_argument("--simulator", default="pybullet", help="draws the pictures")
    parser.add_argument("--seed", type=int, default=0, help="of motion, scenery and paints")
    parser.add_argument("--scenes", type=Path, help="file with one scene per line")
    options = parser.parse_args()
    try:
        scenes = _scenes(options.scenes) if options.scenes else []
        with serve(
            scenes, port=options.port, simulator=options.simulator, seed=options.seed
        ) as server:
            print(server.port, flush=True)
            for line in sys.stdin:
                print(_answer(server.faults, line), flush=True)
    except OodscenError as error:
        parser.exit(2, f"{error}\n")


def _scenes(path: Path) -> list[Scene]:
    """Read one scene per line; `splitlines` would also split at separators inside JSON strings."""
    lines = enumerate(read_utf8(path, Scene.noun).split("\n"), start=1)
    return [
        Scene.parse(line, source=f"{path}, line {number}") for number, line in lines if line.strip()
    ]


def _answer(faults: Faults, line: str) -> str:
    try:
        faults.add(Fault.from_json(line))
    except ValueError as error:
        return f"refused: {error}"
    return "set"


if __name__ == "__main__":
    main()

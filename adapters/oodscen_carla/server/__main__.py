"""The server's process: `python -m oodscen_carla.server`."""

import argparse
import json
import sys
from pathlib import Path

from oodscen.data import Scene
from oodscen_carla.server._faults import Fault
from oodscen_carla.server._serve import serve


def main() -> None:
    """Serve until standard input ends; each line of it is a fault as JSON, and is answered."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--simulator", default="pybullet")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scenes", type=Path)
    given = parser.parse_args()
    lines = given.scenes.read_text(encoding="utf-8").splitlines() if given.scenes else []
    scenes = [Scene.parse(json.loads(line)) for line in lines if line]
    with serve(scenes, port=given.port, simulator=given.simulator, seed=given.seed) as server:
        print(server.port, flush=True)
        for line in sys.stdin:
            server.faults.add(Fault(**json.loads(line)))
            print("set", flush=True)


if __name__ == "__main__":
    main()

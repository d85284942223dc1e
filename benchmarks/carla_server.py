"""Measures the server of CARLA's protocol with the official client: speed, leaks, and dying scripts.

Usage: python benchmarks/carla_server.py [--json] [--kills N] [--ticks N]

Needs the `carla` package. One server with PyBullet's pictures runs in a process of its own. A script
drives a car at 640 x 480 pixels: without a camera, with one, and with three on one mount. Then 1,000 ticks
and 60 worlds may not let memory or open files grow, a second client watches while the first ticks, and
scripts that are killed or stopped at random moments must leave nothing in the server.
"""

import argparse
import json
import os
import queue
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import carla
from oodscen_carla.server import CarlaTestServer

from oodscen.driving._roads.building import read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS

KINDS = ("rgb", "depth", "instance_segmentation")
SCRIPT = "--script"
GROWTH_MB = 24.0
"""Largest growth of the server's memory that is no leak, MB."""

WARM = 20
"""Number of scripts that die before the server's memory is measured."""

Row = dict[str, object]


def opened(port: int) -> tuple[Any, Any]:
    """Return a client and its world in synchronous mode."""
    client = carla.Client("127.0.0.1", port, 1)
    client.set_timeout(60.0)
    world = client.load_world("urban_junction")
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
    world.apply_settings(settings)
    return client, world


def car_of(world: Any) -> Any:
    """Return a car that drives slowly."""
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    car = world.spawn_actor(blueprint, world.get_map().get_spawn_points()[2])
    car.apply_control(carla.VehicleControl(throttle=0.2))
    return car


def cameras_of(world: Any, car: Any, kinds: tuple[str, ...]) -> list[tuple[Any, Any]]:
    """Return cameras of one mount and their pictures."""
    found = []
    for kind in kinds:
        blueprint = world.get_blueprint_library().find(f"sensor.camera.{kind}")
        blueprint.set_attribute("image_size_x", "640")
        blueprint.set_attribute("image_size_y", "480")
        mount = carla.Transform(carla.Location(x=1.5, z=1.6))
        camera, images = world.spawn_actor(blueprint, mount, attach_to=car), queue.SimpleQueue()
        camera.listen(images.put)
        found.append((camera, images))
    return found


def rate(port: int, kinds: tuple[str, ...], ticks: int) -> float:
    """Return the ticks per second with some cameras."""
    _, world = opened(port)
    car = car_of(world)
    cameras = cameras_of(world, car, kinds)
    for warm in (True, False):
        start = time.perf_counter()
        for _ in range(10 if warm else ticks):
            frame = world.tick()
            for _, images in cameras:
                assert images.get(timeout=60).frame == frame
    seconds = time.perf_counter() - start
    for camera, _ in cameras:
        camera.stop()
        camera.destroy()
    car.destroy()
    return ticks / seconds


def memory_mb(pid: int) -> float:
    """Return the resident memory of a process, MB."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def files_of(pid: int) -> int:
    """Return the number of open files of a process."""
    return len(os.listdir(f"/proc/{pid}/fd"))


def growth(server: CarlaTestServer, ticks: int) -> list[Row]:
    """Return the growth of memory and files over many worlds, and then over many ticks."""
    client, world = opened(server.port)
    texts = [read_map(road.file).decode() for road in SHIPPED_MAPS]

    def visit(count: int) -> None:
        for number in range(count):
            text = texts[number % len(texts)]
            made = client.generate_opendrive_world(text, reset_settings=False)
            car = car_of(made)
            ((camera, images),) = cameras_of(made, car, ("rgb",))
            made.tick()
            images.get(timeout=60)
            camera.stop()

    visit(2 * len(texts))
    before = memory_mb(server.pid), files_of(server.pid)
    visit(60)
    after = memory_mb(server.pid), files_of(server.pid)
    rows = [
        row("growth over 60 worlds", after[0] - before[0], "MB", f"<= {GROWTH_MB:g}", GROWTH_MB),
        row("more open files after 60 worlds", after[1] - before[1], "", "<= 2", 2),
    ]
    world = client.get_world()
    before_ticks = memory_mb(server.pid)
    for _ in range(ticks):
        world.tick()
    grown = memory_mb(server.pid) - before_ticks
    return [*rows, row(f"growth over {ticks} ticks", grown, "MB", f"<= {GROWTH_MB:g}", GROWTH_MB)]


def row(name: str, value: float, unit: str, target: str, most: float) -> Row:
    """Return one figure that may not exceed a limit."""
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": value <= most}


def script(port: int) -> None:
    """Drive with a camera until the process ends."""
    _, world = opened(port)
    car = car_of(world)
    cameras = cameras_of(world, car, ("rgb",))
    print("driving", flush=True)
    while True:
        world.tick()
        for _, images in cameras:
            images.get(timeout=60)


def watched(port: int, ticks: int) -> bool:
    """Return whether a second client sees what the first does."""
    _, world = opened(port)
    car = car_of(world)
    other = carla.Client("127.0.0.1", port, 1)
    other.set_timeout(60.0)
    watching, places = other.get_world(), {}
    for _ in range(ticks):
        frame = world.tick()
        places[frame] = car.get_location()
        last = watching.get_snapshot()
        if last.frame in places and last.find(car.id) is not None:
            seen = last.find(car.id).get_transform().location
            return bool(seen.distance(places[last.frame]) < 1e-3)
    return False


def kills(server: CarlaTestServer, count: int) -> list[Row]:
    """Kill or stop scripts at random moments; return what is left of them."""
    rng = random.Random(0)
    order = [sys.executable, __file__, SCRIPT, str(server.port)]
    before, lost = (0.0, 0), 0
    for number in range(-WARM, count):
        if number == 0:
            before = memory_mb(server.pid), files_of(server.pid)
        process = subprocess.Popen(order, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        assert process.stdout is not None
        if number % 4:
            process.stdout.readline()
        time.sleep(rng.uniform(0.0, 0.4))
        if number % 5 == 0:
            process.send_signal(signal.SIGSTOP)
            time.sleep(rng.uniform(0.0, 0.4))
        process.kill()
        process.wait()
        process.stdout.close()
        lost += not server.is_alive
    time.sleep(7.0)
    grown, files = memory_mb(server.pid) - before[0], files_of(server.pid) - before[1]
    client = carla.Client("127.0.0.1", server.port, 1)
    client.set_timeout(60.0)
    left = len(client.get_world().wait_for_tick(10.0)) - 1
    return [
        row(f"servers that ended with one of {count} scripts", lost, "", "0", 0),
        row("growth of the server's memory", grown, "MB", f"<= {GROWTH_MB:g}", GROWTH_MB),
        row("open files left", files, "", "<= 4", 4),
        row("actors left", left, "", "0", 0),
    ]


def measure(ticks: int, count: int) -> list[Row]:
    """Return all figures."""
    rows: list[Row] = []
    with CarlaTestServer(simulator="pybullet") as server:
        for kinds, least in (((), 3000.0), (("rgb",), 45.0), (KINDS, 50.0)):
            number = ticks if kinds else 10 * ticks
            value = rate(server.port, kinds, number)
            name = f"640 x 480, {len(kinds)} cameras of one mount"
            holds = value >= least
            rows.append(
                {
                    "name": name,
                    "value": value,
                    "unit": "ticks/s",
                    "target": f">= {least:g}",
                    "holds": holds,
                }
            )
            print(f"{name}: {value:.0f} ticks/s", flush=True)
        sees = watched(server.port, 1000)
        rows.append(row("frames that a second client misses", float(not sees), "", "0", 0))
        rows += growth(server, 1000)
        rows += kills(server, count)
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--ticks", type=int, default=300, help="how many ticks to time")
    parser.add_argument("--kills", type=int, default=200, help="how many scripts to kill")
    parser.add_argument(SCRIPT, type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.script is not None:
        script(options.script)
    found = measure(options.ticks, options.kills)
    for item in found:
        mark = "ok  " if item["holds"] else "MISS"
        print(f"{mark} {item['name']}: {item['value']:.1f} {item['unit']} ({item['target']})")
    if options.json:
        print(json.dumps(found))
    return 0 if all(item["holds"] for item in found) else 1


if __name__ == "__main__":
    sys.exit(main())

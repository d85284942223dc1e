"""Measures the server of CARLA's protocol with the official client: speed, leaks, and dying scripts.

Usage: python benchmarks/carla_server.py [--json] [--kills N] [--ticks N] [--worlds N]

Needs the `carla` package. One server with PyBullet's pictures runs in a process of its own. A script
drives a car at 640 x 480 pixels: without a camera, with one, and with three on one mount. A second client
watches while the first ticks. Then neither ticks with a camera nor worlds, loaded, reloaded and sent, may
let the server's memory, threads or open files grow, and scripts that are ended by SIGTERM, SIGINT, SIGKILL
or SIGSTOP at random moments of a start, of ticks, spawns and streams must leave nothing in it. Every figure is
printed as it comes.
"""

import argparse
import json
import multiprocessing
import os
import queue
import random
import signal
import sys
import time
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import carla
from oodscen_carla.server import CarlaTestServer

from oodscen.driving._roads.building import read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS

KINDS = ("rgb", "depth", "instance_segmentation")
GROWTH_MB = 24.0
"""Largest growth of the server's memory that is no leak, MB."""
MORE_FILES, MORE_THREADS = 2, 2
"""Largest growth of the numbers of open files and threads that is none."""
WARM = 20
"""Number of scripts that die before the server is measured."""
SETTLING_S = 12.0
"""Time in which the server notices that a stopped client reads no longer, s."""
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL, signal.SIGSTOP)

Row = dict[str, object]


class Usage(NamedTuple):
    """What a process holds."""

    memory_mb: float
    files: int
    threads: int

    @classmethod
    def of(cls, pid: int) -> "Usage":
        """Measure a process."""
        folder = Path(f"/proc/{pid}")
        pages = int((folder / "statm").read_text().split()[1])
        memory = pages * os.sysconf("SC_PAGE_SIZE") / 1e6
        return cls(memory, len(os.listdir(folder / "fd")), len(os.listdir(folder / "task")))

    def growth(self, before: "Usage", after: str) -> Iterator[Row]:
        """Yield the growth since another measurement."""
        grown = self.memory_mb - before.memory_mb
        yield row(f"memory more after {after}", grown, "MB", GROWTH_MB)
        yield row(f"open files more after {after}", self.files - before.files, "", MORE_FILES)
        yield row(f"threads more after {after}", self.threads - before.threads, "", MORE_THREADS)


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


def row(name: str, value: float, unit: str, most: float) -> Row:
    """Return one figure that may not exceed a limit."""
    return {
        "name": name,
        "value": value,
        "unit": unit,
        "target": f"<= {most:g}",
        "holds": value <= most,
    }


def rates(port: int, ticks: int) -> Iterator[Row]:
    """Yield the ticks per second with no camera, one, and three of one mount."""
    for kinds, least in (((), 3000.0), (("rgb",), 45.0), (KINDS, 50.0)):
        value = rate(port, kinds, ticks if kinds else 10 * ticks)
        yield {
            "name": f"640 x 480, {len(kinds)} cameras of one mount",
            "value": value,
            "unit": "ticks/s",
            "target": f">= {least:g}",
            "holds": value >= least,
        }


def visits(client: Any) -> Iterator[Callable[[], Any]]:
    """Yield for ever ways to another world: loaded by its name, loaded again, sent as a map."""

    def named(name: str) -> Callable[[], Any]:
        return lambda: client.load_world(name, reset_settings=False)

    def sent(text: str) -> Callable[[], Any]:
        return lambda: client.generate_opendrive_world(text, reset_settings=False)

    while True:
        for road in SHIPPED_MAPS:
            yield named(road.id)
            yield lambda: client.reload_world(False)
            yield sent(read_map(road.file).decode())


def leaks(server: CarlaTestServer, ticks: int, worlds: int) -> Iterator[Row]:
    """Yield the growth over many worlds, and over many ticks with a camera."""
    client, _ = opened(server.port)
    ways = visits(client)

    def visit(count: int) -> None:
        for _ in range(count):
            world = next(ways)()
            car = car_of(world)
            ((camera, images),) = cameras_of(world, car, ("rgb",))
            world.tick()
            images.get(timeout=60)
            camera.stop()

    visit(3 * len(SHIPPED_MAPS))
    before = Usage.of(server.pid)
    visit(worlds)
    yield from Usage.of(server.pid).growth(before, f"{worlds} worlds")
    _, world = opened(server.port)
    car = car_of(world)
    ((camera, images),) = cameras_of(world, car, ("rgb",))
    for tick in range(-50, ticks):
        if tick == 0:
            before = Usage.of(server.pid)
        world.tick()
        images.get(timeout=60)
    yield from Usage.of(server.pid).growth(before, f"{ticks} ticks with a camera")
    camera.stop()


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


def script(port: int, phase: str, ready: Connection) -> None:
    """Do one thing over and over until the process ends."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    if phase == "start":
        ready.send(phase)
        while True:
            opened(port)
    client, world = opened(port)
    if phase == "spawns":
        ready.send(phase)
        while True:
            spawn_many(client, world)
    car = car_of(world)
    cameras = cameras_of(world, car, () if phase == "ticks" else KINDS)
    ready.send(phase)
    while True:
        world.tick()
        for _, images in cameras:
            images.get(timeout=60)


def spawn_many(client: Any, world: Any) -> None:
    """Spawn and destroy cars, and a sensor that listens."""
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    model, command = library.find("vehicle.audi.tt"), carla.command
    orders = [command.SpawnActor(model, place) for place in points[:20]]
    cars = [one.actor_id for one in client.apply_batch_sync(orders, True) if not one.has_error()]
    sensor = world.spawn_actor(
        library.find("sensor.other.imu"), carla.Transform(), attach_to=world.get_actor(cars[0])
    )
    sensor.listen(lambda event: None)
    world.tick()
    sensor.stop()
    client.apply_batch_sync([command.DestroyActor(car) for car in cars], True)


def end_one(port: int, rng: random.Random, context: Any) -> None:
    """Start a script, and end it at a random moment."""
    ours, theirs = context.Pipe()
    phase, how = rng.choice(("start", "ticks", "spawns", "streams")), rng.choice(SIGNALS)
    process = context.Process(target=script, args=(port, phase, theirs))
    process.start()
    theirs.close()
    if ours.poll(60.0):
        time.sleep(rng.uniform(0.0, 0.3))
    os.kill(process.pid, how)
    if how == signal.SIGSTOP:
        time.sleep(rng.uniform(0.0, 0.4))
    elif how != signal.SIGKILL:
        process.join(3.0)
    process.kill()
    process.join()
    ours.close()


def kills(server: CarlaTestServer, count: int) -> Iterator[Row]:
    """End scripts at random moments; yield what is left of them."""
    # Children of a fresh process that has the client loaded: most of a script's time is its import.
    context = multiprocessing.get_context("forkserver")
    rng, lost = random.Random(0), 0
    for number in range(-WARM, count):
        if number == 0:
            before = settled(server.pid)
        end_one(server.port, rng, context)
        lost += not server.is_alive
    yield row(f"servers that ended with one of {count} scripts", lost, "", 0)
    if lost:
        return
    yield from settled(server.pid, before).growth(before, f"{count} scripts")
    client = carla.Client("127.0.0.1", server.port, 1)
    client.set_timeout(60.0)
    left = len(client.get_world().wait_for_tick(60.0)) - 1
    yield row(f"actors left of {count} scripts", left, "", 0)


def settled(pid: int, before: Usage | None = None) -> Usage:
    """Return what a process holds once it has noticed that its clients are gone."""
    end = time.monotonic() + SETTLING_S
    while True:
        now = Usage.of(pid)
        is_back = before is not None and now.files <= before.files and now.threads <= before.threads
        if is_back or time.monotonic() > end:
            return now
        time.sleep(0.2)


def measured(ticks: int, worlds: int, count: int) -> Iterator[Row]:
    """Yield all figures."""
    with CarlaTestServer(simulator="pybullet") as server:
        yield from rates(server.port, ticks)
        yield row("frames that a second client misses", not watched(server.port, 1000), "", 0)
        yield from leaks(server, 1000, worlds)
        if count:
            yield from kills(server, count)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON list at the end")
    parser.add_argument("--ticks", type=int, default=300, help="how many ticks to time")
    parser.add_argument("--worlds", type=int, default=60, help="how many worlds to visit")
    parser.add_argument("--kills", type=int, default=200, help="how many scripts to end")
    options = parser.parse_args()
    # Each of the server's threads may get a heap of its own, up to eight per core: that is no leak.
    os.environ.setdefault("MALLOC_ARENA_MAX", "2")
    found, start = [], time.monotonic()
    for item in measured(options.ticks, options.worlds, options.kills):
        found.append(item)
        mark = "ok  " if item["holds"] else "MISS"
        since = time.monotonic() - start
        print(
            f"{mark} {item['name']}: {item['value']:.1f} {item['unit']} ({item['target']})"
            f"  [{since:.0f} s]",
            flush=True,
        )
    if options.json:
        print(json.dumps(found))
    return 0 if all(item["holds"] for item in found) else 1


if __name__ == "__main__":
    sys.exit(main())

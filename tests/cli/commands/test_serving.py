"""`oodscen serve`: an ordinary CARLA script drives a scene, and the command ends when asked."""

import queue
import re
import signal
import socket
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen.driving._motion.actions import action_driver
from oodscen.protocols import Camera
from oodscen.testing import example_scene
from oodscen.testing._flat import FlatSimulator

SCENE = example_scene()


def picture(world, hero, carla) -> tuple[object, "queue.SimpleQueue"]:
    """Return a camera where this library's own is mounted, and its pictures."""
    blueprint = world.get_blueprint_library().find("sensor.camera.rgb")
    for name, value in (("image_size_x", 160), ("image_size_y", 120), ("fov", 60)):
        blueprint.set_attribute(name, str(value))
    mount = carla.Transform(carla.Location(x=0.6, z=1.4), carla.Rotation(pitch=-2.0))
    camera, images = world.spawn_actor(blueprint, mount, attach_to=hero), queue.SimpleQueue()
    camera.listen(images.put)
    return camera, images


def test_a_script_drives_a_staged_scene(tmp_path):
    carla = pytest.importorskip("carla")
    file = tmp_path / "scenes.jsonl"
    file.write_text(SCENE.to_json() + "\n")
    order = [sys.executable, "-m", "oodscen", "serve", "--carla", "0", "--simulator", "flat"]
    with subprocess.Popen([*order, str(file)], stdout=subprocess.PIPE, text=True) as process:
        port = int(re.search(r":(\d+);", process.stdout.readline())[1])
        client = carla.Client("127.0.0.1", port)
        client.set_timeout(20.0)
        world = client.load_world(SCENE.id)
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
        world.apply_settings(settings)
        world.tick()
        vehicles = world.get_actors().filter("vehicle.*")
        (hero,) = [vehicle for vehicle in vehicles if vehicle.attributes["role_name"] == "hero"]
        camera, images = picture(world, hero, carla)
        # The client itself takes a tick when it applies the settings.
        seen = {world.tick(): n for n in range(3, 13)}
        shown = {seen[image.frame]: image for image in (images.get(timeout=20) for _ in seen)}
        speed = hero.get_velocity().length()
        hero.apply_control(carla.VehicleControl(brake=1.0))
        for _ in range(20):
            world.tick()
        assert hero.get_velocity().length() < speed - 5.0
        camera.stop()
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 143
    assert len(shown) == 10
    with FlatSimulator() as flat:
        flat.reset(SCENE, 0)
        driver = action_driver("keep_speed")
        for step in range(1, 13):
            flat.step(driver.act(flat.observe()))
            if step in shown:
                rgb = flat.render(Camera(width=160, height=120, pitch_deg=2.0)).rgb
                raw = np.frombuffer(shown[step].raw_data, np.uint8).reshape(120, 160, 4)
                assert np.array_equal(raw[..., 2::-1], rgb), step


@pytest.mark.parametrize("are_joined", [False, True])
def test_a_log_that_nobody_reads_delays_no_request(are_joined):
    msgpack = pytest.importorskip("msgpack")
    order = [sys.executable, "-m", "oodscen", "serve", "--carla", "0", "--simulator", "flat"]
    unread = subprocess.STDOUT if are_joined else subprocess.PIPE
    question = msgpack.packb([0, 1, "x" * 80, []])
    with subprocess.Popen(order, stdout=subprocess.PIPE, stderr=unread) as process:
        try:
            said = filter(None, (re.search(rb":(\d+);", line) for line in process.stdout))
            port = int(next(said)[1])
            with socket.create_connection(("127.0.0.1", port), 20) as client:
                for _ in range(2_000):  # More than a pipe holds and the log keeps.
                    client.sendall(question)
                    assert client.recv(1 << 16)
            log = process.stdout if are_joined else process.stderr
            assert any(b"further lines were dropped" in line for line in log)
        finally:
            process.kill()


@pytest.mark.parametrize(
    ("order", "line"),
    [
        (["serve"], "--carla"),
        (["serve", "--carla", "0", "--simulator", "nothing"], "unknown simulator"),
        (
            ["serve", "--carla", "0", "--host", "203.0.113.1", "--simulator", "flat"],
            "cannot listen",
        ),
    ],
)
def test_wrong_orders_are_one_line(order, line):
    result = CliRunner().invoke(main, order)
    assert result.exit_code == 2
    assert line in result.stderr


@pytest.mark.parametrize("host", ["", " "])
def test_an_empty_address_does_not_mean_every_network(host) -> None:
    found = CliRunner().invoke(main, ["serve", "--carla", "0", "--host", host])
    assert found.exit_code == 2
    assert "--host" in found.output

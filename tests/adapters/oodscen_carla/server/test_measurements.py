"""Pictures carry the semantic tags and the ids that CARLA gives them."""

import numpy as np
import pytest
from oodscen_carla.server import _measurements as wire
from oodscen_pybullet._meshes.tags import Tag

from oodscen.protocols import Frame

IDS, TAGS = np.array([0, 700, 31], np.int32), np.array([0, 14, 12], np.uint8)


def frame(ids: list[int], tags: list[int] | None) -> Frame:
    rows = np.array([ids], np.int32)
    shown = None if tags is None else np.array([tags], np.uint8)
    depth = np.where(np.array([tags or [11, 0, 0, 0]]) == 11, np.inf, 5.0).astype(np.float32)
    return Frame(np.zeros((1, 4, 3), np.uint8), depth, rows, tags=shown)


def test_classes_are_those_of_the_client():
    carla = pytest.importorskip("carla")
    labels = {name.lower(): int(one) for name, one in carla.CityObjectLabel.names.items()}
    assert {tag.name.replace("_", "").lower(): int(tag) for tag in Tag}.items() <= labels.items()
    assert (labels["sky"], labels["other"]) == (wire.SKY, wire.OTHER)


@pytest.mark.parametrize("kind", ["semantic", "instance"])
def test_bodies_hide_the_class_of_what_is_behind(kind):
    pixels = wire.picture(kind, frame([0, 0, 1, 2], [11, 1, 1, 24]), IDS, TAGS)
    assert pixels[0, :, 2].tolist() == [Tag.SKY, Tag.ROADS, 14, 12]
    numbers = pixels[0, :, 1] + 256 * pixels[0, :, 0].astype(int)
    assert numbers.tolist() == ([0, 0, 700, 31] if kind == "instance" else [0] * 4)
    assert (pixels[..., 3] == 255).all()


def test_a_simulator_that_cannot_tell_gives_sky_and_other():
    pixels = wire.picture("semantic", frame([0, 0, 1, 2], None), IDS, TAGS)
    assert pixels[0, :, 2].tolist() == [wire.SKY, wire.OTHER, 14, 12]
    unknown = wire.picture("semantic", frame([0, 0, 0, 0], [11, 0, 1, 1]), IDS, TAGS)
    assert unknown[0, :2, 2].tolist() == [wire.SKY, wire.OTHER]

"""A player of exported replays: polylines from vertex to vertex, absolute times."""

import math

import numpy as np
from lxml import etree


def centres(xosc: bytes, time: np.ndarray) -> dict[str, np.ndarray]:
    """Return x, y, z and heading of the centre of every entity's footprint at every time: [n, 4]."""
    root = etree.fromstring(xosc)
    poses = {}
    for private in root.iter("Private"):
        start = _vertex(private.find(".//TeleportAction/Position"))
        poses[private.get("entityRef")] = np.tile(start, (len(time), 1))
    for group in root.iter("ManeuverGroup"):
        name = group.find("Actors/EntityRef").get("entityRef")
        for line in group.iter("Polyline"):
            times = np.array([float(one.get("time")) for one in line])
            course = np.array([_vertex(one.find("Position")) for one in line])
            begun = time >= times[0] - 1e-9
            for column in range(5):
                poses[name][begun, column] = np.interp(time[begun], times, course[:, column])
    for entity in root.iter("ScenarioObject"):
        ahead = float(entity.find(".//BoundingBox/Center").get("x"))
        pose = poses[entity.get("name")]
        level = ahead * np.cos(pose[:, 4])
        pose[:, 0] += level * np.cos(pose[:, 3])
        pose[:, 1] += level * np.sin(pose[:, 3])
        pose[:, 2] -= ahead * np.sin(pose[:, 4])
    return {name: pose[:, :4] for name, pose in poses.items()}


def _vertex(position: etree._Element) -> list[float]:
    return [float(position[0].get(key)) for key in ("x", "y", "z", "h", "p")]


def turned(one: np.ndarray, other: np.ndarray) -> float:
    """Return the largest angle between headings, degrees."""
    return float(np.degrees(np.abs((one - other + math.pi) % math.tau - math.pi)).max())

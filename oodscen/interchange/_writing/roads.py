"""Roads: the OpenDRIVE file of a scene's map, as it is used."""

import hashlib
from pathlib import PurePath
from typing import NamedTuple

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import find_map, read_map

ROAD_DIGEST = 8
"""Digits of the SHA-256 of a user's road in the name of its file."""


class RoadFile(NamedTuple):
    """An OpenDRIVE file beside the scenarios that use it."""

    name: str
    content: bytes


def road_file(scene: Scene, catalogue: Catalogue) -> RoadFile:
    """Return the OpenDRIVE file of a scene.

    Raises:
        UnknownComponent: If the catalogue has no such map.
        DataError: If the file cannot be read.
    """
    road_map = find_map(scene.map, catalogue)
    content = read_map(road_map.file)
    name = PurePath(road_map.file.partition(":")[2] or road_map.file).name
    if scene.map.endswith(".xodr"):
        # Files of users may have one name and different roads.
        name = f"{PurePath(name).stem}-{hashlib.sha256(content).hexdigest()[:ROAD_DIGEST]}.xodr"
    return RoadFile(name, content)

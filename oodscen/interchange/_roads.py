"""Roads: the OpenDRIVE file of a scene's map, as it is used."""

from pathlib import PurePath
from typing import NamedTuple

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving import find_map
from oodscen.driving._roads.building import read_map


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
    return RoadFile(
        PurePath(road_map.file.partition(":")[2] or road_map.file).name, read_map(road_map.file)
    )

"""Unchanged exports of this library, which hold their scenes."""

import os
from pathlib import Path

from oodscen._io.files import file_sha256
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import read_map
from oodscen.errors import OodscenError
from oodscen.interchange._reading.tree import OpenScenarioFile
from oodscen.interchange._writing.properties import DIGEST, PREFIX, SCENE, content_digest
from oodscen.interchange._writing.roads import ROAD_DIGEST, road_file


def exported_scene(tree: OpenScenarioFile, catalogue: Catalogue) -> Scene | None:
    """Return the scene of which a file is an export, unless the file or the road file beside it was changed."""
    header = tree.header()
    holders = header.all("Properties", "Property")
    properties = {
        holder.element.get("name", ""): holder.element.get("value", "") for holder in holders
    }
    if SCENE not in properties:
        return None
    for holder in holders:
        if holder.element.get("name", "").startswith(PREFIX):
            holder.settle()
    if properties.get(DIGEST) != content_digest(tree.root.element, properties[SCENE]):
        header.note(
            "the file was changed after its export and is read by its elements, not by the header's properties"
        )
        return None
    scene = Scene.parse(properties[SCENE], source=str(tree.path))
    road = tree.root.first("RoadNetwork", "LogicFile")
    if road is None or _is_road_of(tree.path.parent / road.get("filepath"), scene, catalogue):
        return scene
    road.note(
        "the road file was changed after the export, and the file is read by its elements, not by the header's "
        "properties"
    )
    return None


def _is_road_of(path: Path, scene: Scene, catalogue: Catalogue) -> bool:
    """Return whether a road file is missing, or is the one that an export of the scene writes."""
    if not os.path.isfile(path):  # False also for a name that is too long.
        return True
    try:
        return read_map(str(path)) == road_file(scene, catalogue).content
    except OodscenError:
        # The map is not on this machine; names of users' roads hold their digests.
        digest = file_sha256(path).hex()[:ROAD_DIGEST]
        return not scene.map.endswith(".xodr") or path.stem.endswith(f"-{digest}")

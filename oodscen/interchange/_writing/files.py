"""OpenSCENARIO files with the files that belong to them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from oodscen._display import Brief
from oodscen._files import check_name, replace
from oodscen.interchange._writing.roads import RoadFile


@dataclass(frozen=True, repr=False)
class ScenarioFile(Brief):
    """One OpenSCENARIO file with the OpenDRIVE file that it refers to."""

    name: str
    """File name without its suffix: the scene's id, with `.logical` for a logical scenario."""
    xosc: bytes = field(repr=False)
    road: RoadFile = field(repr=False)
    notes: tuple[str, ...] = ()
    """The file's statements about its own exactness."""
    beside: Mapping[str, bytes] = field(default_factory=dict, repr=False, hash=False)
    """Further files by name: the distributions of a logical scenario's parameters."""

    def save(self, folder: str | Path) -> Path:
        """Write all files into a folder and return the path of the scenario.

        Raises:
            UsageError: If `folder` is not a usable path.
        """
        check_name(folder)
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        road = place / self.road.name
        if not road.exists() or road.read_bytes() != self.road.content:
            replace(road, self.road.content)
        path = place / f"{self.name}.xosc"
        replace(path, self.xosc)
        for name, content in self.beside.items():
            replace(place / name, content)
        return path

"""OpenSCENARIO files with the files that belong to them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from oodscen._display import Brief
from oodscen._io.files import check_name, replace, writing
from oodscen._io.study_files import refuse_own
from oodscen.errors import UsageError
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
            UsageError: If `folder` is not a usable path, or the scene's id is not a file's name.
            FolderTaken: If a file would belong to a study.
            OodscenError: If a file cannot be written.
        """
        check_name(folder)
        if Path(self.name).name != self.name:
            raise UsageError(
                f"the id of the scene, {self.name[:80]!r}, cannot be the name of a file"
            )
        target = Path(folder)
        path, road = target / f"{self.name}.xosc", target / self.road.name
        with writing(target):
            for file in (path, road, *(target / name for name in self.beside)):
                refuse_own(file)
            target.mkdir(parents=True, exist_ok=True)
            if not road.exists() or road.read_bytes() != self.road.content:
                replace(road, self.road.content)
            replace(path, self.xosc)
            for name, content in self.beside.items():
                replace(target / name, content)
        return path

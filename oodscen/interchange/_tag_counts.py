"""Numbers of scenes that have each tag of the operational design domain and of behaviour."""

from collections import Counter
from collections.abc import Iterable

from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.interchange._tags import KNOWN_TAGS, scene_tags


class TagCount(Data):
    """The number of scenes that have one tag."""

    tag: str
    area: str
    """Part of the taxonomy: `scenery`, `environment`, `dynamic elements` or `behaviour`."""
    scenes: int


class TagCoverage(Data):
    """The tags that scenes have, and those that they lack."""

    schema_version: int = 1
    scenes: int
    rows: tuple[TagCount, ...]
    """One row for each tag that a scene can have, by area, the most frequent first."""

    @property
    def holes(self) -> tuple[TagCount, ...]:
        """Tags that no scene has."""
        return tuple(row for row in self.rows if not row.scenes)

    def __str__(self) -> str:
        lines = [f"{self.scenes} scenes"]
        for area in KNOWN_TAGS:
            lines.append(area)
            lines += [
                f"  {row.tag:34}{row.scenes:6}{row.scenes / self.scenes:7.0%}"
                for row in self.rows
                if row.area == area and row.scenes
            ]
            if missing := [row.tag for row in self.holes if row.area == area]:
                lines.append(f"  none: {', '.join(missing)}")
        return "\n".join(lines)


def count_tags(scenes: Iterable[Scene], catalogue: Catalogue) -> TagCoverage:
    """Count the scenes that have each tag of `KNOWN_TAGS`.

    Args:
        scenes: The scenes.
        catalogue: The catalogue of their assets and maps.
    """
    found: Counter[str] = Counter()
    total = 0
    for scene in scenes:
        found.update(scene_tags(scene, catalogue).keys())
        total += 1
    rows = [
        TagCount(tag=tag, area=area, scenes=found[tag])
        for area, tags in KNOWN_TAGS.items()
        for tag in sorted(tags, key=lambda tag: (-found[tag], tag))
    ]
    return TagCoverage(scenes=total, rows=tuple(rows))

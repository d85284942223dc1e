"""The files of staged scenes: `staged.jsonl`, and `scenes.jsonl`, which follows from it but may be edited by hand."""

from collections.abc import Collection, Mapping
from typing import Any

from oodscen.data._scene import Scene
from oodscen.errors import DataError, Issue
from oodscen.study._staging import Staging
from oodscen.study._store import Store

SCENES = "scenes.jsonl"
"""File with one line per scenario, the scene that was run, followed by its ordinary demand."""
STAGED = "staged.jsonl"
"""File with one `Staging` per scenario."""

Line = dict[str, Any]


class StagedScenes:
    """The lines of `staged.jsonl`; of several with one id the last counts."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._lines: dict[str, Line] = {line["id"]: line for line in store.lines(STAGED)}
        self.by_id = {
            name: Staging.parse(line, source=f"{STAGED}, {name}")
            for name, line in self._lines.items()
            if line.get("status") != "failed"
        }
        """The scenes that could be staged."""

    @property
    def ran(self) -> dict[str, Scene]:
        """The scenes that were run, or will be run, by id."""
        return {name: staging.ran for name, staging in self.by_id.items()}

    def put(self, staging: Staging) -> None:
        """Replace a scene, and append its line."""
        self.by_id[staging.id] = staging
        self._store.append(STAGED, staging)

    def save(self) -> None:
        """Write `staged.jsonl`, one line per scene."""
        self._store.write_lines(
            STAGED, [self.by_id.get(name, line) for name, line in self._lines.items()]
        )

    def is_by_hand(self, scene: Scene) -> bool:
        """Return whether a scene of `scenes.jsonl` differs from the staged scene and from the one that was run."""
        staging = self.by_id.get(scene.id)
        return staging is None or scene not in (staging.scene, staging.run)

    def written(self, texts: Collection[str]) -> dict[str, Scene]:
        """Return the scenes of `scenes.jsonl` by id.

        Raises:
            DataError: If a line is malformed, or was added by hand and has none of the texts.
        """
        scenes: dict[str, Scene] = {}
        for number, line in enumerate(self._store.lines(SCENES), start=1):
            if line.get("status") == "failed":
                continue
            source = f"{self._store.path(SCENES)}, line {number}"
            scene = Scene.parse(line, source=source)
            if scene.is_ordinary:
                continue
            if scene.id not in texts and self.is_by_hand(scene):
                fault = (
                    f"there is no text {scene.id!r} in this study; remove the line, and run the scene by itself "
                    "with `oodscen simulate`"
                )
                raise DataError(Scene.noun, [Issue("", fault)], source=source)
            scenes[scene.id] = scene
        return scenes

    def take_edited(self) -> bool:
        """Replace the staged scenes by those that were edited by hand; return whether there are any."""
        edited = {
            name: Staging(id=name, made_from=self._lines[name]["made_from"], scene=scene)
            for name, scene in self.written(self._lines).items()
            if self.is_by_hand(scene)
        }
        stagings = self.by_id | edited
        self.by_id = {name: stagings[name] for name in self._lines if name in stagings}
        return bool(edited)

    def write_scenes(self, scenes: Mapping[str, Scene]) -> None:
        """Write `scenes.jsonl`: every scene with its demand, and a failure line for each that was not staged."""
        rows: list[Scene | Line] = []
        for name, line in self._lines.items():
            if name not in scenes:
                rows.append({key: value for key, value in line.items() if key != "made_from"})
                continue
            rows.append(scenes[name])
            if name in self.by_id and (demand := self.by_id[name].demand) is not None:
                rows.append(demand)
        self._store.write_lines(SCENES, rows)

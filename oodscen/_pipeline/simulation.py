"""Simulation of scenes into a folder that is no study; the same call continues one that was stopped."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from oodscen._io.study_files import REAR
from oodscen._pipeline.jobs import Job, Outputs
from oodscen._pipeline.steps.scenes import has_files
from oodscen._pipeline.sweep import sweep
from oodscen.data._base import digest
from oodscen.data._episode import Episode
from oodscen.data._scene import Scene
from oodscen.errors import FolderTaken
from oodscen.study._store import Store

EPISODES = "episodes.jsonl"
SETTINGS = "simulation.json"
"""File of what the folder's simulation is of: the job, and a digest of the scenes."""
_RESULTS = (EPISODES, REAR, "frames", "traces", "videos")


class Simulation:
    """A simulation of scenes into a folder, whose writer the caller is.

    Args:
        store: The folder.
        job: Settings for the workers.
        scenes: The scenes to run.
        workers: Simulation processes.

    Raises:
        FolderTaken: When the folder holds results of anything else.
    """

    def __init__(self, store: Store, job: Job, scenes: Sequence[Scene], *, workers: int) -> None:
        self._store, self._job, self._scenes, self._workers = store, job, scenes, workers
        settings = {"job": asdict(job), "scenes": digest([scene.digest() for scene in scenes])}
        existing = [name for name in (SETTINGS, *_RESULTS) if store.path(name).exists()]
        is_same = store.has(SETTINGS) and digest(store.read(SETTINGS)) == digest(settings)
        if existing and not is_same:
            raise FolderTaken(str(store.folder), existing)
        store.write_lines(SETTINGS, [settings])

    def run(self) -> Iterator[Episode]:
        """Yield the episodes as they finish, those of an earlier call first; each is written at once."""
        yield from self._episodes(self._job, EPISODES)

    def run_behind(self) -> Iterator[Episode]:
        """Yield the episodes of the pictures from the rear window, in the same way."""
        yield from self._episodes(replace(self._job, outputs=Outputs(), is_rear=True), REAR)

    def _episodes(self, job: Job, file: str) -> Iterator[Episode]:
        done = {line["id"]: Episode.parse(line) for line in self._valid_lines(file)}
        yield from done.values()
        waiting = [scene for scene in self._scenes if scene.id not in done]
        for result in sweep(job, waiting, workers=self._workers):
            result.save(self._store)
            self._store.append(file, result.episode)
            done[result.episode.id] = result.episode
            yield result.episode
        self._store.write_lines(file, (done[scene.id] for scene in self._scenes))

    def _valid_lines(self, file: str) -> Iterator[Mapping[str, Any]]:
        """Yield the lines of an earlier call whose files are there; episodes that failed are run again."""
        for line in self._store.lines(file):
            if line.get("status") != "failed" and has_files(self._store, line):
                yield line

"""The scenes of a session: which of them tests drive, with their texts, marks and plans."""

import re
from collections import Counter
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from oodscen._words.text import one_line
from oodscen.data._catalogue import Catalogue
from oodscen.data._pairing import leaf_in, scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.errors import OodscenError
from oodscen.interchange._tags import scene_tags
from oodscen.protocols import Simulator
from oodscen.stages._drive import DrivePlan

if TYPE_CHECKING:
    from oodscen.study._study import Study


class Scenes:
    """The scenes that a test session drives: their texts, plans of their drives, and where pictures go.

    Args:
        study: Has the scenes, their texts and their safe actions.
        seed: Seed of the simulator's random streams.
        pictures: Folder for pictures of failed drives; `None` for none.
    """

    def __init__(self, study: "Study", seed: int, pictures: Path | None) -> None:
        self._study = study
        self.seed = seed
        self.pictures = pictures
        self._plans: dict[tuple[str, int], DrivePlan] = {}

    @cached_property
    def texts(self) -> dict[str, Scenario]:
        """The text of every scene, by the scene's id."""
        return {scenario.id: scenario for scenario in self._study.scenarios}

    @cached_property
    def safe_actions(self) -> dict[str, tuple[str, ...]]:
        """The actions that the study found safe, by id of the scene or twin."""
        return {
            episode.scene_id: tuple(episode.safe_set)
            for episode in self._study.episodes
            if episode.status == "ok"
        }

    def first_per_path(self, count: int | None) -> list[Scene]:
        """Return the first scenes of every path of the scenario tree, or all of them."""
        counts: Counter[tuple[str, ...]] = Counter()
        chosen = []
        for scene in self._study.scenes:
            path = self.path(scene) or (leaf_in(scene.id),)
            counts[path] += 1
            if count is None or counts[path] <= count:
                chosen.append(scene)
        return chosen

    def marks(self, scene: Scene, catalogue: Catalogue | None) -> list[str]:
        """Return the names of a scene's marks: the labels of its path, and its tags in ASAM OpenLABEL's ontology.

        Args:
            scene: A scene of the study.
            catalogue: The simulator's catalogue, without which scenes have no tags.
        """
        names = [f"path_{_slug(label)}" for label in self.path(scene)[1:]]
        if catalogue is not None:
            with suppress(OodscenError):
                tags = scene_tags(scene, catalogue)
                names += [f"tag_{name}" for name in tags if not name.endswith("Value")]
        return list(dict.fromkeys(names))

    def plan(self, scene: Scene, simulator: Simulator) -> DrivePlan:
        """Return the plan of a scene's drives in a simulator."""
        key = (scene.digest(), id(simulator))  # The plan holds the simulator: its id stays its own.
        if key not in self._plans:
            self._plans[key] = DrivePlan(scene, simulator, self.seed)
        return self._plans[key]

    def text(self, scene: Scene) -> str:
        """Return the text of a scene, twin or demand on one line, empty if the study has none."""
        if scene.demand is not None:
            return one_line(scene.demand.text)
        scenario = self._text_of(scene)
        if scenario is None:
            return ""
        return one_line((scenario.ordinary if scene.is_twin else scenario.text) or "")

    def path(self, scene: Scene) -> tuple[str, ...]:
        """Return the path of the scenario tree to which a scene, twin or demand belongs, empty if the study has no text."""
        scenario = self._text_of(scene)
        return scenario.path if scenario else ()

    def _text_of(self, scene: Scene) -> Scenario | None:
        return self.texts.get(scene_of(scene.id))


def _slug(label: str) -> str:
    return re.sub(r"[\W_]+", "_", label.lower()).strip("_")

"""The scenes of a study or a file that a command is given, and what is known of them."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click
from click.core import ParameterSource

from oodscen._cli.output import read_lines
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.errors import UsageError

if TYPE_CHECKING:
    from oodscen.study._study import Study


class SceneSource(NamedTuple):
    """The scenes of a study or a file, and with what they were or are to be run."""

    scenes: list[Scene]
    catalogue: Catalogue
    facts: "KnownFacts"
    simulator: str
    """Name of the study's own simulator, or for a file that of the option."""
    seed: int
    """Seed of the study's runs; 0 for a file."""
    reaction_s: float
    """Time after which the ego acts in the drives that the study records, s."""


class KnownFacts(NamedTuple):
    """A study's knowledge of its scenes, as properties."""

    scenarios: Mapping[str, Scenario] = {}
    episodes: Mapping[str, Episode] = {}
    stated: Mapping[str, list[Any]] = {}
    """The claims of texts as data, by the id of their scene."""
    demands: Mapping[str, Scene] = {}
    """Ordinary demands by the id of their scene."""

    @classmethod
    def from_study(cls, study: "Study") -> "KnownFacts":
        """Read what a study knows."""
        rows = study.store.lines("claims.jsonl") if "claims.jsonl" in study.own() else ()
        return cls(
            {scenario.id: scenario for scenario in study.scenarios},
            {episode.scene_id: episode for episode in study.episodes},
            {row["id"]: row["claims"] for row in rows if row.get("status") != "failed"},
            _by_scene(study.demands),
        )

    def of(self, scenes: Sequence[Scene]) -> "KnownFacts":
        """Return what is known of some scenes and their twins."""
        ids = {scene.id for scene in scenes}
        texts = {scene.scenario_id for scene in scenes}
        return KnownFacts(
            {name: scenario for name, scenario in self.scenarios.items() if name in texts},
            {
                name: episode
                for name, episode in self.episodes.items()
                if {name, scene_of(name)} & ids
            },
            {name: claims for name, claims in self.stated.items() if name in ids},
            {name: demand for name, demand in self.demands.items() if name in ids},
        )

    def demands_of(self, scene: Scene) -> list[Scene]:
        """Return the ordinary demand of a scene, if it has one."""
        return [self.demands[scene.id]] if scene.id in self.demands else []

    def claims(self, scene: Scene) -> list[Claim]:
        """Return the claims of a scene's text."""
        if scene.demand is not None:
            return list(scene.demand.claims)
        return [Claim.parse(claim) for claim in self.stated.get(scene_of(scene.id), [])]

    def __call__(self, scene: Scene) -> dict[str, str]:
        from oodscen.interchange._writing.properties import facts

        text, run = self.scenarios.get(scene.scenario_id), self.episodes.get(scene.id)
        return facts(scene, text, self.claims(scene), run)


def scenes_of(place: Path, simulator: str) -> SceneSource:
    """Return the scenes of a study or a file; the simulator is that of a file."""
    from oodscen import make_simulator
    from oodscen.stages._safe_actions import Trials
    from oodscen.study._study import Study

    if place.is_dir():
        study = Study.open(place)
        _refuse_other_simulator(study.config.simulator)
        own = study.config.simulator
        catalogue, facts = make_simulator(own).catalogue(), KnownFacts.from_study(study)
        reaction_s = Trials.of(study.config.reaction).middle
        return SceneSource(study.scenes, catalogue, facts, own, study.config.seed, reaction_s)
    rows = read_lines(Scene, place)
    ids = {row.id for row in rows}
    demands = _by_scene(row for row in rows if row.demand and scene_of(row.id) in ids)
    apart = {demand.id for demand in demands.values()}
    scenes = [row for row in rows if row.id not in apart]
    catalogue = make_simulator(simulator).catalogue()
    return SceneSource(
        scenes, catalogue, KnownFacts(demands=demands), simulator, 0, NOMINAL_REACTION_S
    )


def _refuse_other_simulator(own: str) -> None:
    """Refuse a named simulator that is not the study's own, which would be ignored."""
    context = click.get_current_context()
    is_named = context.get_parameter_source("simulator") is ParameterSource.COMMANDLINE
    if is_named and (named := context.params["simulator"]) != own:
        raise UsageError(
            f"the study's scenes were made for {own}; --simulator {named} is for files"
        )


def _by_scene(demands: Iterable[Scene]) -> dict[str, Scene]:
    return {scene_of(demand.id): demand for demand in demands}

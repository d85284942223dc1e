"""Realisation of hazards: the means of a catalogue to show one, and the ones it lacks."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from oodscen.author._knowledge.base import Counterpart, HazardKind, Knowledge, RecipeActor
from oodscen.author._settings import Showable
from oodscen.author._staging.anchors import has_landmarks, landmarks_needed
from oodscen.data._additions import Addition, map_with
from oodscen.data._scene import is_weather_kind
from oodscen.prompts._digest import AssetLine, CatalogueDigest
from oodscen.prompts._tree.judge_branch import Substitute

NO_RECIPE = Addition(kind="other", name="a staging recipe for this kind of scenario")
"""A missing recipe, which no catalogue can supply: the author does not know how to stage the scenario."""


@dataclass
class Realisation:
    """The means of a catalogue to show a hazard, and the ones it lacks."""

    hazard: HazardKind | None
    """`None` if the author knows no such hazard."""
    catalogue: CatalogueDigest
    knowledge: Knowledge
    """The knowledge base, for acceptable substitutes."""
    assets: list[str] = field(default_factory=list)
    states: list[str] = field(default_factory=list)
    behaviours: list[str] = field(default_factory=list)
    weather: list[str] = field(default_factory=list)
    traits: list[str] = field(default_factory=list)
    substitutes: list[Substitute] = field(default_factory=list)
    missing: list[Addition] = field(default_factory=list)
    why: str = ""
    """The reason if there is no hazard."""

    def lack(self, addition: Addition) -> None:
        """Record a missing item, once."""
        if not any(other.brings(addition) for other in self.missing):
            self.missing.append(addition)

    def use(self, options: Sequence[str], states: Sequence[str] = ()) -> None:
        """Use the first asset that is one of the options, or an acceptable substitute for one."""
        offered = [asset for name in options for asset in self.catalogue.called(name)]
        able = [asset for asset in offered if set(states) <= set(asset.states)]
        if able:
            asset = able[0]
            self.assets.append(asset.id)
            if states and states[0] != asset.states[0]:
                self.states.append(f"{asset.id}: {states[0]}")
        elif offered:
            self._use_in_other_state(options[0], offered[0], states)
        elif not self._use_substitute(options, states):
            category = self.knowledge.category(options[0])
            self.lack(Addition(kind="asset", name=options[0], category=category))

    def _use_in_other_state(self, name: str, asset: AssetLine, states: Sequence[str]) -> None:
        """Use an asset without some of the wanted states; a signal is nothing without them."""
        missing = [f"{name}: {state}" for state in states if state not in asset.states]
        if asset.category == "signal":
            for state in missing:
                self.lack(Addition(kind="state", name=state))
            return
        self.assets.append(asset.id)
        self.substitutes += [Substitute(asset=asset.id, stands_for=state) for state in missing]

    def _use_substitute(self, options: Sequence[str], states: Sequence[str]) -> bool:
        """Use the closest acceptable substitute for one of the options, and return whether there is one."""
        for option in options:
            for name in self.knowledge.substitutes.get(option, ()):
                for asset in self.catalogue.called(name):
                    if set(states) <= set(asset.states):
                        self.assets.append(asset.id)
                        self.substitutes.append(Substitute(asset=asset.id, stands_for=option))
                        return True
        return False

    def cast(self, actor: RecipeActor) -> None:
        """Use an asset for an actor and, if it needs another one, for its counterpart."""
        states = [actor.state] if actor.state else []
        counterpart = actor.ordinary if isinstance(actor.ordinary, Counterpart) else Counterpart()
        if states and counterpart.state and not counterpart.asset:
            states.append(counterpart.state)
        self.use(actor.asset, states)
        if counterpart.asset:
            twin = Realisation(self.hazard, self.catalogue, self.knowledge)
            twin.use(counterpart.asset)
            for addition in twin.missing:
                self.lack(addition)

    def find_map(self, hazard: HazardKind) -> None:
        """Record the traits of a map that shows the hazard, or that it is missing."""
        traits, recipe = hazard.needs.traits, hazard.stage
        marks = landmarks_needed(recipe) if recipe else ()
        maps = self.catalogue.maps
        fitting = [road for road in maps if set(traits) <= set(road.features)]
        if any(has_landmarks(road, recipe) for road in fitting):
            self.traits = list(dict.fromkeys((*traits, *marks)))
            shown = Showable(self.knowledge, self.catalogue)
            lacking = shown.lacking_place(hazard) if recipe else ()
            if lacking:
                self.lack(map_with((*lacking, *traits, *marks)))
            return
        offered = {trait for road in maps for trait in road.features}
        is_one = not fitting and len(traits) == 1 and traits[0] in offered
        self.lack(map_with(traits if is_one else (*traits, *marks)))


def realise(hazard: HazardKind, catalogue: CatalogueDigest, knowledge: Knowledge) -> Realisation:
    """Look up everything that a hazard needs in a catalogue."""
    realisation = Realisation(hazard, catalogue, knowledge)
    recipe = hazard.stage
    actors = recipe.actors if recipe else ()
    for actor in actors:
        realisation.cast(actor)
    options = {name for actor in actors for name in actor.asset}
    for name in hazard.needs.assets:
        if name not in options:
            realisation.use((name,))
    behaviours = {behaviour.id for behaviour in catalogue.behaviours}
    used = recipe.behaviours if recipe else ()
    for name in dict.fromkeys((*hazard.needs.behaviours, *used)):
        if name in behaviours:
            realisation.behaviours.append(name)
        else:
            realisation.lack(Addition(kind="behaviour", name=name))
    limits = catalogue.limits
    for name in hazard.needs.weather:
        if not limits.offers(name):
            realisation.lack(Addition(kind="weather", name=name))
        elif is_weather_kind(name):
            realisation.weather.append(name)
    realisation.find_map(hazard)
    if recipe is None:
        realisation.lack(NO_RECIPE)
    else:
        realisation.behaviours = [name for name in realisation.behaviours if name in used]
    realisation.assets = list(dict.fromkeys(realisation.assets))
    return realisation


def all_missing(realisations: Iterable[Realisation]) -> list[Addition]:
    """Return the items that a catalogue lacks for several hazards, each once."""
    additions: list[Addition] = []
    for realisation in realisations:
        additions += [addition for addition in realisation.missing if addition not in additions]
    return additions

"""Realisation of hazards: the means of a catalogue to show one, and the ones it lacks."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import chain

from oodscen.author._knowledge.base import Counterpart, HazardKind, Knowledge, RecipeActor
from oodscen.author._settings import Showable
from oodscen.author._staging.anchors import has_landmarks, landmarks_needed
from oodscen.data._additions import Addition, map_with
from oodscen.data._weather import is_weather_kind
from oodscen.prompts._digest import AssetLine, CatalogueDigest
from oodscen.prompts._tree.judge_branch import Substitute

NO_RECIPE = Addition(kind="other", name="a staging recipe for this kind of scenario")
"""A missing recipe, which no catalogue can supply: the author does not know how to stage the scenario."""


Way = tuple[Addition, ...]
"""Additions to a catalogue that meet a need together."""


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
    exact: bool = False
    """Only the things themselves count, no substitutes."""
    needs: list[list[Way]] = field(default_factory=list)
    """Ways to meet each need that is not met; with `exact` also of each that only a substitute meets."""

    def lack(self, addition: Addition, ways: Sequence[Way] = ()) -> None:
        """Record a missing item, once, and the ways to meet the need for it."""
        self.needs.append([*ways] or [(addition,)])
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
            self._use_in_other_state(options, offered[0], states)
        elif self._use_substitute(options, states):
            self._leave_open(options, states)
        else:
            self.lack(self._thing(options[0]), self._ways(options, states))

    def _use_in_other_state(
        self, options: Sequence[str], asset: AssetLine, states: Sequence[str]
    ) -> None:
        """Use an asset without some of the wanted states; a signal is nothing without them."""
        missing = [f"{options[0]}: {state}" for state in states if state not in asset.states]
        if asset.category == "signal":
            for state in missing:
                self.lack(Addition(kind="state", name=state), self._ways(options, states))
            return
        self.assets.append(asset.id)
        self.substitutes += [Substitute(asset=asset.id, stands_for=state) for state in missing]
        self._leave_open(options, states)

    def _leave_open(self, options: Sequence[str], states: Sequence[str]) -> None:
        """Record the ways to do without a substitute, if only the things themselves count."""
        if self.exact:
            self.needs.append(self._ways(options, states))

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

    def _thing(self, name: str) -> Addition:
        return Addition(kind="asset", name=name, category=self.knowledge.category(name))

    def _ways(self, options: Sequence[str], states: Sequence[str]) -> list[Way]:
        """Return the ways to get one of the options: its states if the catalogue has it, else it and its states.

        Without `exact`, a thing that is no signal will do in another state, and a substitute in the right one.
        """
        ways: list[Way] = []
        for name in options:
            is_signal = self.knowledge.category(name) == "signal"
            needs_states = self.exact or is_signal or self.catalogue.called(name)
            ways.append(self._way(name, states if needs_states else ()))
        if not self.exact:
            substitutes = (self.knowledge.substitutes.get(option, ()) for option in options)
            ways += [self._way(name, states) for name in chain.from_iterable(substitutes)]
        return ways

    def _way(self, name: str, states: Sequence[str]) -> Way:
        """Return what the catalogue lacks of a thing in some states."""
        has = self.catalogue.called(name)
        known = has[0].states if has else ()
        lacking = (state for state in states if state not in known)
        named = (Addition(kind="state", name=f"{name}: {state}") for state in lacking)
        return (*(() if has else (self._thing(name),)), *named)

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
            for addition, ways in zip(twin.missing, twin.needs, strict=True):
                self.lack(addition, ways)

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


def realise(
    hazard: HazardKind, catalogue: CatalogueDigest, knowledge: Knowledge, *, exact: bool = False
) -> Realisation:
    """Look up everything that a hazard needs in a catalogue; with `exact`, substitutes leave their needs open."""
    realisation = Realisation(hazard, catalogue, knowledge, exact=exact)
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

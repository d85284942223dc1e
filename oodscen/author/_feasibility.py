"""Judgement of what a simulator can show: the needs and recipe of a hazard against a catalogue's digest."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from oodscen.author._knowledge.base import Counterpart, HazardKind, Knowledge, RecipeActor
from oodscen.author._reading.readings import Alternative, LabelReading, RequiredThing
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._settings import Showable
from oodscen.author._staging.anchors import has_landmarks, landmarks_needed
from oodscen.data._additions import Addition, map_with
from oodscen.data._scene import is_weather_kind
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._tree.judge_branch import (
    BranchJudgement,
    BranchJudgements,
    JudgeBranch,
    JudgeBranches,
    NumberedJudgement,
    Substitute,
)
from oodscen.tree._scenario_tree import MAX_LABEL

NO_RECIPE = Addition(kind="other", name="a staging recipe for this kind of scenario")
"""A missing recipe, which no catalogue can supply: the author does not know how to stage the scenario."""
_MOST = 40
"""Largest number of names of one kind in an answer."""


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
        if not any(known.brings(addition) for known in self.missing):
            self.missing.append(addition)

    def use(self, options: Sequence[str], states: Sequence[str] = ()) -> None:
        """Use the first asset that is one of the options, or an acceptable substitute for one."""
        there = [asset for name in options for asset in self.catalogue.called(name)]
        able = [asset for asset in there if set(states) <= set(asset.states)]
        if able:
            self.assets.append(able[0].id)
            if states and states[0] != able[0].states[0]:
                self.states.append(f"{able[0].id}: {states[0]}")
            return
        if there:
            lacking = [f"{options[0]}: {state}" for state in states if state not in there[0].states]
            if there[0].category == "signal":
                for name in lacking:
                    self.lack(Addition(kind="state", name=name))
                return
            self.assets.append(there[0].id)
            self.substitutes += [Substitute(asset=there[0].id, stands_for=name) for name in lacking]
            return
        for wanted in options:
            for name in self.knowledge.substitutes.get(wanted, ()):
                near = [a for a in self.catalogue.called(name) if set(states) <= set(a.states)]
                if near:
                    self.assets.append(near[0].id)
                    self.substitutes.append(Substitute(asset=near[0].id, stands_for=wanted))
                    return
        category = self.knowledge.category(options[0])
        self.lack(Addition(kind="asset", name=options[0], category=category))

    def cast(self, actor: RecipeActor) -> None:
        """Use an asset for an actor and, if it needs another one, for its counterpart."""
        states = [actor.state] if actor.state else []
        twin = actor.ordinary if isinstance(actor.ordinary, Counterpart) else Counterpart()
        if states and twin.state and not twin.asset:
            states.append(twin.state)
        self.use(actor.asset, states)
        if twin.asset:
            counterpart = Realisation(self.hazard, self.catalogue, self.knowledge)
            counterpart.use(twin.asset)
            for addition in counterpart.missing:
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
            wanted = shown.lacking_place(hazard) if recipe else ()
            if wanted:
                self.lack(map_with((*wanted, *traits, *marks)))
            return
        there = {trait for road in maps for trait in road.features}
        is_one = not fitting and len(traits) == 1 and traits[0] in there
        self.lack(map_with(traits if is_one else (*traits, *marks)))


@dataclass
class Option:
    """One alternative of a label; all of its parts are needed."""

    words: str
    found: list[Realisation]

    @property
    def missing(self) -> list[Addition]:
        """Items that the catalogue lacks."""
        return _together(self.found)

    @property
    def hazards(self) -> list[HazardKind]:
        """Hazards that the alternative shows."""
        return [realisation.hazard for realisation in self.found if realisation.hazard is not None]


class BranchJudge:
    """Answers `JudgeBranch` and `JudgeBranches`, by the hazards that a recogniser finds."""

    def __init__(self, recogniser: Recogniser) -> None:
        self.recogniser = recogniser
        self.knowledge = recogniser.knowledge

    def judge(self, prompt: JudgeBranch) -> BranchJudgement:
        """Return the means to show a branch, or the items that are missing.

        A label may name several alternatives, any of which is enough. If only some can be shown,
        the label is narrowed to those.
        """
        label = prompt.path[-1] if prompt.path else ""
        reading = self._reading(label)
        options = [
            self._option(alternative, prompt.catalogue) for alternative in reading.alternatives
        ]
        shown = [number for number, one in enumerate(options) if not one.missing]
        hidden = [option for option in options if option.missing]
        if not shown:
            return self._dropped(label, reading, options, prompt.catalogue)
        if reading.is_any:
            exact = [
                n
                for n in shown
                if not any(realisation.substitutes for realisation in options[n].found)
            ]
            shown = exact or shown
            hidden = [] if 0 in shown else hidden
        narrower = ""
        if hidden:
            narrower, shown = self._narrowed(reading, options, shown)
        return self._kept([options[number] for number in shown], hidden, narrower, prompt.catalogue)

    def judge_all(self, prompt: JudgeBranches) -> BranchJudgements:
        """Judge each of several branches as if it were asked about alone."""
        return BranchJudgements(
            judgements=[
                NumberedJudgement(number=number, **self.judge(prompt.single(number)).model_dump())
                for number in range(1, len(prompt.paths) + 1)
            ]
        )

    def _reading(self, label: str) -> LabelReading:
        """Return the alternatives of a label; a widened label stands for the hazard and its kin."""
        written = self.recogniser.written(label)
        if not written:
            return self.recogniser.reading(label)
        return LabelReading(tuple(Alternative(h.label, (RequiredThing(h),)) for h in written))

    def _option(self, alternative: Alternative, catalogue: CatalogueDigest) -> Option:
        found = []
        for part in alternative.parts:
            realisation = Realisation(None, catalogue, self.knowledge)
            if part.hazard is not None:
                realisation = realise(part.hazard, catalogue, self.knowledge)
            for name in part.things:
                realisation.use((name,))
            for name in part.weather:
                if catalogue.limits.offers(name):
                    realisation.weather = list(dict.fromkeys((*realisation.weather, name)))
                else:
                    realisation.lack(Addition(kind="weather", name=name))
            offered = {asset.category for asset in catalogue.assets}
            if not part.things and part.category is not None and part.category not in offered:
                realisation.lack(Addition(kind="asset", name=part.category, category=part.category))
            if part.hazard is None:
                realisation.lack(NO_RECIPE)
                realisation.why = part.why
            realisation.substitutes += [
                Substitute(asset=realisation.assets[0], stands_for=words)
                for words in part.approximate
                if realisation.assets
            ]
            realisation.assets = list(dict.fromkeys(realisation.assets))
            found.append(realisation)
        return Option(alternative.words, found)

    def _dropped(
        self,
        label: str,
        reading: LabelReading,
        options: Sequence[Option],
        catalogue: CatalogueDigest,
    ) -> BranchJudgement:
        """Explain what is missing, and request the items of the alternative that lacks the fewest."""
        if not options:
            return BranchJudgement(
                reasoning=f"The author has no knowledge of {label!r}.",
                simulatable=False,
                missing=[NO_RECIPE],
            )
        least = next((option for option in options if NO_RECIPE not in option.missing), options[0])
        reason = _lacks(least.found, catalogue)
        if len(options) > 1 and not reading.is_any:
            whys = (
                f"not {_small(option.words)}: {_lacks(option.found, catalogue, is_short=True)}"
                for option in options
            )
            reason = f"{'; '.join(whys)}."
            reason = f"{reason[0].upper()}{reason[1:]}"
        return BranchJudgement(reasoning=reason, simulatable=False, missing=least.missing)

    def _narrowed(
        self, reading: LabelReading, options: Sequence[Option], shown: Sequence[int]
    ) -> tuple[str, list[int]]:
        """Return a label for the alternatives that can be shown, and the ones that fit into it."""
        if reading.split is not None:
            text = reading.split.naming(tuple(shown))
            wanted = {hazard.id for number in shown for hazard in options[number].hazards}
            if {hazard.id for hazard in self.recogniser.covered_by(text)} == wanted:
                return text, list(shown)
        labels = [hazard.label for number in shown for hazard in options[number].hazards[:1]]
        text, count = _joined(labels)
        return text, list(shown[:count])

    def _kept(
        self,
        shown: Sequence[Option],
        hidden: Sequence[Option],
        narrower: str,
        catalogue: CatalogueDigest,
    ) -> BranchJudgement:
        realisations = [realisation for option in shown for realisation in option.found]
        standing = {
            s.stands_for: s for realisation in realisations for s in realisation.substitutes
        }
        if len(shown) == 1:
            reason = f"The simulator has what shows {_listed(realisations)}."
        else:
            reason = f"The simulator shows {'; '.join(dict.fromkeys(map(_with_what, shown)))}."
        for option in hidden:
            lacks = _lacks(option.found, catalogue, is_short=True)
            reason += f" Not {_small(option.words)}: {lacks}."
        if standing:
            parts = (
                f"{s.asset} stands for {s.stands_for.replace('_', ' ')}" for s in standing.values()
            )
            reason += f" Not with the thing itself: {', '.join(parts)}."
        return BranchJudgement(
            reasoning=reason,
            simulatable=True,
            assets=_united(realisation.assets for realisation in realisations),
            states=_united(realisation.states for realisation in realisations),
            behaviours=_united(realisation.behaviours for realisation in realisations),
            weather=_united(realisation.weather for realisation in realisations),
            traits=_united(realisation.traits for realisation in realisations),
            substitutes=list(standing.values()),
            label=narrower,
            missing=_together([realisation for option in hidden for realisation in option.found])
            if hidden
            else _originals(standing.values(), self.knowledge),
        )


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


def _originals(standing: Iterable[Substitute], knowledge: Knowledge) -> list[Addition]:
    """Return the additions that would make the substitutes unnecessary."""
    return [
        Addition(kind="state", name=s.stands_for)
        if ": " in s.stands_for
        else Addition(kind="asset", name=s.stands_for, category=knowledge.category(s.stands_for))
        for s in {s.stands_for: s for s in standing}.values()
    ]


def _together(hidden: Iterable[Realisation]) -> list[Addition]:
    additions: list[Addition] = []
    for realisation in hidden:
        additions += [addition for addition in realisation.missing if addition not in additions]
    return additions


def _lacks(
    hidden: Sequence[Realisation], catalogue: CatalogueDigest, *, is_short: bool = False
) -> str:
    """Describe the missing items, and the categories of which the catalogue has no asset at all."""
    additions = _together(hidden)
    lacking = [_lacking(kind, additions) for kind in _KINDS]
    lacking = [part for part in lacking if part]
    offered = {asset.category for asset in catalogue.assets}
    empty = [
        _PLURAL.get(category, f"{category}s")
        for category in dict.fromkeys(a.category for a in additions if a.kind == "asset")
        if category is not None and category not in offered
    ]
    text = f"the simulator lacks {' and '.join(lacking)}" if lacking else ""
    if empty:
        text += f"; it has no {' and no '.join(empty)} at all"
    whys = list(dict.fromkeys(realisation.why for realisation in hidden if realisation.why))
    if whys:
        text += f"{', and ' if lacking else ''}{', and '.join(whys)}"
    elif NO_RECIPE in additions:
        joint = ", and" if lacking else "everything it needs is there, but"
        text += f"{joint} the author does not know how to stage it recognisably"
    return text if is_short else f"{text[0].upper()}{text[1:]}."


_KINDS = {
    "asset": ("asset", "assets"),
    "state": ("state", "states"),
    "behaviour": ("behaviour", "behaviours"),
    "weather": ("weather", "weather"),
    "map": ("map", "maps"),
}
"""Kinds of additions, in the order in which a reason names them."""


def _lacking(kind: str, additions: Sequence[Addition]) -> str:
    """Name the missing items of one kind: `trench, deep water (assets)`."""
    named = [addition.words.split(": ", 1)[-1] for addition in additions if addition.kind == kind]
    if not named:
        return ""
    return f"{', '.join(named)} ({_KINDS[kind][len(named) > 1]})"


_PLURAL = {"vegetation": "plants or fallen trees", "work_zone": "things of road works"}


def _listed(found: Sequence[Realisation]) -> str:
    labels = dict.fromkeys(
        _small(realisation.hazard.label) for realisation in found if realisation.hazard is not None
    )
    return " and ".join(labels)


def _with_what(option: Option) -> str:
    """Name the means to show an alternative: `fallen tree across the road by fallen_tree`."""
    means = _united((*realisation.assets, *realisation.weather) for realisation in option.found)
    by = f" by {', '.join(means)}" if means else ""
    return f"{_listed(option.found)}{by}"


def _united(lists: Iterable[Iterable[str]]) -> list[str]:
    return list(dict.fromkeys(name for names in lists for name in names))[:_MOST]


def _small(label: str) -> str:
    return f"{label[0].lower()}{label[1:]}"


def _joined(labels: Sequence[str]) -> tuple[str, int]:
    """Join as many labels as fit, in a form that the recogniser can split; return the text and their number."""
    text = labels[0]
    for number, label in enumerate(labels[1:], start=1):
        longer = f"{text}, or {_small(label)}"
        if len(longer) > MAX_LABEL:
            return text, number
        text = longer
    return text, len(labels)

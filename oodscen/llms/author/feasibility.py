"""Judging what a simulator can show: a hazard's needs and recipe against a catalogue's digest."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from oodscen.llms.author.anchors import has_landmarks, landmarks_needed
from oodscen.llms.author.knowledge import Counterpart, Hazard, Knowledge, RecipeActor
from oodscen.llms.author.recognise import Recogniser
from oodscen.prompts import BranchJudgement, CatalogueDigest, JudgeBranch
from oodscen.prompts.digest import WeatherLimits
from oodscen.prompts.judge_branch import WEATHER_SCALES, Substitute
from oodscen.pruning.additions import Addition, map_with
from oodscen.tree import MAX_LABEL

__all__ = ["Judge", "Realisation", "WeatherLimits", "realise"]

NO_RECIPE = Addition(kind="other", name="a staging recipe for this kind of scenario")
"""What no catalogue can bring: the author does not know how to stage it."""


@dataclass
class Realisation:
    """With what a catalogue shows a hazard, and what it lacks."""

    hazard: Hazard
    assets: list[str] = field(default_factory=list)
    states: list[str] = field(default_factory=list)
    behaviours: list[str] = field(default_factory=list)
    weather: list[str] = field(default_factory=list)
    traits: list[str] = field(default_factory=list)
    substitutes: list[Substitute] = field(default_factory=list)
    missing: list[Addition] = field(default_factory=list)

    def lack(self, addition: Addition) -> None:
        """Note something that is missing, once."""
        if not any(known.brings(addition) for known in self.missing):
            self.missing.append(addition)


class Judge:
    """Answers `JudgeBranch`."""

    def __init__(self, recogniser: Recogniser) -> None:
        """Judge what a recogniser recognises."""
        self.recogniser = recogniser

    def judge(self, prompt: JudgeBranch) -> BranchJudgement:
        """Say with what a branch can be shown, or what is missing.

        A widened label stands for several hazards. Where only some can be shown, it is narrowed to
        those.
        """
        label = prompt.path[-1] if prompt.path else ""
        hazards = self.recogniser.covered_by(label)
        if not hazards:
            return BranchJudgement(
                reasoning=f"The author has no knowledge of {label!r}.",
                simulatable=False,
                missing=[NO_RECIPE],
            )
        found = [realise(h, prompt.catalogue, self.recogniser.knowledge) for h in hazards]
        shown = [one for one in found if not one.missing]
        hidden = [one for one in found if one.missing]
        if not shown:
            return BranchJudgement(
                reasoning=_lacks(found[:1], prompt.catalogue),
                simulatable=False,
                missing=found[0].missing,
            )
        narrower = _joined([one.hazard.label for one in shown]) if hidden else ""
        reason = f"The simulator has what shows {_listed(shown)}."
        if hidden:
            reason += f" Not {_listed(hidden)}: {_lacks(hidden, prompt.catalogue, is_short=True)}."
        if found[0].substitutes and not hidden:
            parts = (f"{s.asset} stands for {_words(s.stands_for)}" for s in found[0].substitutes)
            reason += f" Not with the thing itself: {', '.join(parts)}."
        first = shown[0]
        standing = [s for one in shown for s in one.substitutes]
        return BranchJudgement(
            reasoning=reason,
            simulatable=True,
            assets=first.assets,
            states=list(dict.fromkeys(first.states)),
            behaviours=first.behaviours,
            weather=first.weather,
            traits=first.traits,
            substitutes=list({s.stands_for: s for s in standing}.values()),
            label=narrower,
            missing=_together(hidden)
            if hidden
            else _originals(standing, self.recogniser.knowledge),
        )


def realise(hazard: Hazard, catalogue: CatalogueDigest, knowledge: Knowledge) -> Realisation:
    """Look for everything that a hazard needs in a catalogue.

    Args:
        hazard: With its needs, and perhaps a recipe.
        catalogue: What the simulator offers.
        knowledge: Says which things may stand in for which.
    """
    found = Realisation(hazard)
    recipe = hazard.stage
    for actor in recipe.actors if recipe else ():
        _cast(actor, found, catalogue, knowledge)
    options = {name for one in (recipe.actors if recipe else ()) for name in one.asset}
    for name in hazard.needs.assets:
        if name not in options:
            _use((name,), (), found, catalogue, knowledge)
    behaviours = {behaviour.id for behaviour in catalogue.behaviours}
    used = recipe.behaviours if recipe else ()
    for name in dict.fromkeys((*hazard.needs.behaviours, *used)):
        if name in behaviours:
            found.behaviours.append(name)
        else:
            found.lack(Addition(kind="behaviour", name=name))
    limits = catalogue.limits
    for name in hazard.needs.weather:
        if not limits.offers(name):
            found.lack(Addition(kind="weather", name=name))
        elif name in WEATHER_SCALES:
            found.weather.append(name)
    _find_map(found, catalogue)
    if recipe is None:
        found.lack(NO_RECIPE)
    else:
        found.behaviours = [name for name in found.behaviours if name in used]
    found.assets = list(dict.fromkeys(found.assets))
    return found


def _cast(
    actor: RecipeActor,
    found: Realisation,
    catalogue: CatalogueDigest,
    knowledge: Knowledge,
) -> None:
    states = [actor.state] if actor.state else []
    if isinstance(actor.ordinary, Counterpart) and not actor.ordinary.asset and states:
        states += [actor.ordinary.state] if actor.ordinary.state else []
    _use(actor.asset, states, found, catalogue, knowledge)
    if isinstance(actor.ordinary, Counterpart) and actor.ordinary.asset:
        twin = Realisation(found.hazard)
        _use(actor.ordinary.asset, (), twin, catalogue, knowledge)
        for addition in twin.missing:
            found.lack(addition)


def _use(
    options: Sequence[str],
    states: Sequence[str],
    found: Realisation,
    catalogue: CatalogueDigest,
    knowledge: Knowledge,
) -> None:
    """Take the first asset that is one of the options, or may stand in for one."""
    there = [asset for name in options for asset in catalogue.called(name)]
    able = [asset for asset in there if set(states) <= set(asset.states)]
    if able:
        found.assets.append(able[0].id)
        if states and states[0] != able[0].states[0]:
            found.states.append(f"{able[0].id}: {states[0]}")
        return
    if there:
        lacking = [f"{options[0]}: {one}" for one in states if one not in there[0].states]
        if there[0].category == "signal":
            for name in lacking:
                found.lack(Addition(kind="state", name=name))
            return
        found.assets.append(there[0].id)
        found.substitutes += [Substitute(asset=there[0].id, stands_for=name) for name in lacking]
        return
    for wanted in options:
        for name in knowledge.substitutes.get(wanted, ()):
            near = [a for a in catalogue.called(name) if set(states) <= set(a.states)]
            if near:
                found.assets.append(near[0].id)
                found.substitutes.append(Substitute(asset=near[0].id, stands_for=wanted))
                return
    found.lack(Addition(kind="asset", name=options[0], category=knowledge.category(options[0])))


def _find_map(found: Realisation, catalogue: CatalogueDigest) -> None:
    traits, recipe = found.hazard.needs.traits, found.hazard.stage
    marks = landmarks_needed(recipe) if recipe else ()
    fitting = [road for road in catalogue.maps if set(traits) <= set(road.features)]
    if any(has_landmarks(road, recipe) for road in fitting):
        found.traits = list(dict.fromkeys((*traits, *marks)))
    elif fitting or not traits:
        found.lack(map_with((*traits, *marks)))
    else:
        there = {trait for road in catalogue.maps for trait in road.features}
        lacking = [trait for trait in traits if trait not in there]
        found.lack(map_with((*traits, *marks) if lacking or len(traits) > 1 else traits))


def _originals(standing: Iterable[Substitute], knowledge: Knowledge) -> list[Addition]:
    """Return what would be shown instead of the substitutes."""
    return [
        Addition(kind="state", name=s.stands_for)
        if ": " in s.stands_for
        else Addition(kind="asset", name=s.stands_for, category=knowledge.category(s.stands_for))
        for s in {s.stands_for: s for s in standing}.values()
    ]


def _together(hidden: Iterable[Realisation]) -> list[Addition]:
    found: list[Addition] = []
    for one in hidden:
        found += [addition for addition in one.missing if addition not in found]
    return found


def _lacks(
    hidden: Sequence[Realisation], catalogue: CatalogueDigest, *, is_short: bool = False
) -> str:
    """Say what is missing, and where the catalogue has nothing of that kind at all."""
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
    if NO_RECIPE in additions:
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
    """Name what of one kind is missing: `trench, deep water (assets)`."""
    named = [one.words.split(": ", 1)[-1] for one in additions if one.kind == kind]
    if not named:
        return ""
    return f"{', '.join(named)} ({_KINDS[kind][len(named) > 1]})"


_PLURAL = {"vegetation": "plants or fallen trees", "work_zone": "things of road works"}


def _listed(found: Sequence[Realisation]) -> str:
    labels = [f"{one.hazard.label[0].lower()}{one.hazard.label[1:]}" for one in found]
    return " or ".join(labels)


def _joined(labels: Sequence[str]) -> str:
    """Join labels so that the recogniser can take them apart; as many as fit."""
    text = labels[0]
    for label in labels[1:]:
        longer = f"{text}, or {label[0].lower()}{label[1:]}"
        if len(longer) > MAX_LABEL:
            break
        text = longer
    return text


def _words(name: str) -> str:
    return name.replace("_", " ")

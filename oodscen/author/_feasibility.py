"""Judgement of what a simulator can show: the needs and recipe of a hazard against a catalogue's digest."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

from oodscen.author._judgement_wording import hazard_words, joined_labels, lacking_words
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.alternatives import small
from oodscen.author._reading.readings import Alternative, LabelReading, RequiredThing
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._realisation import NO_RECIPE, Realisation, Way, all_missing, realise
from oodscen.data._additions import Addition
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._tree.judge_branch import (
    BranchJudgement,
    BranchJudgements,
    JudgeBranch,
    JudgeBranches,
    NumberedJudgement,
    Substitute,
)

_MOST = 40
"""Largest number of names of one kind in an answer."""
_MOST_WAYS = 200
"""Largest number of ways to restore one branch that are told."""


@dataclass
class Option:
    """One alternative of a label; all of its parts are needed."""

    words: str
    realisations: list[Realisation]

    @property
    def missing(self) -> list[Addition]:
        """Items that the catalogue lacks."""
        return all_missing(self.realisations)

    @property
    def is_exact(self) -> bool:
        """True if the catalogue shows it without substitutes."""
        return not any(realisation.substitutes for realisation in self.realisations)

    @property
    def ways(self) -> list[Way]:
        """Ways to restore it, the one that it names itself first; none if no addition can."""
        return _joint(need for realisation in self.realisations for need in realisation.needs)

    @property
    def hazards(self) -> list[HazardKind]:
        """Hazards that the alternative shows."""
        return [
            realisation.hazard
            for realisation in self.realisations
            if realisation.hazard is not None
        ]


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
            self._option(alternative, prompt.catalogue, exact=prompt.exact)
            for alternative in reading.alternatives
        ]
        shown = [index for index, option in enumerate(options) if not option.missing]
        hidden = [option for option in options if option.missing]
        if not shown:
            return self._dropped(label, reading, options, prompt.catalogue)
        if reading.is_any:
            shown = [index for index in shown if options[index].is_exact] or shown
            hidden = [] if 0 in shown else hidden
        narrower = ""
        if hidden:
            narrower, shown = self._narrowed(reading, options, shown)
        kept = [options[index] for index in shown]
        judgement = self._kept(kept, hidden, narrower, prompt.catalogue)
        if prompt.exact and judgement.substitutes:
            # Every alternative that is shown must be exact, unless any member of a category will do.
            joint = _joint(option.ways for option in kept if not option.is_exact)
            ways = [way for option in options for way in option.ways] if reading.is_any else joint
            judgement = judgement.model_copy(update=_restoring(ways, judgement.missing))
        return judgement

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
        return LabelReading(
            tuple(Alternative(hazard.label, (RequiredThing(hazard),)) for hazard in written)
        )

    def _option(
        self, alternative: Alternative, catalogue: CatalogueDigest, *, exact: bool
    ) -> Option:
        """Look up everything that an alternative needs in a catalogue."""
        realisations = []
        for part in alternative.parts:
            if part.hazard is not None:
                realisation = realise(part.hazard, catalogue, self.knowledge, exact=exact)
            else:
                realisation = Realisation(None, catalogue, self.knowledge, exact=exact)
                realisation.why = part.why
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
            if realisation.assets:
                realisation.substitutes += [
                    Substitute(asset=realisation.assets[0], stands_for=words)
                    for words in part.approximate
                ]
            has_things = realisation.assets or any(
                lack.kind == "asset" for lack in realisation.missing
            )
            if exact and part.approximate and has_things:
                realisation.needs.append([(NO_RECIPE,)])
            realisation.assets = list(dict.fromkeys(realisation.assets))
            realisations.append(realisation)
        return Option(alternative.words, realisations)

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
        reason = lacking_words(least.realisations, catalogue)
        if len(options) > 1 and not reading.is_any:
            reason = "; ".join(
                f"not {small(option.words)}: {lacking_words(option.realisations, catalogue)}"
                for option in options
            )
        ways = [*least.ways, *(way for option in options for way in option.ways)]
        return BranchJudgement(
            reasoning=f"{reason[0].upper()}{reason[1:]}.",
            simulatable=False,
            **_restoring(ways, least.missing),
        )

    def _narrowed(
        self, reading: LabelReading, options: Sequence[Option], shown: Sequence[int]
    ) -> tuple[str, list[int]]:
        """Return a label for the alternatives that can be shown, and the ones that fit into it."""
        if reading.split is not None:
            text = reading.split.naming(tuple(shown))
            ids = {hazard.id for index in shown for hazard in options[index].hazards}
            if {hazard.id for hazard in self.recogniser.covered_by(text)} == ids:
                return text, list(shown)
        labels = [hazard.label for index in shown for hazard in options[index].hazards[:1]]
        text, count = joined_labels(labels)
        return text, list(shown[:count])

    def _kept(
        self,
        shown: Sequence[Option],
        hidden: Sequence[Option],
        narrower: str,
        catalogue: CatalogueDigest,
    ) -> BranchJudgement:
        realisations = [realisation for option in shown for realisation in option.realisations]
        substitutes = {
            substitute.stands_for: substitute
            for realisation in realisations
            for substitute in realisation.substitutes
        }
        if len(shown) == 1:
            reason = f"The simulator has what shows {hazard_words(realisations)}."
        else:
            reason = f"The simulator shows {'; '.join(dict.fromkeys(map(_with_what, shown)))}."
        for option in hidden:
            lacks = lacking_words(option.realisations, catalogue)
            reason += f" Not {small(option.words)}: {lacks}."
        if substitutes:
            parts = (
                f"{substitute.asset} stands for {substitute.stands_for.replace('_', ' ')}"
                for substitute in substitutes.values()
            )
            reason += f" Not with the thing itself: {', '.join(parts)}."
        if hidden:
            missing = all_missing(
                realisation for option in hidden for realisation in option.realisations
            )
        else:
            missing = _originals(substitutes.values(), self.knowledge)
        return BranchJudgement(
            reasoning=reason,
            simulatable=True,
            assets=_united(realisation.assets for realisation in realisations),
            states=_united(realisation.states for realisation in realisations),
            behaviours=_united(realisation.behaviours for realisation in realisations),
            weather=_united(realisation.weather for realisation in realisations),
            traits=_united(realisation.traits for realisation in realisations),
            substitutes=list(substitutes.values()),
            label=narrower,
            missing=missing,
        )


def _joint(needs: Iterable[Sequence[Way]]) -> list[Way]:
    """Return the ways to meet all needs, the first of each need first; none if one cannot be met."""
    ways: list[Way] = [()]
    for need in needs:
        possible = [way for way in need if NO_RECIPE not in way]
        longer = (tuple(dict.fromkeys((*way, *more))) for way in ways for more in possible)
        ways = [*islice(dict.fromkeys(longer), _MOST_WAYS)]
    return ways


def _restoring(ways: Sequence[Way], missing: Sequence[Addition]) -> dict[str, Any]:
    """Return the fields of a judgement on what restores a branch: the first way, and the others instead."""
    if not ways:
        return {"missing": list(dict.fromkeys((*missing, NO_RECIPE)))}
    first, *others = dict.fromkeys(ways)
    sets = [frozenset(way) for way in (first, *others)]
    needed = [way for way in others if not any(one < frozenset(way) for one in sets)]
    needed.sort(key=len)
    return {"missing": list(first), "instead": [list(way) for way in needed[:_MOST_WAYS]]}


def _originals(substitutes: Iterable[Substitute], knowledge: Knowledge) -> list[Addition]:
    """Return the additions that would make the substitutes unnecessary."""
    additions = []
    for name in dict.fromkeys(substitute.stands_for for substitute in substitutes):
        if ": " in name:
            additions.append(Addition(kind="state", name=name))
        else:
            category = knowledge.category(name)
            additions.append(Addition(kind="asset", name=name, category=category))
    return additions


def _with_what(option: Option) -> str:
    """Name the means to show an alternative: `fallen tree across the road by fallen_tree`."""
    means = _united(
        (*realisation.assets, *realisation.weather) for realisation in option.realisations
    )
    words = hazard_words(option.realisations)
    return f"{words} by {', '.join(means)}" if means else words


def _united(lists: Iterable[Iterable[str]]) -> list[str]:
    return list(dict.fromkeys(name for names in lists for name in names))[:_MOST]

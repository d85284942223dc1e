"""Judging what a simulator can show: a hazard's needs and recipe against a catalogue's digest."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from oodscen.llms.author.anchors import has_landmarks, landmarks_needed
from oodscen.llms.author.knowledge import Hazard
from oodscen.llms.author.recognise import Recogniser
from oodscen.prompts import BranchJudgement, CatalogueDigest, JudgeBranch

_ICE = 0.25
"""Friction below which a road counts as icy."""
_WORDS = {
    "night": "night",
    "fog": "fog",
    "rain": "rain",
    "snow": "snow",
    "ice": "a road as slippery as ice",
    "low_sun": "a low sun that dazzles",
    "glare": "glare in the camera",
    "wind": "wind",
}


@dataclass(frozen=True)
class WeatherLimits:
    """What a digest's line on the weather says."""

    night: bool
    fog_m: float
    """Least visual range."""
    rain: bool
    snow: bool
    intensity: float
    """Most precipitation, mm/h."""
    friction: float
    """Least."""

    @classmethod
    def of(cls, line: str) -> "WeatherLimits":
        """Read `night; fog down to 30 m visual range; rain and snow up to 60 mm/h; ...`."""

        def number(pattern: str, default: float) -> float:
            found = re.search(pattern, line)
            return float(found.group(1)) if found else default

        return cls(
            night=re.search(r"\bno night\b", line) is None and "night" in line,
            fog_m=number(r"fog down to ([\d.e+]+)", 10_000.0),
            rain=re.search(r"\brain\b", line) is not None,
            snow=re.search(r"\bsnow\b", line) is not None,
            intensity=number(r"up to ([\d.e+]+) mm/h", 0.0),
            friction=number(r"friction down to ([\d.e+]+)", 1.0),
        )

    def offers(self, need: str) -> bool:
        """Tell whether one of the needs of `Needs.weather` can be shown."""
        offered = {
            "night": self.night,
            "fog": self.fog_m <= 60.0,
            "rain": self.rain,
            "snow": self.snow,
            "ice": self.friction <= _ICE,
        }
        return offered.get(need, False)


class Judge:
    """Answers `JudgeBranch`."""

    def __init__(self, recogniser: Recogniser) -> None:
        """Judge what a recogniser recognises."""
        self.recogniser = recogniser

    def judge(self, prompt: JudgeBranch) -> BranchJudgement:
        """Say with what a branch can be shown, or what is missing."""
        label = prompt.path[-1] if prompt.path else ""
        hazard, _ = self.recogniser.label(label)
        if hazard is None:
            return BranchJudgement(
                reasoning=f"The author has no knowledge of {label!r}.",
                simulatable=False,
                missing=["a staging recipe for this kind of scenario"],
            )
        missing = list(dict.fromkeys(missing_for(hazard, prompt.catalogue)))
        if missing:
            return BranchJudgement(
                reasoning=f"The simulator lacks {', '.join(missing)}.",
                simulatable=False,
                missing=missing,
            )
        if hazard.stage is None:
            return BranchJudgement(
                reasoning="Everything it needs is there, but not how to stage it recognisably.",
                simulatable=False,
                missing=["a staging recipe for this kind of scenario"],
            )
        offered = {asset.id for asset in prompt.catalogue.assets}
        assets = [next(a for a in options if a in offered) for options in hazard.stage.assets]
        assets += [name for name in hazard.needs.assets if name in offered]
        return BranchJudgement(
            reasoning=f"The simulator has what shows {hazard.label[0].lower()}{hazard.label[1:]}.",
            simulatable=True,
            assets=list(dict.fromkeys(assets)),
            behaviours=list(hazard.stage.behaviours),
        )


def missing_for(hazard: Hazard, catalogue: CatalogueDigest) -> Iterable[str]:
    """Name what a hazard needs and a catalogue lacks, in words."""
    assets = {asset.id for asset in catalogue.assets}
    behaviours = {behaviour.id for behaviour in catalogue.behaviours}
    limits = WeatherLimits.of(catalogue.weather)
    recipe = hazard.stage
    for name in hazard.needs.assets:
        if name not in assets and not _replaceable(name, hazard, assets):
            yield f"an asset: {_words(name)}"
    if recipe is not None:
        for options in recipe.assets:
            if not assets.intersection(options):
                yield f"an asset: {_words(options[0])}"
    for name in dict.fromkeys((*hazard.needs.behaviours, *(recipe.behaviours if recipe else ()))):
        if name not in behaviours:
            yield f"a behaviour: {_words(name)}"
    for name in hazard.needs.weather:
        if not limits.offers(name):
            yield f"weather: {_WORDS.get(name, _words(name))}"
    fitting = [road for road in catalogue.maps if set(hazard.needs.traits) <= set(road.traits)]
    if not fitting:
        there = {trait for road in catalogue.maps for trait in road.traits}
        lacking = sorted(set(hazard.needs.traits) - there) or sorted(hazard.needs.traits)
        yield f"a map with: {', '.join(map(_words, lacking))}"
    elif not any(has_landmarks(road, recipe) for road in fitting):
        assert recipe is not None
        yield f"a map with: {', '.join(map(_words, landmarks_needed(recipe)))}"


def _replaceable(name: str, hazard: Hazard, assets: set[str]) -> bool:
    """Tell whether the recipe has an alternative for an asset that is not there."""
    recipe = hazard.stage
    return recipe is not None and any(
        name in options and assets.intersection(options) for options in recipe.assets
    )


def _words(name: str) -> str:
    return name.replace("_", " ")

"""Logical scenarios as files: parameters in the scenario, and their distributions beside it."""

from collections.abc import Sequence
from pathlib import Path

from lxml import etree

from oodscen._files import replace
from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.interchange._ranges import ParameterRange, ranges
from oodscen.interchange._writing.elements import Element, child
from oodscen.interchange._writing.scenario import DATE, ScenarioFile, to_openscenario
from oodscen.interchange._writing.storyboard import strip_ego

_STEPS = 4
"""Number of steps across a range in a deterministic distribution."""
_RUNS = 100
_TIED = 2e-4
"""Amount by which a condition may differ from its trigger where a tie was undone, m or s."""


def write_logical(
    scene: Scene,
    catalogue: Catalogue,
    folder: str | Path,
    *,
    claims: Sequence[Claim] = (),
    seed: int = 0,
    file: ScenarioFile | None = None,
) -> tuple[Path, ...]:
    """Write a scene with parameters, and its distributions, into a folder.

    `<scene>.logical.xosc` is the reactive scenario whose triggers, friction, visual range and initial speed of the
    ego are parameters. `<scene>.deterministic.xosc` and `<scene>.stochastic.xosc` give their values. Parameters of
    recorded courses (places and speeds of actors) have no place in these files: `vary` draws them.

    Args:
        scene: The scene.
        catalogue: The catalogue of its assets and maps.
        folder: Where to write.
        claims: The claims of its text, which every end of a range keeps true.
        seed: Seed of the scene's random streams, and of the stochastic distribution.
        file: The scene's reactive file, if there is one already; by default it is made here.

    Returns:
        The paths of the files; none if no parameter of the scene has a range.
    """
    file = file or to_openscenario(scene, catalogue, mode="reactive", ego=False, seed=seed)
    root = etree.fromstring(file.xosc, etree.XMLParser(remove_blank_text=True))
    strip_ego(root)
    used = [one for one in ranges(scene, catalogue, claims) if _declare(root, one)]
    if not used:
        return ()
    declared = etree.Element("ParameterDeclarations")
    for one in used:
        child(
            declared, "ParameterDeclaration", name=one.name, parameterType="double", value=one.value
        )
    root.insert(1, declared)
    etree.indent(root)
    name = f"{scene.id}.logical"
    text = etree.tostring(root, encoding="UTF-8", xml_declaration=True)
    place = ScenarioFile(name, text, file.road).save(folder)
    paths = [place]
    for kind in ("deterministic", "stochastic"):
        path = place.with_name(f"{scene.id}.{kind}.xosc")
        replace(path, _distribution(place.name, kind, used, seed))
        paths.append(path)
    return tuple(paths)


def _declare(root: Element, one: ParameterRange) -> bool:
    """Replace a value by its parameter wherever the file has it; return false if it has not."""
    places = _places(root, one)
    for element, attribute in places:
        element.set(attribute, f"${one.name}")
    return bool(places)


def _places(root: Element, one: ParameterRange) -> list[tuple[Element, str]]:
    """Return the attributes that hold a parameter."""
    if one.name == "friction":
        return [(found, "frictionScaleFactor") for found in root.iter("RoadCondition")]
    if one.name == "fog_visual_range":
        return [(found, "visualRange") for found in root.iter("Fog")]
    if one.name == "ego_speed":
        starts = (node for node in root.iter("Private") if node.get("entityRef") == "ego")
        return [(speed, "value") for node in starts for speed in node.iter("AbsoluteTargetSpeed")]
    if not one.name.startswith("trigger_"):
        return []
    return [
        (measured, "value")
        for condition in root.iter("Condition")
        if condition.get("name", "").replace("-", "_") == one.name
        for measured in condition.iter("DistanceCondition", "TimeToCollisionCondition")
        if abs(float(measured.get("value", "nan")) - one.value) <= _TIED
    ]


def _distribution(scenario: str, kind: str, used: Sequence[ParameterRange], seed: int) -> bytes:
    """Return a file of values for the parameters of a scenario."""
    root = etree.Element("OpenSCENARIO")
    header = child(root, "FileHeader", revMajor=1, revMinor=2, date=DATE)
    header.set("description", f"Values for the parameters of {scenario}")
    header.set("author", "oodscen")
    holder = child(root, "ParameterValueDistribution")
    child(holder, "ScenarioFile", filepath=scenario)
    if kind == "deterministic":
        group = child(holder, "Deterministic")
    else:
        group = child(holder, "Stochastic", numberOfTestRuns=_RUNS, randomSeed=float(seed))
    for one in used:
        if kind == "deterministic":
            single = child(
                group, "DeterministicSingleParameterDistribution", parameterName=one.name
            )
            spread = child(single, "DistributionRange", stepWidth=(one.high - one.low) / _STEPS)
        else:
            single = child(group, "StochasticDistribution", parameterName=one.name)
            spread = child(single, "UniformDistribution")
        child(spread, "Range", lowerLimit=one.low, upperLimit=one.high)
    etree.indent(root)
    return etree.tostring(root, encoding="UTF-8", xml_declaration=True)

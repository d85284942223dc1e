"""Logical scenarios as files: parameters in the scenario, and their distributions beside it."""

from collections.abc import Sequence

from lxml import etree

from oodscen.data._catalogue import Catalogue
from oodscen.data._claim import Claim
from oodscen.data._scene import Scene
from oodscen.interchange._ranges import ParameterRange, ranges
from oodscen.interchange._writing.elements import Element, child, file_header, to_bytes
from oodscen.interchange._writing.files import ScenarioFile
from oodscen.interchange._writing.properties import write_digest
from oodscen.interchange._writing.storyboard import strip_ego

_STEPS = 4
"""Number of steps across a range in a deterministic distribution."""
_RUNS = 100
"""Number of runs that a stochastic distribution asks for."""
_TIED = 2e-4
"""Conditions are written up to this far from the trigger's value, to avoid ties (see docs/interchange.md); m or s."""
_UNVARIED = "No parameter of the scene has a range."
_WEATHER = {
    "friction": ("RoadCondition", "frictionScaleFactor"),
    "fog_visual_range_m": ("Fog", "visualRange"),
}
"""Element and attribute that hold a field of the weather."""
_TARGET_SPEED = "AbsoluteTargetSpeed"
_MEASURES = ("DistanceCondition", "TimeToCollisionCondition")
"""Conditions with the value of a trigger; `RelativeDistanceCondition` has another, between reference points."""


def logical_file(
    file: ScenarioFile,
    scene: Scene,
    catalogue: Catalogue,
    claims: Sequence[Claim] = (),
    seed: int = 0,
) -> ScenarioFile:
    """Return the logical scenario of a scene's reactive file: parameters in it, their distributions beside it.

    Args:
        file: The scene's reactive file.
        scene: The scene that was written into it.
        catalogue: The catalogue of its assets and maps.
        claims: The claims of its text, which every end of a range keeps true.
        seed: Seed of the stochastic distribution.

    Returns:
        `<scene>.logical.xosc`, with `<scene>.deterministic.xosc` and `<scene>.stochastic.xosc` beside it; no files
        are beside it if no parameter has a range.
    """
    root = etree.fromstring(file.xosc, etree.XMLParser(remove_blank_text=True))
    strip_ego(root)
    name = f"{scene.id}.logical"
    parameters = [
        parameter
        for parameter in ranges(scene, catalogue, claims)
        if _replace_values(root, scene, parameter)
    ]
    if not parameters:
        return ScenarioFile(name, _signed(root), file.road, (*file.notes, _UNVARIED))
    root.insert(1, _declarations(parameters))  # after FileHeader
    beside = {
        f"{scene.id}.deterministic.xosc": _deterministic(f"{name}.xosc", parameters),
        f"{scene.id}.stochastic.xosc": _stochastic(f"{name}.xosc", parameters, seed),
    }
    return ScenarioFile(name, _signed(root), file.road, file.notes, beside)


def _declarations(parameters: Sequence[ParameterRange]) -> Element:
    holder = etree.Element("ParameterDeclarations")
    for parameter in parameters:
        child(
            holder,
            "ParameterDeclaration",
            name=parameter.name,
            parameterType="double",
            value=parameter.value,
        )
    return holder


def _signed(root: Element) -> bytes:
    """Return a changed document as a file with the digest of its new content."""
    etree.indent(root)
    write_digest(root)
    return to_bytes(root)


def _replace_values(root: Element, scene: Scene, parameter: ParameterRange) -> bool:
    """Put a parameter in place of its value, and return whether the document has that value."""
    attributes = _attributes_of(root, scene, parameter)
    for element, attribute in attributes:
        element.set(attribute, f"${parameter.name}")
    return bool(attributes)


def _attributes_of(
    root: Element, scene: Scene, parameter: ParameterRange
) -> list[tuple[Element, str]]:
    """Return the elements and attributes that hold the value of a parameter."""
    match parameter.path:
        case ("weather", field):
            tag, attribute = _WEATHER[str(field)]
            return [(element, attribute) for element in root.iter(tag)]
        case ("ego", "speed"):
            starts = (start for start in root.iter("Private") if start.get("entityRef") == "ego")
            return [(speed, "value") for start in starts for speed in start.iter(_TARGET_SPEED)]
        case ("actors", int(index), "behaviour", "trigger", "value"):
            name = f"trigger_{scene.actors[index].id}"
            return [
                (measure, "value")
                for condition in root.iter("Condition")
                if condition.get("name") == name
                for measure in condition.iter(*_MEASURES)
                if abs(float(measure.get("value", "nan")) - parameter.value) <= _TIED
            ]
    return []


def _deterministic(scenario: str, parameters: Sequence[ParameterRange]) -> bytes:
    """Return a file of evenly spaced values for the parameters of a scenario."""
    root, holder = _distribution(scenario)
    group = child(holder, "Deterministic")
    for parameter in parameters:
        single = child(
            group, "DeterministicSingleParameterDistribution", parameterName=parameter.name
        )
        width = (parameter.high - parameter.low) / _STEPS
        _add_limits(child(single, "DistributionRange", stepWidth=width), parameter)
    return to_bytes(root)


def _stochastic(scenario: str, parameters: Sequence[ParameterRange], seed: int) -> bytes:
    """Return a file of uniform distributions for the parameters of a scenario."""
    root, holder = _distribution(scenario)
    group = child(holder, "Stochastic", numberOfTestRuns=_RUNS, randomSeed=float(seed))
    for parameter in parameters:
        single = child(group, "StochasticDistribution", parameterName=parameter.name)
        _add_limits(child(single, "UniformDistribution"), parameter)
    return to_bytes(root)


def _distribution(scenario: str) -> tuple[Element, Element]:
    """Return a document of values for a scenario, and the element that holds them."""
    root = etree.Element("OpenSCENARIO")
    file_header(root, 2, f"Values for the parameters of {scenario}")
    holder = child(root, "ParameterValueDistribution")
    child(holder, "ScenarioFile", filepath=scenario)
    return root, holder


def _add_limits(distribution: Element, parameter: ParameterRange) -> None:
    child(distribution, "Range", lowerLimit=parameter.low, upperLimit=parameter.high)

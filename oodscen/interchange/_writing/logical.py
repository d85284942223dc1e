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
_ATTRIBUTES = {
    "friction": ("RoadCondition", "frictionScaleFactor"),
    "fog_visual_range": ("Fog", "visualRange"),
}
"""Element and attribute that hold a parameter, wherever the element is."""


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
    found = [
        (parameter, _places(root, parameter)) for parameter in ranges(scene, catalogue, claims)
    ]
    used = [parameter for parameter, places in found if places]
    name = f"{scene.id}.logical"
    if not used:
        return ScenarioFile(name, _signed(root), file.road, (*file.notes, _UNVARIED))
    for parameter, places in found:
        for element, attribute in places:
            element.set(attribute, f"${parameter.name}")
    declared = etree.Element("ParameterDeclarations")
    for parameter in used:
        child(
            declared,
            "ParameterDeclaration",
            name=parameter.name,
            parameterType="double",
            value=parameter.value,
        )
    root.insert(1, declared)  # after FileHeader
    beside = {
        f"{scene.id}.deterministic.xosc": _deterministic(f"{name}.xosc", used),
        f"{scene.id}.stochastic.xosc": _stochastic(f"{name}.xosc", used, seed),
    }
    return ScenarioFile(name, _signed(root), file.road, file.notes, beside)


def _signed(root: Element) -> bytes:
    """Return a changed document as a file with the digest of its new content."""
    etree.indent(root)
    write_digest(root)
    return to_bytes(root)


def _places(root: Element, parameter: ParameterRange) -> list[tuple[Element, str]]:
    """Return the attributes that hold a parameter."""
    if parameter.name in _ATTRIBUTES:
        tag, attribute = _ATTRIBUTES[parameter.name]
        return [(element, attribute) for element in root.iter(tag)]
    if parameter.name == "ego_speed":
        starts = (node for node in root.iter("Private") if node.get("entityRef") == "ego")
        return [(speed, "value") for node in starts for speed in node.iter("AbsoluteTargetSpeed")]
    if not parameter.name.startswith("trigger_"):
        return []
    return [
        (measured, "value")
        for condition in root.iter("Condition")
        if condition.get("name", "").replace("-", "_") == parameter.name
        for measured in condition.iter("DistanceCondition", "TimeToCollisionCondition")
        if abs(float(measured.get("value", "nan")) - parameter.value) <= _TIED
    ]


def _deterministic(scenario: str, used: Sequence[ParameterRange]) -> bytes:
    """Return a file of evenly spaced values for the parameters of a scenario."""
    root, holder = _distribution(scenario)
    group = child(holder, "Deterministic")
    for parameter in used:
        single = child(
            group, "DeterministicSingleParameterDistribution", parameterName=parameter.name
        )
        width = (parameter.high - parameter.low) / _STEPS
        _add_range(child(single, "DistributionRange", stepWidth=width), parameter)
    return to_bytes(root)


def _stochastic(scenario: str, used: Sequence[ParameterRange], seed: int) -> bytes:
    """Return a file of uniform distributions for the parameters of a scenario."""
    root, holder = _distribution(scenario)
    group = child(holder, "Stochastic", numberOfTestRuns=_RUNS, randomSeed=float(seed))
    for parameter in used:
        single = child(group, "StochasticDistribution", parameterName=parameter.name)
        _add_range(child(single, "UniformDistribution"), parameter)
    return to_bytes(root)


def _distribution(scenario: str) -> tuple[Element, Element]:
    """Return a document of values for a scenario, and the element that holds them."""
    root = etree.Element("OpenSCENARIO")
    file_header(root, 2, f"Values for the parameters of {scenario}")
    holder = child(root, "ParameterValueDistribution")
    child(holder, "ScenarioFile", filepath=scenario)
    return root, holder


def _add_range(spread: Element, parameter: ParameterRange) -> None:
    child(spread, "Range", lowerLimit=parameter.low, upperLimit=parameter.high)

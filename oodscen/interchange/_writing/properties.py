"""Properties: facts about a scene for which the standard has no elements."""

import hashlib
import json
import re
from collections.abc import Mapping, Sequence

from lxml import etree

from oodscen._words.text import one_line, printable
from oodscen.data._base import canonical_json
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode
from oodscen.data._pairing import twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.interchange._writing.elements import Element, child

PREFIX = "oodscen."
SCENE, DIGEST = f"{PREFIX}scene", f"{PREFIX}sha256"
"""Names of the properties that hold the scene itself, and the digest of it and of its file."""
_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
"""Characters that no XML file can hold."""
_LONGEST = 2_000
"""Maximum characters of a description."""


def facts(
    scene: Scene,
    scenario: Scenario | None = None,
    claims: Sequence[Claim] = (),
    episode: Episode | None = None,
) -> dict[str, str]:
    """Return facts about a scene, by the names of properties without their prefix."""
    values = {"scene_id": scene.id, "hazard": ", ".join(scene.hazard.actors) or "weather"}
    if scene.is_ordinary:
        values["hazard"] = ""
    else:
        values["twin"] = twin_id(scene.id)
    if scenario is not None:
        text = scenario.text
        if scene.demand:
            text = scene.demand.text
        elif scene.is_twin:
            text = scenario.ordinary or ""
        values["text"] = one_line(printable(text))
        values["path"] = " > ".join(map(one_line, map(printable, scenario.path)))
    if claims and not scene.is_twin:
        values["claims"] = canonical_json([claim.model_dump(mode="json") for claim in claims])
    if episode is not None:
        values["safe_actions"] = ", ".join(episode.safe_set)
    return {name: value for name, value in values.items() if value}


def write_properties(holder: Element, values: Mapping[str, str]) -> None:
    """Append properties in the order of their names."""
    for name, value in sorted(values.items()):
        child(
            holder, "Property", name=f"{PREFIX}{name}", value=_FORBIDDEN.sub("", printable(value))
        )


def ascii_json(scene: Scene) -> str:
    """Return a scene as JSON text of characters that every XML file can hold."""
    return json.dumps(scene.model_dump(mode="json"), sort_keys=True, separators=(",", ":"))


def content_digest(root: Element, scene: str) -> str:
    """Return the SHA-256 of a scene's text and of a document in canonical form without its header."""
    digest = hashlib.sha256(scene.encode())
    for part in root:
        if isinstance(part.tag, str) and part.tag != "FileHeader":
            digest.update(etree.tostring(part, method="c14n", with_tail=False))
    return digest.hexdigest()


def write_digest(root: Element) -> None:
    """Append the digest of an indented document and of the scene in its header, in place of an earlier digest."""
    holder = root.find("FileHeader/Properties")
    assert holder is not None
    properties = {element.get("name"): element for element in holder}
    if DIGEST in properties:
        holder.remove(properties[DIGEST])
    digest = content_digest(root, properties[SCENE].get("value", ""))
    child(holder, "Property", name=DIGEST, value=digest)


def description(scene: Scene, mode: str, notes: Sequence[str]) -> str:
    """Return the description of a file in its header."""
    text = " ".join([f"oodscen scene {scene.id}, {mode}.", *notes])
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."

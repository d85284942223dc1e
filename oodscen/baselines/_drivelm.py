"""Reader of DriveLM-nuScenes (see `oodscen.baselines._datasets`)."""

import re
from collections.abc import Mapping
from typing import Any

from oodscen.baselines._dataset_texts import DatasetText, TextsAndIssues, members_of, texts_of
from oodscen.errors import Issue

_TAG = re.compile(r"(?:\b(?:the|an?) )?(?:\bobjects? )?(<c\d+,[^<>]*>)", re.IGNORECASE)
_DETERMINER = re.compile(r"(?:an?|the|some|two|many)(?=\s)", re.IGNORECASE)
_STAGES = ("perception", "prediction", "planning", "behavior")


def read_drivelm(document: Any) -> TextsAndIssues:
    """Read `{scene token: {scene_description, key_frames: {frame token: {key_object_infos, QA}}}}`.

    `QA` holds lists of `{"Q": ..., "A": ...}` under perception, prediction, planning and behavior.
    Texts refer to an object by a tag such as `<c1,CAM_FRONT,1043.2,82.2>`; the object's description
    replaces it, or "the object" if the file has none.
    """
    for token, scene in members_of(document, "", "scene"):
        if isinstance(scene, Issue):
            yield scene
            continue
        description = scene.get("scene_description")
        yield from texts_of("scene", description, f"{token}.scene_description")
        for where, frame in members_of(scene.get("key_frames"), f"{token}.key_frames", "frame"):
            if isinstance(frame, Issue):
                yield frame
            else:
                yield from _frame_texts(frame, where)


def _frame_texts(frame: Mapping[str, Any], where: str) -> TextsAndIssues:
    names: dict[str, str] = {}
    objects = f"{where}.key_object_infos"
    for path, info in members_of(frame.get("key_object_infos", {}), objects, "object"):
        if isinstance(info, Issue):
            yield info
            continue
        description = info.get("Visual_description")
        for item in texts_of("object", description, f"{path}.Visual_description"):
            yield item
            if isinstance(item, DatasetText):
                names[path.removeprefix(f"{objects}.")] = _as_name(item.text)
    stages = frame.get("QA", {})
    if not isinstance(stages, dict):
        yield Issue(f"{where}.QA", f"is {type(stages).__name__}, not an object")
        return
    for stage in stages:
        if stage not in _STAGES:
            yield Issue(f"{where}.QA.{stage}", f"is none of {', '.join(_STAGES)}")
    for stage in _STAGES:
        yield from _questions(stages.get(stage, []), f"{where}.QA.{stage}", names)


def _questions(pairs: Any, where: str, names: Mapping[str, str]) -> TextsAndIssues:
    if not isinstance(pairs, list):
        yield Issue(where, f"is {type(pairs).__name__}, not a list of questions")
        return
    for index, pair in enumerate(pairs):
        path = f"{where}[{index}]"
        if not isinstance(pair, dict) or not {"Q", "A"} <= pair.keys():
            yield Issue(path, "is not an object with 'Q' and 'A'")
            continue
        texts = []
        for kind, key in (("question", "Q"), ("answer", "A")):
            for item in texts_of(kind, pair[key], f"{path}.{key}"):
                if isinstance(item, DatasetText):
                    item = item._replace(text=_with_names(item.text, names))
                    texts.append(item.text)
                yield item
        if texts:
            yield DatasetText("qa", " ".join(texts))


def _with_names(text: str, names: Mapping[str, str]) -> str:
    """Return a text with the names of objects for their tags."""
    text = _TAG.sub(lambda match: names.get(match[1], "the object"), text)
    return text[0].upper() + text[1:]


def _as_name(description: str) -> str:
    """Return an object's description as a noun with its determiner."""
    noun = description.rstrip(". ") or "object"
    if _DETERMINER.match(noun):
        return _DETERMINER.sub(lambda match: match[0].lower(), noun, count=1)
    if noun[1:2].islower():
        noun = noun[0].lower() + noun[1:]
    return f"the {noun}"

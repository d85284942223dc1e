"""The tables of a data set as Parquet files that `datasets.load_dataset` reads, with the pictures inside."""

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from oodscen.data._base import canonical_json
from oodscen.data._episode import as_offered
from oodscen.data._pairing import is_ordinary
from oodscen.data._scene import Scene
from oodscen.errors import MissingExtra
from oodscen.publish._question_rows import TASKS, PublishedDrive, question_rows

GROUP = 32
"""Drives in a row group. Within one, the pictures of a drive are stored once for all its questions."""
_PICTURES_BYTES = 1 << 28
"""Bytes that the different pictures of a row group may have."""

_TEXT = {"dtype": "string", "_type": "Value"}
_INTEGER = {"dtype": "int32", "_type": "Value"}
_NUMBER = {"dtype": "float64", "_type": "Value"}


def _list_of(feature: dict[str, Any]) -> dict[str, Any]:
    return {"feature": feature, "_type": "Sequence"}


QUESTIONS: dict[str, dict[str, Any]] = {
    **dict.fromkeys(("id", "drive", "pair", "kind", "purpose"), _TEXT),
    "tasks": _list_of(_TEXT),
    **dict.fromkeys(("system", "question"), _TEXT),
    "images": _list_of({"_type": "Image"}),
    "options": _list_of(_TEXT),
    "answer": _TEXT,
    **dict.fromkeys(("accepted", "neutral"), _list_of(_INTEGER)),
    "path": _list_of(_TEXT),
    "key": _TEXT,
}
"""Columns of the questions, as features of the library `datasets`."""

DRIVES: dict[str, dict[str, Any]] = {
    **dict.fromkeys(("drive", "pair", "kind", "item", "map", "text"), _TEXT),
    "path": _list_of(_TEXT),
    "ego_speed_mps": _NUMBER,
    "frame_times_s": _list_of(_NUMBER),
    "frame_sha256": _list_of(_TEXT),
    **dict.fromkeys(("safe", "marginal", "unsafe", "unavailable"), _list_of(_TEXT)),
    **dict.fromkeys(("best_action", "scene", "episode"), _TEXT),
}
"""Columns of the drives."""


def write_questions(path: Path, drives: Sequence[PublishedDrive]) -> int:
    """Write the questions about some drives, and return their number.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    return _write(path, QUESTIONS, (_questions(group) for group in _groups(drives)))


def write_drives(path: Path, drives: Sequence[PublishedDrive], demands: dict[str, Scene]) -> int:
    """Write everything known about some drives; `demands` are the scenes of ordinary demands, by id.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    groups = ([_drive(drive, demands) for drive in group] for group in _groups(drives))
    return _write(path, DRIVES, groups)


def _groups(drives: Sequence[PublishedDrive]) -> Iterator[Sequence[PublishedDrive]]:
    return (drives[start : start + GROUP] for start in range(0, len(drives), GROUP))


def _questions(drives: Sequence[PublishedDrive]) -> list[dict[str, Any]]:
    rows = []
    for drive in drives:
        images = [
            {"bytes": image.read(), "path": f"{drive.name}-{number}.jpg"}
            for number, image in enumerate(drive.images)
        ]
        key = canonical_json(drive.asked.key.model_dump(mode="json"))
        rows += [
            {
                "id": row.name,
                "drive": drive.name,
                "pair": drive.pair,
                "kind": drive.kind,
                "purpose": row.purpose,
                "tasks": list(TASKS[row.purpose]),
                "system": row.prompt.instructions(),
                "question": row.prompt.question(),
                "images": images,
                "options": list(row.options),
                "answer": row.answer,
                "accepted": list(row.accepted),
                "neutral": list(row.neutral),
                "path": list(drive.asked.key.path),
                "key": key,
            }
            for row in question_rows(drive)
        ]
    return rows


def _drive(drive: PublishedDrive, demands: dict[str, Scene]) -> dict[str, Any]:
    asked, episode = drive.asked, drive.asked.episode
    scene = _scene(drive, demands)
    labels = {name: episode.label(name) for name in as_offered(episode.actions)}
    return {
        "drive": drive.name,
        "pair": drive.pair,
        "kind": drive.kind,
        "item": episode.scene_id,
        "map": scene.map if scene else "",
        "text": _text(drive, scene),
        "path": list(asked.key.path),
        "ego_speed_mps": episode.ego_speed_mps,
        "frame_times_s": list(asked.shown.facts.times_s),
        "frame_sha256": [image.sha256 for image in drive.images],
        **{
            label: [name for name, own_label in labels.items() if own_label == label]
            for label in ("safe", "marginal", "unsafe", "unavailable")
        },
        "best_action": episode.best_action or "",
        "scene": scene.to_json() if scene else "",
        "episode": canonical_json(episode.model_dump(mode="json")),
    }


def _scene(drive: PublishedDrive, demands: dict[str, Scene]) -> Scene | None:
    """Return the scene that was driven, which for an ordinary drive is not the one that it belongs to."""
    scene, episode = drive.asked.scene, drive.asked.episode
    if drive.kind == "demand":
        return demands.get(episode.scene_id)
    if drive.kind == "twin" and scene is not None and episode.decision_s is not None:
        return scene.twin(episode.decision_s)
    return scene


def _text(drive: PublishedDrive, scene: Scene | None) -> str:
    """Return the text of a drive: a twin has one only where the study wrote it."""
    scenario = drive.asked.scenario
    if drive.kind == "demand":
        return scene.demand.text if scene and scene.demand else ""
    if scenario is None:
        return ""
    if is_ordinary(drive.asked.episode.scene_id):
        return scenario.ordinary or ""
    return scenario.text


def _write(
    path: Path, features: dict[str, dict[str, Any]], groups: Iterable[list[dict[str, Any]]]
) -> int:
    """Write groups of rows, and return the number of rows."""
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise MissingExtra("a published data set", "publish", "pyarrow") from None
    schema = pa.schema(
        [(name, _arrow_type(feature)) for name, feature in features.items()],
        metadata={"huggingface": json.dumps({"info": {"features": features}})},
    )
    count = 0
    path.parent.mkdir(parents=True, exist_ok=True)
    with parquet.ParquetWriter(
        path, schema, compression="zstd", dictionary_pagesize_limit=_PICTURES_BYTES
    ) as writer:
        for rows in groups:
            count += len(rows)
            writer.write_table(pa.Table.from_pylist(rows, schema=schema), row_group_size=len(rows))
    return count


def _arrow_type(feature: dict[str, Any]) -> Any:
    """Return the type of a column for a feature of the library `datasets`."""
    import pyarrow as pa

    if feature["_type"] == "Sequence":
        return pa.list_(_arrow_type(feature["feature"]))
    if feature["_type"] == "Image":
        return pa.struct({"bytes": pa.binary(), "path": pa.string()})
    types = {"string": pa.string(), "int32": pa.int32(), "float64": pa.float64()}
    return types[feature["dtype"]]

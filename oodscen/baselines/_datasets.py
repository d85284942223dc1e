"""Readers of public driving data sets, for the files as they are distributed.

None of these data are bundled. Their licences bind the user who downloads them, and are recorded in the
`Baseline`.

| layout | file | texts | licence |
|---|---|---|---|
| `drivelm` | DriveLM-nuScenes, `v1_1_train_nus.json` | `scene`, `qa`; on request `question`, `answer`, `object` | CC BY-NC-SA 4.0 |
| `nuscenes` | nuScenes, `scene.json` | `scene` | CC BY-NC-SA 4.0 |
| `talk2car` | Talk2Car, `train_commands.json` | `command` | CC BY-NC-SA 4.0 |
| `bdd-x` | BDD-X, `BDD-X-Annotations_v1.csv` | `sentence`; on request `action`, `justification` | UC Berkeley, not for profit |
| `cityflow-nl` | CityFlow-NL, `train-tracks.json`, `test-queries.json` | `view`, `other_view` | Apache-2.0 |

A layout's reader yields its texts in the order of the file, each with the part that it belongs to, and
an issue for every deviation from the data set's format. Empty entries are skipped: a frame without questions, a
withheld answer, an object without a description, the unused columns of a short clip.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

from oodscen._io.json import parse_json
from oodscen.baselines._dataset_texts import DatasetText, TextsAndIssues, texts_of
from oodscen.baselines._drivelm import read_drivelm
from oodscen.baselines._reading import CsvTable, read_csv, repeated
from oodscen.errors import Issue, UnknownComponent, UsageError

LayoutName = Literal["drivelm", "nuscenes", "talk2car", "bdd-x", "cityflow-nl"]

_NOT_COMMERCIAL = "CC-BY-NC-SA-4.0"
_BDD_X = ("Input.Video", "Answer.1action")
_BDD_X_TEXT = re.compile(r"(Answer\.\d+)(?:action|justification)")
_UUID = re.compile(r"[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}")
"""Matches the key of a track or query of CityFlow-NL."""
_JOINING = re.compile(
    r"(?:after|and|as|at|because|before|but|by|due|for|from|if|in|on|since|so|to|unless|until|when|where|"
    r"which|while|with)\b"
)
"""Beginnings of a reason that goes on with the sentence of its action."""


@dataclass(frozen=True)
class FileLayout:
    """The file layout of one data set."""

    title: str
    """Name of the data set."""
    licence: str
    """Licence of its texts; an SPDX identifier if there is one."""
    default_parts: tuple[str, ...]
    """Kinds of texts that are read by default."""
    further_parts: tuple[str, ...]
    """Kinds that are read on request."""
    read: Callable[[Any], TextsAndIssues]
    """Takes the decoded JSON document, or a CSV file."""
    is_csv: bool = False


def recognise(content: str, suffix: str) -> tuple[FileLayout, TextsAndIssues] | None:
    """Return the data set layout that a file's content matches, with its texts; `None` for any other file."""
    if suffix == ".csv":
        table = read_csv(content)
        return (LAYOUTS["bdd-x"], _bdd_x(table)) if set(_BDD_X) <= set(table.header) else None
    if suffix != ".json":
        return None
    try:
        document = parse_json(content)
    except (ValueError, RecursionError):
        return None
    name = _recognise_json(document)
    return (LAYOUTS[name], LAYOUTS[name].read(document)) if name else None


def read_as(layout: FileLayout, content: str) -> TextsAndIssues:
    """Read a file's content as that of a layout."""
    if layout.is_csv:
        yield from layout.read(read_csv(content))
        return
    try:
        document = parse_json(content)
    except (ValueError, RecursionError) as error:
        yield Issue("", f"is not JSON: {error}")
    else:
        yield from layout.read(document)


def layout_of(name: str) -> FileLayout:
    """Return a layout by its name.

    Raises:
        UnknownComponent: If there is no layout of that name.
    """
    if name not in LAYOUTS:
        raise UnknownComponent("layout of a baseline", name, LAYOUTS)
    return LAYOUTS[name]


def chosen_parts(layout: FileLayout, parts: tuple[str, ...]) -> tuple[str, ...]:
    """Return the requested kinds of texts, which the layout must have.

    Raises:
        UnknownComponent: If the layout has no such part.
        UsageError: If no part is requested.
    """
    known = layout.default_parts + layout.further_parts
    if not parts:
        raise UsageError(f"no part of {layout.title} is requested (known: {', '.join(known)})")
    for part in parts:
        if part not in known:
            raise UnknownComponent(f"part of {layout.title}", part, known)
    return parts


def _recognise_json(document: Any) -> LayoutName | None:
    if isinstance(document, list):
        first = document[0] if document and isinstance(document[0], dict) else {}
        return "nuscenes" if {"description", "first_sample_token"} <= first.keys() else None
    if not isinstance(document, dict) or not document:
        return None
    if {"commands", "scene_tokens"} <= document.keys():
        return "talk2car"
    first_key, first = next(iter(document.items()))
    if isinstance(first, dict) and "key_frames" in first:
        return "drivelm"
    has_queries = isinstance(first, list) and _UUID.fullmatch(first_key)
    has_tracks = any(isinstance(track, dict) and "nl" in track for track in document.values())
    return "cityflow-nl" if has_queries or has_tracks else None


def _nuscenes(document: Any) -> TextsAndIssues:
    """Read `[{token, name, description, log_token, nbr_samples, ...}]`."""
    if not isinstance(document, list):
        yield Issue("", f"is {type(document).__name__}, not a list of scenes")
        return
    for index, scene in enumerate(document):
        if not isinstance(scene, dict) or "description" not in scene:
            yield Issue(f"[{index}]", "is not a scene with a 'description'")
        else:
            yield from texts_of("scene", scene["description"], f"[{index}].description")


def _talk2car(document: Any) -> TextsAndIssues:
    """Read `{scene_tokens: [...], commands: [{command, scene_token, sample_token, ...}]}`."""
    commands = document.get("commands") if isinstance(document, dict) else None
    if not isinstance(commands, list):
        yield Issue("commands", "is missing, or is not a list")
        return
    for index, item in enumerate(commands):
        if not isinstance(item, dict) or "command" not in item:
            yield Issue(f"commands[{index}]", "has no 'command'")
        else:
            yield from texts_of("command", item["command"], f"commands[{index}].command")


def _header_fault(table: CsvTable) -> Issue | None:
    """Return an issue if a table lacks the columns of BDD-X."""
    if not table.header and isinstance(issue := next(table.rows, None), Issue):
        return issue
    if missing := [column for column in _BDD_X if column not in table.header]:
        return Issue(f"line {table.line}", f"has no column {missing[0]!r}")
    if twice := repeated(table.header, filter(_BDD_X_TEXT.fullmatch, table.header)):
        return Issue(f"line {table.line}", f"has two columns {twice!r}")
    return None


def _bdd_x(table: CsvTable) -> TextsAndIssues:
    """Read the columns `Answer.<k>action` and `Answer.<k>justification`, k from 1 to 15."""
    if fault := _header_fault(table):
        yield fault
        return
    columns = [match[1] for name in table.header if (match := _BDD_X_TEXT.fullmatch(name))]
    for row in table.rows:
        if isinstance(row, Issue):
            yield row
            continue
        for column in dict.fromkeys(columns):
            cells = {}
            for kind in ("action", "justification"):
                cell = f"{column}{kind}"
                for item in texts_of(kind, row.fields.get(cell), f"line {row.line}, {cell}"):
                    yield item
                    if isinstance(item, DatasetText):
                        cells[kind] = item.text
            action = cells.get("action", "").rstrip(_STOPS)
            if "justification" in cells and action:
                yield DatasetText("sentence", _joined(action, cells["justification"]))
            elif "action" in cells:
                yield DatasetText("sentence", cells["action"])


_STOPS = " .,;:"


def _joined(action: str, justification: str) -> str:
    """Join "The car stops" and "because the light is red.", or two whole sentences."""
    if justification[0].islower():
        comma = "" if _JOINING.match(justification) else ","
        return f"{action.rstrip('!?' + _STOPS)}{comma} {justification}"
    stop = "" if action.endswith(("!", "?")) else "."
    return f"{action}{stop} {justification}"


def _cityflow(document: Any) -> TextsAndIssues:
    """Read `{track id: {nl: [...], nl_other_views: [...]}}`, or, as in 2021, `{query id: [...]}`."""
    if not isinstance(document, dict):
        yield Issue("", f"is {type(document).__name__}, not an object of tracks")
        return
    for track, content in document.items():
        fields = {"nl": content} if isinstance(content, list) else content
        if not isinstance(fields, dict) or "nl" not in fields:
            yield Issue(
                track, "has no field 'nl': tracks of the test split come without descriptions"
            )
            continue
        for field, kind in (("nl", "view"), ("nl_other_views", "other_view")):
            texts = fields.get(field, [])
            if not isinstance(texts, list):
                yield Issue(f"{track}.{field}", f"is {type(texts).__name__}, not a list of texts")
                continue
            for index, text in enumerate(texts):
                yield from texts_of(kind, text, f"{track}.{field}[{index}]")


LAYOUTS: dict[str, FileLayout] = {
    "drivelm": FileLayout(
        "DriveLM", _NOT_COMMERCIAL, ("scene", "qa"), ("question", "answer", "object"), read_drivelm
    ),
    "nuscenes": FileLayout("nuScenes", _NOT_COMMERCIAL, ("scene",), (), _nuscenes),
    "talk2car": FileLayout("Talk2Car", _NOT_COMMERCIAL, ("command",), (), _talk2car),
    "bdd-x": FileLayout(
        "BDD-X",
        "UC Berkeley, educational, research and not-for-profit purposes",
        ("sentence",),
        ("action", "justification"),
        _bdd_x,
        is_csv=True,
    ),
    "cityflow-nl": FileLayout("CityFlow-NL", "Apache-2.0", ("view", "other_view"), (), _cityflow),
}
assert set(LAYOUTS) == set(get_args(LayoutName))

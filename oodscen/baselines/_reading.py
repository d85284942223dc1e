"""Reads texts from files: plain lines, JSON, JSON lines, CSV and TSV."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from oodscen._display import brief
from oodscen._io.csv import csv_fault, fields_up_to
from oodscen._io.files import read_utf8
from oodscen._io.json import parse_json
from oodscen._words.text import path_name
from oodscen.baselines._texts import MAX_CHARACTERS, fault_of, refuse
from oodscen.errors import Issue

_LINE_END = re.compile(r"\r\n|\r|\n")
_OBJECT = r"\s*\{(?!\s*\w[^\"':{}]*\})"
_TEXT_OBJECT = re.compile(_OBJECT)
"""Beginning of a JSON object; `{deer} on the road` is a text."""
_TEXT_LIST = re.compile(rf"\s*\[(?:\s*(?:[\"\]]|$)|[ \t]*[\r\n]|{_OBJECT})")
"""Beginning of a JSON list of strings or objects, or of any on several lines; `[Night] A deer stands.` is a text."""
_ONLY_LINE = re.compile(r" at line 1 (?=column \d+$)")
"""Place that a fault names in a line that was parsed alone."""

_GROUP_FIELDS = ("path", "leaf", "group")
"""Fields that may hold the group of a text; the first that is not empty counts."""

Values: TypeAlias = Iterator[tuple[str, Any] | Issue]
"""Values of a file, each with its place, and issues."""


class Record(NamedTuple):
    """One text of a file."""

    text: str
    group: str | None
    """The group of the text: its path in a scenario tree, if the file gives one."""

    def __repr__(self) -> str:
        return brief(self, self._asdict().items())


class CsvRow(NamedTuple):
    """One row of a CSV file."""

    line: int
    """Number of the line on which it begins."""
    fields: Mapping[str, str]
    """Cells by column; a short row lacks the last ones."""


class CsvTable(NamedTuple):
    """A CSV file."""

    line: int
    """Number of the line of the header."""
    header: tuple[str, ...]
    """Names of the columns; none if the file is empty or its first line is malformed."""
    rows: Iterator[CsvRow | Issue]


def read_records(path: str | Path, noun: str = "text file") -> list[Record]:
    """Return the texts in a file.

    The suffix tells the form: CSV or TSV with a column `text`; JSON lines (`.jsonl`: strings, or objects
    with `text`); JSON (a list of the same). In other files the beginning does: JSON, or plain lines. Objects and
    rows may have `path`, `leaf` or `group`. Blank lines are skipped, and white space around a text is dropped.

    Raises:
        DataError: If the file cannot be read or decoded, or holds no text; otherwise with one issue per
            line without a text.
    """
    content = read_utf8(path, noun)
    issues: list[Issue] = []
    records: list[Record] = []
    for value in _values(content, Path(path).suffix.lower()):
        record = value if isinstance(value, Issue) else _record(*value)
        if isinstance(record, Issue):
            issues.append(record)
        else:
            records.append(record)
    if not records and not issues:
        issues.append(Issue("", "holds no text"))
    refuse(noun, issues, source=str(path))
    return records


def _values(content: str, suffix: str) -> Values:
    """Yield each value with its place, or an issue instead of it."""
    if suffix in (".csv", ".tsv"):
        return _csv_values(content, "\t" if suffix == ".tsv" else ",")
    if suffix in (".jsonl", ".ndjson"):
        return _json_lines(content)
    if _TEXT_OBJECT.match(content):
        return _json_objects(content)
    if suffix == ".json" or _TEXT_LIST.match(content):
        return _json_list(content)
    return _plain_lines(content)


def _plain_lines(content: str) -> Values:
    """Yield the lines as texts; JSON among them belongs to another file, or to a heading above it."""
    for number, line in _lines(content):
        where = f"line {number}"
        kind = {"{": "object", "[": "list"}.get(line.lstrip()[0])
        if kind and _is_json(line):
            fault = f"is a JSON {kind} in a file of plain lines; write every line in one form"
            yield Issue(where, fault)
        else:
            yield where, line


def _is_json(line: str) -> bool:
    try:
        parse_json(line)
    except (ValueError, RecursionError):
        return False
    return True


def _lines(content: str) -> Iterator[tuple[int, str]]:
    """Yield the non-blank lines, each with its number.

    Not splitlines(): texts and JSON strings may hold line separators such as U+0085 and U+2028.
    """
    for number, line in enumerate(_LINE_END.split(content), 1):
        if line.strip():
            yield number, line


def _csv_values(content: str, delimiter: str) -> Values:
    table = read_csv(content, delimiter)
    if table.header and (fault := _header_fault(table.header)):
        listed = ", ".join(map(repr, table.header))
        yield Issue(f"line {table.line}", f"{fault} (columns: {listed})")
        return
    for row in table.rows:
        yield row if isinstance(row, Issue) else (f"line {row.line}", row.fields)


def _header_fault(header: tuple[str, ...]) -> str:
    if "text" not in header:
        return "has no column 'text'"
    twice = repeated(header, ("text", *_GROUP_FIELDS))
    return f"has two columns {twice!r}" if twice else ""


def repeated(header: tuple[str, ...], columns: Iterable[str]) -> str:
    """Return the first of some columns that a header names more than once; empty if there is none."""
    return next((name for name in columns if header.count(name) > 1), "")


def read_csv(content: str, delimiter: str = ",") -> CsvTable:
    """Read a CSV file with a header; rejects unclosed quotes, and text after a closing quote."""
    rows = _csv_rows(content, delimiter)
    first = next(rows, None)
    if first is None or isinstance(first, Issue):
        return CsvTable(1, (), iter([first] if first else []))
    line, header = first
    return CsvTable(line, tuple(header), _named_rows(rows, header))


def _named_rows(
    rows: Iterator[tuple[int, list[str]] | Issue], header: list[str]
) -> Iterator[CsvRow | Issue]:
    """Yield the rows below a header.

    A row with more fields than the header has a text that was split at a comma; it yields an issue.
    """
    for row in rows:
        if isinstance(row, Issue):
            yield row
            continue
        line, cells = row
        if any(map(str.strip, cells[len(header) :])):
            fault = f"has {len(cells)} fields, and the header has {len(header)}; quote texts with a comma"
            yield Issue(f"line {line}", fault)
        else:
            yield CsvRow(line, dict(zip(header, cells, strict=False)))


def _csv_rows(content: str, delimiter: str) -> Iterator[tuple[int, list[str]] | Issue]:
    """Return the rows that are not blank, each with the line on which it begins; malformed CSV ends them."""
    with fields_up_to(MAX_CHARACTERS):
        return iter(list(_limited_csv_rows(content, delimiter)))


def _limited_csv_rows(content: str, delimiter: str) -> Iterator[tuple[int, list[str]] | Issue]:
    reader = csv.reader(io.StringIO(content, newline=""), delimiter=delimiter, strict=True)
    while True:
        begins = reader.line_num + 1
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            yield Issue(f"line {begins}", f"is not CSV: {csv_fault(error)}")
            return
        if any(map(str.strip, cells)):
            yield begins, cells


def _json_list(content: str) -> Values:
    try:
        values = parse_json(content)
    except (ValueError, RecursionError) as error:
        yield Issue("", f"is not a JSON list: {error}")
        return
    if not isinstance(values, list):
        yield Issue("", "holds no list of texts, but one JSON value")
        return
    for index, value in enumerate(values):
        yield f"[{index}]", value


def _json_objects(content: str) -> Values:
    """Yield the objects of JSON lines under another name, or one object that takes several lines."""
    _, first = next(_lines(content))
    if _is_json(first):
        yield from _json_lines(content)
        return
    try:
        yield "", parse_json(content)
    except (ValueError, RecursionError) as error:
        yield Issue("", f"is not JSON: {error}")


def _json_lines(content: str) -> Values:
    for number, line in _lines(content):
        try:
            yield f"line {number}", parse_json(line)
        except (ValueError, RecursionError) as error:
            yield Issue(f"line {number}", f"is not JSON: {_ONLY_LINE.sub(' at ', str(error))}")


def _record(where: str, value: Any) -> Record | Issue:
    fields: Mapping[str, Any] = value if isinstance(value, dict) else {"text": value}
    if "text" not in fields:
        return Issue(where, "has no field 'text'")
    text = fields["text"]
    if fault := fault_of(text):
        return Issue(where, fault)
    group = _group(where, fields)
    return group if isinstance(group, Issue) else Record(text.strip(), group)


def _group(where: str, fields: Mapping[str, Any]) -> str | Issue | None:
    """Return the first of `path`, `leaf` and `group` that is not empty."""
    for name in _GROUP_FIELDS:
        value = fields.get(name)
        if value is None:
            continue
        values = value if isinstance(value, list) else [value]
        for label in values:
            if isinstance(label, bool) or not isinstance(label, str | int):
                return Issue(where, f"`{name}` holds {type(label).__name__}, not a text")
        labels = [str(label).strip() for label in values]
        if all(labels) and labels:
            return path_name(labels) if isinstance(value, list) else labels[0]
        if any(labels):
            return Issue(where, f"`{name}` holds a blank label")
    return None

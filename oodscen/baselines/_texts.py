"""Reads and checks sets of texts."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from importlib import resources
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias

from oodscen._display import brief
from oodscen._files import read_utf8
from oodscen._json import parse_json
from oodscen._text import whole
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError, Issue

MAX_CHARACTERS = 1_000_000
"""The longest text that is measured, in characters; a longer one comes from a file without line ends."""

_MOST_ISSUES = 20
_LINE_END = re.compile(r"\r\n|\r|\n")

Split = Literal["tune", "frozen"]
"""Half of a set of texts: to choose settings, or to report results."""
Rows: TypeAlias = "csv.DictReader[str]"


class Record(NamedTuple):
    """One text of a file."""

    text: str
    group: str | None
    """The group of the text: its path in a scenario tree, if the file gives one."""

    def __repr__(self) -> str:
        return brief(self, self._asdict().items())


def bundled(name: str, package: str = "oodscen.baselines") -> str:
    """Return the content of a text file that ships with a package."""
    return (resources.files(package) / name).read_text(encoding="utf-8")


def _is_flat(texts: object) -> bool:
    """Return whether something is no array or table of other than one dimension."""
    return getattr(texts, "ndim", 1) == 1


def check_texts(texts: Sequence[str | Scenario], noun: str = "text set") -> tuple[str, ...]:
    """Return the texts as strings, after checking that none is blank.

    Raises:
        DataError: If there is none; otherwise with one issue per text that is not a string, blank, or
            not valid Unicode.
    """
    if isinstance(texts, str | bytes):
        raise DataError(noun, [Issue("", "is one string, not a sequence of texts")])
    if (
        not isinstance(texts, Iterable)
        or isinstance(texts, Iterator | Mapping | Set)
        or not _is_flat(texts)
    ):
        fault = f"is {type(texts).__name__}, not a sequence of texts"
        raise DataError(noun, [Issue("", fault)])
    plain = [item.text if isinstance(item, Scenario) else item for item in texts]
    faults = enumerate(map(fault_of, plain))
    refuse(noun, [Issue(f"[{index}]", fault) for index, fault in faults if fault])
    if not plain:
        raise DataError(noun, [Issue("", "holds no text")])
    return tuple(plain)


def read_records(path: str | Path, noun: str = "text file") -> list[Record]:
    """Return the texts in a file.

    Plain lines; JSON lines (strings, or objects with `text`); a JSON list of the same; CSV or TSV
    with a column `text`, recognised by the suffix. Otherwise the first line tells the form. Objects and rows may have `path`, `leaf` or `group`.
    Blank lines are skipped, and white space around a text is dropped.

    Raises:
        DataError: If the file cannot be read or decoded, or holds no text; otherwise with one issue per
            line without a text.
    """
    content = read_utf8(path, noun)
    suffix = Path(path).suffix.lower()
    issues: list[Issue] = []
    records: list[Record] = []
    for where, value in _values(content, suffix):
        found = value if isinstance(value, Issue) else _record(where, value)
        if isinstance(found, Issue):
            issues.append(found)
        else:
            records.append(found)
    if not records and not issues:
        issues.append(Issue("", "holds no text"))
    refuse(noun, issues, source=str(path))
    return records


def _values(content: str, suffix: str) -> Iterator[tuple[str, Any]]:
    """Yield each value with its place, or an issue instead of a value."""
    start = content.lstrip()[:1]
    if suffix in (".csv", ".tsv"):
        yield from _rows(content, "\t" if suffix == ".tsv" else ",")
    elif start == "[" or (suffix == ".json" and start != "{"):
        yield from _list(content)
    elif start == "{" or suffix in (".jsonl", ".ndjson"):
        yield from _json_lines(content, suffix)
    else:
        yield from _plain_lines(content)


def _plain_lines(content: str) -> Iterator[tuple[str, Any]]:
    """Yield the lines as texts; a JSON object among them belongs to another file, or to a heading above it."""
    for number, line in _lines(content):
        where = f"line {number}"
        if line.lstrip().startswith("{") and _is_json(line):
            fault = (
                "is a JSON object in a file whose first line is none; write every line in one form"
            )
            yield where, Issue(where, fault)
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


def _rows(content: str, delimiter: str) -> Iterator[tuple[str, Any]]:
    reader = csv_reader(content, delimiter)
    names: Sequence[str] = ()
    for line, row in csv_rows(reader):
        names = names or reader.fieldnames or ()
        if not isinstance(row, Issue) and names.count("text") != 1:
            listed = ", ".join(names)
            fault = "has no column 'text'" if "text" not in names else "has two columns 'text'"
            yield "line 1", Issue("line 1", f"{fault} (columns: {listed})")
            return
        yield f"line {line}", row


def csv_reader(content: str, delimiter: str = ",") -> Rows:
    """Return a CSV reader that rejects unclosed quotes and quotes inside a field."""
    return csv.DictReader(io.StringIO(content, newline=""), delimiter=delimiter, strict=True)


def csv_rows(reader: Rows) -> Iterator[tuple[int, dict[str, str] | Issue]]:
    """Yield the rows of a CSV file with the lines on which they begin; reading stops after malformed CSV.

    A row with more fields than the header has a text that was split at a comma; it yields an issue.
    """
    while True:
        begins = reader.line_num + 1
        try:
            header = reader.fieldnames or ()
            begins = max(begins, 2)
            row = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            fault = "a quote is not closed" if "end of data" in str(error) else str(error)
            yield begins, Issue(f"line {begins}", f"is not CSV: {fault}")
            return
        more = row.pop(None, None)  # csv.DictReader collects surplus fields under the key None.
        if more and any(map(str.strip, more)):
            fault = f"has {len(header) + len(more)} fields, and the header has {len(header)}; quote texts with a comma"
            yield begins, Issue(f"line {begins}", fault)
        else:
            yield begins, row


def _list(content: str) -> Iterator[tuple[str, Any]]:
    try:
        values = parse_json(content)
    except (ValueError, RecursionError) as error:
        yield "", Issue("", f"is not a JSON list: {error}")
        return
    if not isinstance(values, list):
        yield "", Issue("", "holds no list of texts, but one JSON value")
        return
    for index, value in enumerate(values):
        yield f"[{index}]", value


def _json_lines(content: str, suffix: str) -> Iterator[tuple[str, Any]]:
    if suffix == ".json":
        try:
            value = parse_json(content)
        except (ValueError, RecursionError):
            pass  # Several objects, one a line: JSON lines under another name.
        else:
            yield "", value
            return
    for number, line in _lines(content):
        try:
            yield f"line {number}", parse_json(line)
        except (ValueError, RecursionError) as error:
            yield "", Issue(f"line {number}", f"is not JSON: {error}")


def _record(where: str, value: Any) -> Record | Issue:
    fields = value if isinstance(value, dict) else {"text": value}
    if "text" not in fields:
        return Issue(where, "has no field 'text'")
    text = fields["text"]
    if fault := fault_of(text):
        return Issue(where, fault)
    return Record(text.strip(), _group(fields))


def _group(fields: dict[str, Any]) -> str | None:
    for name in ("path", "leaf", "group"):
        value = fields.get(name)
        if isinstance(value, list) and value:
            return whole(" / ".join(map(str, value)))
        if isinstance(value, str) and value.strip():
            return whole(value.strip())
    return None


def fault_of(text: object) -> str:
    """Return the reason why a value is not a usable text; empty if it is one."""
    if not isinstance(text, str):
        return f"is {type(text).__name__}, not a text"
    if not text.strip():
        return "is blank"
    if len(text) > MAX_CHARACTERS:
        return f"has {len(text):,} characters, and a text has at most {MAX_CHARACTERS:,}"
    if "\0" in text:
        return "holds a NUL character; is the file UTF-16?"
    try:
        text.encode()
    except UnicodeEncodeError:
        return "is not valid Unicode: it holds half of a surrogate pair"
    return ""


def refuse(noun: str, issues: Iterable[Issue], *, source: str = "") -> None:
    """Raise a `DataError` if there are issues; a long list is cut after the first ones."""
    found = list(issues)
    if len(found) > _MOST_ISSUES:
        rest = len(found) - _MOST_ISSUES
        found = [*found[:_MOST_ISSUES], Issue("", f"and {rest} more like these")]
    if found:
        raise DataError(noun, found, source=source)

"""Recordings of questions and answers as lines of JSON.

A recording is a JSONL file with one exchange per line, as `Exchange` describes it. `RecordingLLM` writes it,
or any other tool with any model: a line needs `purpose`, `messages` and `answer`.
"""

import itertools
import json
import os
import threading
import weakref
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from io import FileIO
from pathlib import Path
from typing import BinaryIO, ClassVar, NamedTuple

from pydantic import Field

from oodscen._display import Brief
from oodscen._io.files import refuse_special, unreadable
from oodscen._io.lock import locked
from oodscen._words.redaction import redact_keys
from oodscen.data._base import LeanData, digest
from oodscen.data._messages import Message
from oodscen.errors import DataError, Issue, StudyError, UsageError
from oodscen.protocols import Completion, InsteadOfText, Request, Usage

SHOWN = 60
"""Number of characters quoted from each of two texts where they first differ."""

_LONGEST = 1 << 26
"""Bytes at which a line is refused: no exchange is as long."""


class Exchange(LeanData):
    """One question and its answer, as a line of a recording, without credentials."""

    noun: ClassVar[str] = "exchange"
    _left_out: ClassVar[tuple[str, ...]] = ("instead", "answered_by")

    purpose: str
    """The prompt's purpose, e.g. `stage-scene`."""
    messages: tuple[Message, ...]
    """The conversation as it was sent, with pictures by name and SHA-256."""
    answer: str
    """The raw answer."""
    sample: int = Field(default=0, ge=0, strict=True)
    """Index of the draw, for several independent draws of the same question."""
    attempt: int = Field(default=1, ge=1, strict=True)
    """Above 1 if the last turns ask for a repair."""
    model: str = ""
    """Name of the model that was asked."""
    prompt_version: str = ""
    """Hash of template and answer schema."""
    usage: Usage = Usage()
    seconds: float = Field(default=0.0, ge=0.0)
    """Time until the answer, including waiting and retries."""
    requests: int = Field(default=1, ge=0, strict=True)
    """HTTP requests, retries included."""
    is_cut_off: bool = False
    """`Completion.is_cut_off`."""
    instead: InsteadOfText | None = None
    """`Completion.instead`."""
    answered_by: str | None = None
    """`Completion.answered_by`."""

    @classmethod
    def of(cls, request: Request, completion: Completion, model: str, seconds: float) -> "Exchange":
        """Return the exchange of a question and its answer."""
        return cls(
            purpose=request.prompt.purpose,
            messages=request.messages,
            answer=completion.text,
            sample=request.sample,
            attempt=request.attempt,
            model=model,
            prompt_version=request.prompt.version(),
            usage=completion.usage,
            seconds=round(seconds, 6),
            requests=completion.requests,
            is_cut_off=completion.is_cut_off,
            instead=completion.instead,
            answered_by=completion.answered_by,
        )

    def completion(self) -> Completion:
        """Return the recorded answer, which costs no request."""
        return Completion(
            text=self.answer,
            usage=self.usage,
            requests=0,
            is_cut_off=self.is_cut_off,
            instead=self.instead,
            answered_by=self.answered_by,
        )

    def key(self) -> str:
        """Return the key by which a request is matched to this exchange."""
        return _digest(self.purpose, self.sample, self.attempt, self.messages)


class _LineSpan(NamedTuple):
    """The line of an exchange in its file."""

    model: str
    line: int
    """Number of the line, from 1."""
    start: int
    """Offset of its first byte."""
    length: int
    """Number of its bytes."""


class _Fingerprint(NamedTuple):
    inode: int
    size: int
    modified_ns: int


class Recording(Brief):
    """A read-only file of exchanges, found by content and sample and loaded on demand.

    The file is never written. A torn last line is skipped; a complete one without its newline counts. Only
    line feeds end lines.

    Args:
        path: The file; a missing file is an empty recording.

    Raises:
        DataError: When a line is not an exchange, with its number, or the file cannot be read.
    """

    _repr_fields = ("path",)

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._spans: dict[str, list[_LineSpan]] = {}
        """Lines of the exchanges, by their key."""
        self._line = 0
        """Number of the last line read."""
        self._end = 0
        """Offset of that line's end."""
        self._is_ended = True
        """True if that line ends with a newline."""
        self._torn = b""
        """The torn line after it."""
        self._lock = threading.Lock()
        self._read()

    def __len__(self) -> int:
        return sum(map(len, self._spans.values()))

    def find(self, request: Request, model: str | None = None) -> Exchange | None:
        """Return the exchange that answers a request, the latest if there are several.

        Args:
            request: The question.
            model: Name of the model that must have answered; any model if left out.

        Raises:
            UsageError: When several models answered and none is chosen.
        """
        with self._lock:
            spans = [span for span in self._answers(request) if model in (None, span.model)]
        if not spans:
            return None
        self._refuse_several(spans)
        with self._open_file() as file:
            return self._load(file, spans[-1])

    def count(self, request: Request, model: str) -> int:
        """Return how many answers of a model to a request there are."""
        with self._lock:
            return sum(span.model == model for span in self._answers(request))

    def _answers(self, request: Request) -> Sequence[_LineSpan]:
        """Return the lines that answer a request, whose credentials a recorder replaces; the lock must be held."""
        spans = self._spans.get(_key(request))
        return self._spans.get(_key(_without_keys(request)), ()) if spans is None else spans

    def refuse_several(self) -> None:
        """Refuse a recording in which several models answered one question.

        Raises:
            UsageError: If this is one.
        """
        with self._lock:
            for spans in self._spans.values():
                self._refuse_several(spans)

    def _refuse_several(self, spans: Iterable[_LineSpan]) -> None:
        names = sorted({span.model for span in spans})
        if len(names) > 1:
            told = ", ".join(name or "one without a name" for name in names)
            example = names[0] or names[1]
            raise UsageError(
                f"{self.path} has answers of several models to the same question ({told}); "
                f"choose one, e.g. replay:{self.path}#{example}"
            )

    @property
    def models(self) -> set[str]:
        """Names of the recorded models."""
        return {span.model for spans in self._spans.values() for span in spans}

    def differences(self, request: Request, model: str | None = None) -> list[Issue]:
        """Return the differences between a request and the most similar recorded question."""
        request = _without_keys(request)
        purpose = request.prompt.purpose
        nearest: tuple[tuple[int, int], list[Issue]] | None = None
        other_purposes: set[str] = set()
        with self._lock:
            spans = sorted(
                itertools.chain.from_iterable(self._spans.values()), key=lambda span: span.start
            )
        with self._open_file() as file:
            for span in spans:
                if model not in (None, span.model):
                    continue
                exchange = self._load(file, span)
                if exchange.purpose != purpose:
                    other_purposes.add(exchange.purpose)
                    continue
                issues = _differences(exchange, request)
                shared = _shared_characters(exchange.messages, request.messages)
                rank = (len(issues), -shared)
                if nearest is None or rank < nearest[0]:
                    nearest = (rank, issues)
        if nearest is not None:
            return nearest[1]
        recorded = ", ".join(sorted(other_purposes)) or "nothing"
        return [Issue("purpose", f"{purpose!r} was never recorded (recorded: {recorded})")]

    def _read(self) -> None:
        self._spans, self._line, self._end, self._is_ended, self._torn = {}, 0, 0, True, b""
        self._fingerprint = self._file_fingerprint()
        if self._fingerprint is None:
            return
        with self._open_file() as file:
            while line := file.readline(_LONGEST):
                if len(line) == _LONGEST:
                    issue = Issue(f"line {self._line + 1}", f"has {_LONGEST:,} bytes and more")
                    raise DataError("recording", [issue], source=str(self.path))
                if line.strip():
                    if not line.endswith(b"\n") and not _is_whole(line):
                        self._torn = line
                        return
                    self._remember(self._parse(line, self._line + 1), len(line))
                else:
                    self._line += 1
                    self._end += len(line)
                self._is_ended = line.endswith(b"\n")

    def _remember(self, exchange: Exchange, length: int) -> None:
        self._line += 1
        span = _LineSpan(exchange.model, self._line, self._end, length)
        self._spans.setdefault(exchange.key(), []).append(span)
        self._end += length

    def _file_fingerprint(self) -> _Fingerprint | None:
        """Return a fingerprint that changes with the file's content, or `None` if there is no file."""
        try:
            status = self.path.stat()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise unreadable("recording", self.path, error) from None
        return _Fingerprint(status.st_ino, status.st_size, status.st_mtime_ns)

    def _load(self, file: BinaryIO, span: _LineSpan) -> Exchange:
        file.seek(span.start)
        return self._parse(file.read(span.length), span.line)

    def _parse(self, line: bytes, number: int) -> Exchange:
        line = line.removeprefix(BOM_UTF8)
        return Exchange.parse(line, source=f"{self.path}, line {number}")

    @contextmanager
    def _open_file(self) -> Iterator[BinaryIO]:
        refuse_special(self.path, "recording")
        try:
            with self.path.open("rb") as file:
                yield file
        except OSError as error:
            raise unreadable("recording", self.path, error) from None


class Recorder(Recording):
    """A recording that one process at a time appends to.

    Its file is locked from the first unanswered question until this object is closed or garbage-collected.
    Within a process, share one recorder per file with `Recorder.at`.

    Args:
        path: The file, which the first exchange creates if it does not exist. A torn last line is cut off then.
    """

    def __init__(self, path: str | Path) -> None:
        self._file: FileIO | None = None
        self._is_open = False
        self._opening = threading.Lock()
        self._held = ExitStack()
        weakref.finalize(self, self._held.close)
        super().__init__(path)

    @classmethod
    def at(cls, path: str | Path) -> "Recorder":
        """Return this process's recorder of a file, or a new one if there is none."""
        try:
            resolved = Path(path).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            raise DataError("recording", [Issue("", str(error))], source=str(path)) from None
        with _recorders_lock:
            recorder = _recorders.get(resolved)
            if recorder is not None:
                if not recorder._is_outdated():
                    return recorder
                recorder.close()
            recorder = _recorders[resolved] = cls(path)
            return recorder

    def open(self) -> None:
        """Lock the file and read what other processes have added.

        Raises:
            InUse: When another process is recording to it.
            DataError: When the file holds anything but a recording; it is left alone.
        """
        with self._opening:
            if self._is_open:
                return
            try:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._held.enter_context(locked(self.path, "recording"))
                with self._lock:
                    if self._is_outdated():
                        self._read()
                    if not len(self) and not _BEGINNING.startswith(self._torn[: len(_BEGINNING)]):
                        self._parse(self._torn, self._line + 1)
            except BaseException as error:
                self._held.close()
                if isinstance(error, OSError):
                    raise self._unwritable(error) from error
                raise
            self._is_open = True

    def close(self) -> None:
        """Release the file; the next addition opens it again."""
        with self._opening, self._lock:
            self._file = None
            self._is_open = False
            self._held.close()
            self._fingerprint = self._file_fingerprint()

    def add(self, exchange: Exchange) -> None:
        """Append an exchange and hand it to the operating system.

        Raises:
            InUse: When another process is recording to the file.
            StudyError: When the file cannot be written; its content stays.
        """
        self.open()
        update = {
            "messages": _redacted(exchange.messages),
            "answer": redact_keys(exchange.answer),
        }
        exchange = exchange.model_copy(update=update)
        line = exchange.to_json().encode() + b"\n"
        with self._lock:
            try:
                self._append(line)
            except OSError as error:
                raise self._unwritable(error) from error
            self._remember(exchange, len(line))

    def _append(self, line: bytes) -> None:
        if self._file is None:
            self._file = self._held.enter_context(self.path.open("ab", buffering=0))
            self._file.truncate(self._end)
            if not self._is_ended:
                self._end += self._file.write(b"\n")
                self._is_ended = True
        rest = memoryview(line)
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError:
            # Reopening the file cuts off the partial line.
            self._file = None
            raise

    def _is_outdated(self) -> bool:
        """Return whether another process has changed or replaced the file since it was read."""
        fingerprint = self._file_fingerprint()
        if self._file is None:
            return fingerprint != self._fingerprint
        return fingerprint is None or fingerprint.inode != os.fstat(self._file.fileno()).st_ino

    def _unwritable(self, error: OSError) -> StudyError:
        return StudyError(f"cannot record in {self.path}: {error.strerror or error}")


_BEGINNING = b'{"answer":'
"""The first bytes of every line that a recorder writes."""

_recorders: weakref.WeakValueDictionary[Path, Recorder] = weakref.WeakValueDictionary()
_recorders_lock = threading.Lock()


def _key(request: Request) -> str:
    """Return the key of the exchanges that answer a request."""
    return _digest(request.prompt.purpose, request.sample, request.attempt, request.messages)


def _without_keys(request: Request) -> Request:
    """Return a request with its credentials replaced."""
    return replace(request, messages=_redacted(request.messages))


def _redacted(messages: tuple[Message, ...]) -> tuple[Message, ...]:
    return tuple(
        message.model_copy(update={"text": redact_keys(message.text)}) for message in messages
    )


def _digest(purpose: str, sample: int, attempt: int, messages: tuple[Message, ...]) -> str:
    turns = [
        [message.role, message.text, [image.sha256 for image in message.images]]
        for message in messages
    ]
    return digest([purpose, sample, attempt, turns])


def _is_whole(line: bytes) -> bool:
    """Return whether a line without a newline is complete, i.e. valid JSON."""
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return False
    return True


def _differences(exchange: Exchange, request: Request) -> list[Issue]:
    issues = []
    version = request.prompt.version()
    if exchange.prompt_version and exchange.prompt_version != version:
        issues.append(
            Issue("prompt_version", f"recorded {exchange.prompt_version}, asked {version}")
        )
    for name in ("sample", "attempt"):
        recorded, asked = getattr(exchange, name), getattr(request, name)
        if recorded != asked:
            issues.append(Issue(name, f"recorded {recorded}, asked {asked}"))
    if len(exchange.messages) != len(request.messages):
        counts = f"recorded {len(exchange.messages)} turns, asked {len(request.messages)}"
        issues.append(Issue("messages", counts))
    for number, (old, new) in enumerate(zip(exchange.messages, request.messages, strict=False)):
        path = f"messages[{number}]"
        if old.role != new.role:
            issues.append(Issue(f"{path}.role", f"recorded {old.role}, asked {new.role}"))
        if old.text != new.text:
            issues.append(Issue(f"{path}.text", _first_difference(old.text, new.text)))
        if [image.sha256 for image in old.images] != [image.sha256 for image in new.images]:
            fault = f"other pictures: recorded {_image_names(old)}, asked {_image_names(new)}"
            issues.append(Issue(f"{path}.images", fault))
    return issues


def _image_names(message: Message) -> str:
    return ", ".join(image.name for image in message.images) or "none"


def _first_difference(old: str, new: str) -> str:
    start = _prefix_length(old, new)
    recorded, asked = old[start : start + SHOWN], new[start : start + SHOWN]
    return f"differs from character {start}: recorded {recorded!r}, asked {asked!r}"


def _prefix_length(old: str, new: str) -> int:
    for length, (old_character, new_character) in enumerate(zip(old, new, strict=False)):
        if old_character != new_character:
            return length
    return min(len(old), len(new))


def _shared_characters(old: tuple[Message, ...], new: tuple[Message, ...]) -> int:
    """Return how many characters at the beginnings of the turns are the same."""
    return sum(_prefix_length(a.text, b.text) for a, b in zip(old, new, strict=False))

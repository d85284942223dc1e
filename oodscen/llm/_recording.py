"""Recordings of questions and answers as lines of JSON.

A recording is a JSONL file with one exchange per line, as `Exchange` describes it. `RecordingLLM` writes it,
or any other tool with any model: a line needs `purpose`, `messages` and `answer`.
"""

import itertools
import json
import os
import threading
import weakref
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from io import FileIO
from pathlib import Path
from typing import BinaryIO, ClassVar, NamedTuple

from pydantic import Field

from oodscen._display import Brief
from oodscen._files import refuse_special, unreadable
from oodscen._lock import locked
from oodscen._redaction import redact_keys
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
    _left_out: ClassVar[tuple[str, ...]] = ("instead",)

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
    """Name of the model that answered."""
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
        )

    def again(self) -> Completion:
        """Return the recorded answer, which costs no request."""
        return Completion(
            text=self.answer,
            usage=self.usage,
            requests=0,
            is_cut_off=self.is_cut_off,
            instead=self.instead,
        )

    def key(self) -> str:
        """Return the key by which a request is matched to this exchange."""
        return _key(self.purpose, self.sample, self.attempt, self.messages)


class _RecordPlace(NamedTuple):
    model: str
    line: int
    start: int
    length: int


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
        self._places: dict[str, list[_RecordPlace]] = {}
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
        return sum(map(len, self._places.values()))

    def find(self, request: Request, model: str | None = None) -> Exchange | None:
        """Return the exchange that answers a request, the latest if there are several.

        Args:
            request: The question.
            model: Name of the model that must have answered; any model if left out.

        Raises:
            UsageError: When several models answered and none is chosen.
        """
        key = _key(request.prompt.purpose, request.sample, request.attempt, request.messages)
        with self._lock:
            places = [p for p in self._places.get(key, ()) if model in (None, p.model)]
        if not places:
            return None
        names = sorted({place.model for place in places})
        if len(names) > 1:
            raise UsageError(
                f"{self.path} has answers of several models to the same question ({', '.join(names)}); "
                f"choose one, e.g. replay:{self.path}#{names[0]}"
            )
        with self._opened() as file:
            file.seek(places[-1].start)
            return self._parse(file.read(places[-1].length), places[-1].line)

    @property
    def models(self) -> set[str]:
        """Names of the recorded models."""
        return {place.model for places in self._places.values() for place in places}

    def differences(self, request: Request, model: str | None = None) -> list[Issue]:
        """Return the differences between a request and the most similar recorded question."""
        purpose = request.prompt.purpose
        best: tuple[tuple[int, int], list[Issue]] | None = None
        others: set[str] = set()
        with self._lock:
            found = itertools.chain.from_iterable(self._places.values())
            places = sorted(found, key=lambda place: place.start)
        with self._opened() as file:
            for place in places:
                if model not in (None, place.model):
                    continue
                file.seek(place.start)
                exchange = self._parse(file.read(place.length), place.line)
                if exchange.purpose != purpose:
                    others.add(exchange.purpose)
                    continue
                issues = _differences(exchange, request)
                shared = _shared(exchange.messages, request.messages)
                rank = (len(issues), -shared)
                if best is None or rank < best[0]:
                    best = (rank, issues)
        if best is not None:
            return best[1]
        known = ", ".join(sorted(others)) or "nothing"
        return [Issue("purpose", f"{purpose!r} was never recorded (recorded: {known})")]

    def _read(self) -> None:
        self._places, self._line, self._end, self._torn = {}, 0, 0, b""
        self._seen = self._state()
        if self._seen is None:
            return
        with self._opened() as file:
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
        place = _RecordPlace(exchange.model, self._line, self._end, length)
        self._places.setdefault(exchange.key(), []).append(place)
        self._end += length

    def _state(self) -> tuple[int, int, int] | None:
        """Return a fingerprint that changes with the file's content, or `None` if there is no file."""
        try:
            found = self.path.stat()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise unreadable("recording", self.path, error) from None
        return found.st_ino, found.st_size, found.st_mtime_ns

    def _parse(self, line: bytes, number: int) -> Exchange:
        return Exchange.parse(line, source=f"{self.path}, line {number}")

    @contextmanager
    def _opened(self) -> Iterator[BinaryIO]:
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
            place = Path(path).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            raise DataError("recording", [Issue("", str(error))], source=str(path)) from None
        with _sharing:
            recorder = _recorders.get(place)
            if recorder is not None:
                if not recorder._is_outdated():
                    return recorder
                recorder.close()
            recorder = _recorders[place] = cls(path)
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
            self._seen = self._state()

    def add(self, exchange: Exchange) -> None:
        """Append an exchange and hand it to the operating system.

        Raises:
            InUse: When another process is recording to the file.
            StudyError: When the file cannot be written; its content stays.
        """
        self.open()
        messages = tuple(
            message.model_copy(update={"text": redact_keys(message.text)})
            for message in exchange.messages
        )
        answer = redact_keys(exchange.answer)
        exchange = exchange.model_copy(update={"messages": messages, "answer": answer})
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
        found = self._state()
        if self._file is None:
            return found != self._seen
        return found is None or found[0] != os.fstat(self._file.fileno()).st_ino

    def _unwritable(self, error: OSError) -> StudyError:
        return StudyError(f"cannot record in {self.path}: {error.strerror or error}")


_BEGINNING = b'{"answer":'
"""The first bytes of every line that a recorder writes."""

_recorders: weakref.WeakValueDictionary[Path, Recorder] = weakref.WeakValueDictionary()
_sharing = threading.Lock()


def _key(purpose: str, sample: int, attempt: int, messages: tuple[Message, ...]) -> str:
    turns = [[m.role, m.text, [image.sha256 for image in m.images]] for m in messages]
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
        if [i.sha256 for i in old.images] != [i.sha256 for i in new.images]:
            names = [", ".join(image.name for image in m.images) or "none" for m in (old, new)]
            issues.append(
                Issue(f"{path}.images", f"other pictures: recorded {names[0]}, asked {names[1]}")
            )
    return issues


def _first_difference(old: str, new: str) -> str:
    at = _prefix(old, new)
    quoted = [repr(text[at : at + SHOWN]) for text in (old, new)]
    return f"differs from character {at}: recorded {quoted[0]}, asked {quoted[1]}"


def _prefix(old: str, new: str) -> int:
    pairs = zip(old, new, strict=False)
    return sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], pairs))


def _shared(old: tuple[Message, ...], new: tuple[Message, ...]) -> int:
    return sum(_prefix(a.text, b.text) for a, b in zip(old, new, strict=False))

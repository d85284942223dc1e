"""Recordings: every question and its answer as a line of JSON, and models that answer from them.

A recording is a JSONL file, one exchange per line, as `Exchange` describes it. It can be made by
`RecordingLLM`, or elsewhere, by any model: what a line needs is `purpose`, `messages` and `answer`.
"""

import hashlib
import itertools
import json
import os
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from io import FileIO
from pathlib import Path
from typing import BinaryIO, ClassVar, NamedTuple

from oodscen._lock import locked
from oodscen._redaction import redact_keys
from oodscen.data._base import Data, canonical_json
from oodscen.data._messages import Message
from oodscen.errors import DataError, Issue, ReplayMiss, StudyError, UsageError
from oodscen.llm._wrapper import Wrapper
from oodscen.protocols import LLM, Completion, Request, Usage

SHOWN = 60
"""How much of two texts is quoted where they differ, in characters."""


class Exchange(Data):
    """One question and its answer, as a line of a recording. It holds no credentials."""

    noun: ClassVar[str] = "exchange"

    purpose: str
    """Of the prompt, e.g. `stage-scene`."""
    messages: tuple[Message, ...]
    """The conversation as it was sent; pictures by name and SHA-256."""
    answer: str
    """Raw, as it came."""
    sample: int = 0
    """Which of several independent draws of the same question this is."""
    attempt: int = 1
    """Above 1 the last turns ask for repair."""
    model: str = ""
    """Who answered."""
    prompt_version: str = ""
    """Hash of template and answer schema."""
    usage: Usage = Usage()
    seconds: float = 0.0
    """Until the answer, waiting and retries included."""
    requests: int = 1
    """HTTP requests, retries included."""

    @classmethod
    def of(cls, request: Request, completion: Completion, model: str, seconds: float) -> "Exchange":
        """Put a question and its answer together."""
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
        )

    def key(self) -> str:
        """Return what decides whether this answers a request."""
        return _key(self.purpose, self.sample, self.attempt, self.messages)


class _Place(NamedTuple):
    model: str
    line: int
    start: int
    length: int


class Recording:
    """A file of exchanges, for reading: found by content and sample, read when needed.

    The file is never written. A last line that is torn is passed over; one that merely lacks its line break
    counts. Lines end at line feeds and nowhere else.

    Args:
        path: The file; there is nothing in it if it does not exist.

    Raises:
        DataError: When a line is no exchange, with its number, or the file cannot be read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._places: dict[str, list[_Place]] = {}
        self._line = 0
        """Number of the last line that was read."""
        self._end = 0
        """Where it ends."""
        self._is_ended = True
        """Whether there is a line break behind it."""
        self._torn = b""
        """What follows it and is no whole line."""
        self._lock = threading.Lock()
        self._read()

    def __len__(self) -> int:
        return sum(map(len, self._places.values()))

    def find(self, request: Request, model: str | None = None) -> Exchange | None:
        """Return the exchange that answers a request, the latest if there are several.

        Args:
            request: What is asked.
            model: Who must have answered; anybody if left out.

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
        """Names of the models that were recorded."""
        return {place.model for places in self._places.values() for place in places}

    def differences(self, request: Request, model: str | None = None) -> list[Issue]:
        """Say how the most similar recorded question differs from a request."""
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
            for line in file:
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
        place = _Place(exchange.model, self._line, self._end, length)
        self._places.setdefault(exchange.key(), []).append(place)
        self._end += length

    def _state(self) -> tuple[int, int, int] | None:
        """Return what changes with the file's content; `None` where there is no file."""
        try:
            found = self.path.stat()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise self._unreadable(error) from None
        return found.st_ino, found.st_size, found.st_mtime_ns

    def _parse(self, line: bytes, number: int) -> Exchange:
        return Exchange.parse(line, source=f"{self.path}, line {number}")

    @contextmanager
    def _opened(self) -> Iterator[BinaryIO]:
        try:
            with self.path.open("rb") as file:
                yield file
        except OSError as error:
            raise self._unreadable(error) from None

    def _unreadable(self, error: OSError) -> DataError:
        issue = Issue("", error.strerror or str(error))
        return DataError("recording", [issue], source=str(self.path))


class Recorder(Recording):
    """A recording that is appended to, by one process at a time.

    Its file is locked from the first question that it has no answer to until this object is closed or
    forgotten. Recorders of one file in one process are best shared: `Recorder.at`.

    Args:
        path: The file; made with the first exchange if it does not exist. A torn last line is cut off then.
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
        """Return the recorder that this process has for a file already, or else a new one."""
        place = Path(path).resolve()
        with _sharing:
            recorder = _recorders.get(place)
            if recorder is not None:
                if not recorder._is_outdated():
                    return recorder
                recorder.close()
            recorder = _recorders[place] = cls(path)
            return recorder

    def open(self) -> None:
        """Lock the file, and take in what others have added meanwhile.

        Raises:
            InUse: When another process is recording there.
            DataError: When there is something in the file and it is no recording; it is left alone.
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
        """Let go of the file; the next addition opens it again."""
        with self._opening, self._lock:
            self._file = None
            self._is_open = False
            self._held.close()
            self._seen = self._state()

    def add(self, exchange: Exchange) -> None:
        """Append an exchange and hand it to the operating system.

        Raises:
            InUse: When another process is recording there.
            StudyError: When the file cannot be written; what was in it stays.
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
            # What is left of the line is cut off when the file is opened again.
            self._file = None
            raise

    def _is_outdated(self) -> bool:
        """Whether somebody else has changed the file since it was read, or put another in its place."""
        found = self._state()
        if self._file is None:
            return found != self._seen
        return found is None or found[0] != os.fstat(self._file.fileno()).st_ino

    def _unwritable(self, error: OSError) -> StudyError:
        return StudyError(f"cannot record in {self.path}: {error.strerror or error}")


_BEGINNING = b'{"answer":'
"""Of every line that a recorder writes."""

_recorders: weakref.WeakValueDictionary[Path, Recorder] = weakref.WeakValueDictionary()
_sharing = threading.Lock()


class RecordingLLM(Wrapper):
    """Records every answer of another model; what is recorded already is not asked again.

    Args:
        llm: Who really answers; its other attributes are reachable through this object.
        recorder: Where to; several models may share one.
        is_reading: Whether recorded answers of this model are given again.
    """

    def __init__(
        self, llm: LLM, recorder: Recorder | str | Path, *, is_reading: bool = True
    ) -> None:
        super().__init__(llm)
        self._recorder = recorder if isinstance(recorder, Recorder) else Recorder.at(recorder)
        self._is_reading = is_reading

    def complete(self, request: Request) -> Completion:
        """Give the recorded answer, or ask and record.

        Raises:
            InUse: When another process is recording there; nobody is asked.
        """
        if (found := self._found(request)) is not None:
            return found
        self._recorder.open()
        if (found := self._found(request)) is not None:
            return found
        began = time.perf_counter()
        completion = self._llm.complete(request)
        seconds = time.perf_counter() - began
        self._recorder.add(Exchange.of(request, completion, self.name, seconds))
        return completion

    def _found(self, request: Request) -> Completion | None:
        found = self._recorder.find(request, self.name) if self._is_reading else None
        return None if found is None else _said_again(found)


class ReplayLLM:
    """Answers from a recording and asks nobody: `replay:FILE`, or `replay:FILE#MODEL`.

    Args:
        source: The file; behind a `#` the model whose answers are given, if there are several.

    Raises:
        DataError: When there is no such file, or it is no recording.
    """

    def __init__(self, source: str | Path) -> None:
        path, mark, model = str(source).rpartition("#")
        if not mark or Path(source).is_file():
            path, model = str(source), ""
        if not Path(path).is_file():
            raise DataError("recording", [Issue("", "there is no such file")], source=path)
        self.name = (
            f"replay:{Path(path).name}{mark and '#'}{model}"
            if model
            else (f"replay:{Path(path).name}")
        )
        self._model = model or None
        self._recording = Recording(path)
        if not len(self._recording):
            raise DataError(
                "recording", [Issue("line 1", "it is no exchange, nor is another")], source=path
            )

    @property
    def speaks_for(self) -> str:
        """Name of the model that was recorded; this object's own where there are several."""
        names = {self._model} if self._model else self._recording.models
        return str(*names) if len(names) == 1 else self.name

    def complete(self, request: Request) -> Completion:
        """Return the recorded answer.

        Raises:
            ReplayMiss: When there is none; it says what differs from the most similar question.
        """
        found = self._recording.find(request, self._model)
        if found is None:
            raise ReplayMiss(
                self.name,
                request.prompt.purpose,
                self._recording.differences(request, self._model),
            )
        return _said_again(found)


def _said_again(exchange: Exchange) -> Completion:
    return Completion(text=exchange.answer, usage=exchange.usage, requests=0)


def _key(purpose: str, sample: int, attempt: int, messages: tuple[Message, ...]) -> str:
    turns = [[m.role, m.text, [image.sha256 for image in m.images]] for m in messages]
    return hashlib.sha256(canonical_json([purpose, sample, attempt, turns]).encode()).hexdigest()


def _is_whole(line: bytes) -> bool:
    """Whether a line that has no line break is complete: whatever else is in it, it is JSON."""
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

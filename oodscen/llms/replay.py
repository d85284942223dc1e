"""Recordings: every question and its answer as a line of JSON, and models that answer from them.

A recording is a JSONL file, one exchange per line, as `Exchange` describes it. It can be made by
`RecordingLLM`, or elsewhere, by any model: what a line needs is `purpose`, `messages` and `answer`.
"""

import hashlib
import itertools
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar, NamedTuple

from oodscen._data import Data, canonical_json
from oodscen.errors import DataError, Issue, ReplayMiss, UsageError
from oodscen.llms.redaction import redact_keys
from oodscen.llms.wrapper import Wrapper
from oodscen.messages import Message
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
    start: int
    length: int


class Recording:
    """A file of exchanges: found by content and sample, read when needed, appended as they come.

    Args:
        path: The file; made with the first exchange if it does not exist. A torn last line is dropped.

    Raises:
        DataError: When a line is no exchange, with its number.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._places: dict[str, list[_Place]] = {}
        self._lock = threading.Lock()
        self._end = 0
        torn = False
        for start, line in self._lines():
            torn = not line.endswith(b"\n")
            if torn and _is_torn(line):
                break
            self._remember(self._parse(line, start), start, len(line))
        if torn and self._end < self.path.stat().st_size:
            with self.path.open("r+b") as file:
                file.truncate(self._end)

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
        with self.path.open("rb") as file:
            file.seek(places[-1].start)
            return self._parse(file.read(places[-1].length), places[-1].start)

    @property
    def models(self) -> set[str]:
        """Names of the models that were recorded."""
        return {place.model for places in self._places.values() for place in places}

    def add(self, exchange: Exchange) -> None:
        """Append an exchange and hand it to the operating system."""
        line = (redact_keys(exchange.to_json()) + "\n").encode()
        with self._lock:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab") as file:
                if self._end and not self._ends_with_a_line:
                    line = b"\n" + line
                file.write(line)
            self._ends_with_a_line = True
            start = self._end + len(line) - len(line.lstrip(b"\n"))
            self._remember(exchange, start, self._end + len(line) - start)

    def differences(self, request: Request, model: str | None = None) -> list[Issue]:
        """Say how the most similar recorded question differs from a request."""
        purpose = request.prompt.purpose
        best: tuple[tuple[int, int], list[Issue]] | None = None
        others: set[str] = set()
        for start, line in self._lines():
            exchange = self._parse(line, start)
            if model is not None and exchange.model != model:
                continue
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

    _ends_with_a_line = True

    def _remember(self, exchange: Exchange, start: int, length: int) -> None:
        place = _Place(exchange.model, start, length)
        self._places.setdefault(exchange.key(), []).append(place)
        self._end = start + length

    def _lines(self) -> Iterator[tuple[int, bytes]]:
        if not self.path.is_file():
            return
        with self.path.open("rb") as file:
            start = 0
            for line in file:
                if line.strip():
                    self._ends_with_a_line = line.endswith(b"\n")
                    yield start, line
                start += len(line)

    def _parse(self, line: bytes, start: int) -> Exchange:
        return Exchange.parse(line, source=f"{self.path}, byte {start}")


class RecordingLLM(Wrapper):
    """Records every answer of another model; what is recorded already is not asked again.

    Args:
        llm: Who really answers; its other attributes are reachable through this object.
        recording: Where to; several models may share one.
        is_reading: Whether recorded answers of this model are given again.
    """

    def __init__(
        self, llm: LLM, recording: Recording | str | Path, *, is_reading: bool = True
    ) -> None:
        super().__init__(llm)
        self._recording = recording if isinstance(recording, Recording) else Recording(recording)
        self._is_reading = is_reading

    def complete(self, request: Request) -> Completion:
        """Give the recorded answer, or ask and record."""
        if self._is_reading and (found := self._recording.find(request, self.name)) is not None:
            return Completion(text=found.answer, usage=found.usage, requests=0)
        began = time.perf_counter()
        completion = self._llm.complete(request)
        seconds = time.perf_counter() - began
        self._recording.add(Exchange.of(request, completion, self.name, seconds))
        return completion


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
        return Completion(text=found.answer, usage=found.usage, requests=0)


def _key(purpose: str, sample: int, attempt: int, messages: tuple[Message, ...]) -> str:
    turns = [[m.role, m.text, [image.sha256 for image in m.images]] for m in messages]
    return hashlib.sha256(canonical_json([purpose, sample, attempt, turns]).encode()).hexdigest()


def _is_torn(line: bytes) -> bool:
    return not line.rstrip().endswith(b"}")


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

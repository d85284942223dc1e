"""A wrapper that logs every call of a language model."""

import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime
from typing import ClassVar, Literal

from oodscen._members import of_the_caller
from oodscen._words.redaction import redact
from oodscen.data._base import Data
from oodscen.errors import RunStopped
from oodscen.llm._check import complete
from oodscen.llm._prefix import cacheable_share
from oodscen.llm._remote.usage import plausible_usage
from oodscen.llm._wrapper import WrappingLLM
from oodscen.protocols import LLM, Completion, Request, Usage

Status = Literal["ok", "failed", "interrupted"]


class Call(Data):
    """One call, as a line of `calls.jsonl`, without texts, pictures or credentials."""

    noun: ClassVar[str] = "call"

    stage: str = ""
    """The study's stage, e.g. `augment`."""
    purpose: str
    """The prompt's purpose, e.g. `stage-scene`."""
    prompt_version: str
    """Hash of template and answer schema."""
    model: str
    sample: int
    attempt: int
    """1 for the question itself, higher for repair requests."""
    status: Status
    """`ok` if text came back, whether or not it was a valid answer; `interrupted` if the run was, by a signal."""
    error: str | None = None
    input_tokens: int = 0
    """0 if the number is not known, as for the others."""
    output_tokens: int = 0
    cached_tokens: int = 0
    """Input tokens that the provider had cached."""
    cacheable_tokens: int = 0
    """Input tokens of a prefix that earlier calls share, which a provider may cache; estimated from characters."""
    cost_usd: float | None = None
    """`None` if the price or a number of tokens is not known."""
    requests: int = 1
    """HTTP requests, retries included; 0 if none was needed or allowed."""
    seconds: float = 0.0
    """Time until the answer, including waiting and retries."""
    time: str = ""
    """When the question was asked, in UTC, e.g. `2026-01-31T12:00:00+00:00`."""


class LoggedLLM(WrappingLLM):
    """Reports every `complete` of another model, including failed ones.

    Args:
        llm: The wrapped model.
        log: Called once per call, never from two threads at a time. What it raises is raised by the call.
    """

    def __init__(self, llm: LLM, log: Callable[[Call], None]) -> None:
        super().__init__(llm)
        self._log = log
        self._lock = threading.Lock()

    def complete(self, request: Request) -> Completion:
        """Pass the request on and report the call."""
        asked_at, started = datetime.now(UTC), time.perf_counter()
        completion: Completion | None = None
        failure: BaseException | None = None
        try:
            completion = complete(self._llm, request)
        except BaseException as error:
            failure = error
            raise
        finally:
            seconds = time.perf_counter() - started
            call = self._call(request, completion, failure, asked_at, seconds)
            with self._lock, of_the_caller():
                self._log(call)
        return completion

    def _call(
        self,
        request: Request,
        completion: Completion | None,
        failure: BaseException | None,
        asked_at: datetime,
        seconds: float,
    ) -> Call:
        stated = completion.usage if completion else getattr(failure, "usage", None)
        usage = plausible_usage(stated, request) if isinstance(stated, Usage) else Usage()
        status, fault = _status(failure)
        return Call(
            purpose=request.prompt.purpose,
            prompt_version=request.prompt.version(),
            model=self.name,
            sample=request.sample,
            attempt=request.attempt,
            status=status,
            error=fault,
            input_tokens=usage.input_tokens,
            output_tokens=usage.output_tokens,
            cached_tokens=usage.cached_tokens,
            cacheable_tokens=round(cacheable_share(request) * usage.input_tokens),
            cost_usd=usage.cost_usd,
            requests=max(0, getattr(completion or failure, "requests", 0)),
            seconds=round(seconds, 6),
            time=asked_at.isoformat(timespec="seconds"),
        )


def _status(failure: BaseException | None) -> tuple[Status, str | None]:
    """Return the status of a call that ended with a failure or none, and the words for it."""
    if failure is None:
        return "ok", None
    if not isinstance(failure, Exception) or type(failure) is RunStopped:
        return "interrupted", "interrupted"
    return "failed", redact(f"{type(failure).__name__}: {failure}")

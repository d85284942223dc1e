"""Language models with answers that a test prescribes."""

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen.errors import LLMError
from oodscen.protocols import Completion, Request

Answer = str | Mapping[str, Any] | BaseModel | BaseException
"""Text or a `Completion` as is, another value to serialise as JSON, or an exception to raise."""


class ScriptedLLM(Brief):
    """Gives prepared answers, and records its requests.

    Args:
        answers: A sequence of answers to any question; by a prompt's `purpose`, a separate sequence of
            answers, or a single one that is repeated; or a function of the request, called possibly from
            several threads, which returns or raises the answer.
        name: The model's name in reports; by default `function` or `scripted`.

    Example:
        >>> llm = ScriptedLLM({"imagine-scenario": [{"text": "A piano lies on the road ahead."}]})
    """

    _repr_fields = ("name",)

    @checked
    def __init__(
        self,
        answers: Sequence[Answer]
        | Mapping[str, Answer | Sequence[Answer]]
        | Callable[[Request], Answer],
        *,
        name: str | None = None,
    ) -> None:
        self.name = name or ("function" if callable(answers) else "scripted")
        self.requests: list[Request] = []
        self._function = answers if callable(answers) else None
        self._by_purpose = dict(answers) if isinstance(answers, Mapping) else None
        self._for_all = tuple(answers) if isinstance(answers, Sequence) else ()
        self._answered: dict[str, int] = {}
        """Number of answers taken from the sequence of each purpose, or of none."""
        self._lock = threading.Lock()

    def complete(self, request: Request) -> Completion:
        """Return the next answer.

        Raises:
            LLMError: If no answer is left.
        """
        with self._lock:
            self.requests.append(request)
            if self._function is None:
                return _completion(self._next(request.prompt.purpose))
        return _completion(self._function(request))

    def _next(self, purpose: str) -> Answer:
        """Return the answer that is next for a purpose."""
        key = "" if self._by_purpose is None else purpose
        answers = self._for_all if self._by_purpose is None else self._by_purpose.get(purpose, ())
        if isinstance(answers, (str, Mapping, BaseModel, BaseException)):
            return answers
        index = self._answered.get(key, 0)
        if index >= len(answers):
            raise LLMError(
                f"{self.name} has no answer number {index + 1} to {purpose!r}", model=self.name
            )
        self._answered[key] = index + 1
        return answers[index]


def _completion(answer: Answer) -> Completion:
    """Return a prepared answer as a completion, or raise it."""
    if isinstance(answer, Completion):
        return answer
    if isinstance(answer, BaseException):
        raise answer
    if isinstance(answer, str):
        return Completion(text=answer)
    if isinstance(answer, BaseModel):
        return Completion(text=answer.model_dump_json())
    return Completion(text=json.dumps(answer, ensure_ascii=False, default=dict))

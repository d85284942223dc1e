"""Language models with answers that a test prescribes."""

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from oodscen._display import Brief
from oodscen.errors import LLMError
from oodscen.protocols import Completion, Request

Answer = str | Mapping[str, Any] | BaseModel | BaseException
"""Text as is, a value to serialise as JSON, or an exception to raise."""


class ScriptedLLM(Brief):
    """Gives prepared answers in order, and records its requests.

    Args:
        answers: A sequence of answers to any question; or, by a prompt's `purpose`, a separate sequence of
            answers. A single answer instead of a sequence is repeated.
        name: The model's name in reports.

    Example:
        >>> llm = ScriptedLLM({"imagine-scenario": [{"text": "A piano lies on the road ahead."}]})
    """

    _repr_fields = ("name",)

    def __init__(
        self,
        answers: Sequence[Answer] | Mapping[str, Answer | Sequence[Answer]],
        *,
        name: str = "scripted",
    ) -> None:
        self.name = name
        self.requests: list[Request] = []
        self._by_purpose = dict(answers) if isinstance(answers, Mapping) else None
        self._for_all = () if isinstance(answers, Mapping) else tuple(answers)
        self._given: dict[str, int] = {}
        self._lock = threading.Lock()

    def complete(self, request: Request) -> Completion:
        """Return the next answer.

        Raises:
            LLMError: If no answer is left.
        """
        with self._lock:
            self.requests.append(request)
            answer = self._next(request.prompt.purpose)
        return spoken(answer)

    def _next(self, purpose: str) -> Answer:
        script: Answer | Sequence[Answer] | None = self._for_all
        key = ""
        if self._by_purpose is not None:
            script, key = self._by_purpose.get(purpose), purpose
        if isinstance(script, (str, Mapping, BaseModel, BaseException)):
            return script
        number = self._given.get(key, 0)
        if script is None or number >= len(script):
            raise LLMError(
                f"{self.name} has no answer number {number + 1} to {purpose!r}", model=self.name
            )
        self._given[key] = number + 1
        return script[number]


class FunctionLLM(Brief):
    """Answers with the result of a function of the request.

    Args:
        function: Called with the request, possibly from several threads; returns text, a mapping, a
            pydantic model or a `Completion`, or raises.
        name: The model's name in reports.
    """

    _repr_fields = ("name",)

    def __init__(
        self, function: Callable[[Request], Answer | Completion], *, name: str = "function"
    ) -> None:
        self.name = name
        self._function = function

    def complete(self, request: Request) -> Completion:
        """Return the function's answer."""
        answer = self._function(request)
        return answer if isinstance(answer, Completion) else spoken(answer)


def spoken(answer: Answer) -> Completion:
    """Turn a prepared answer into a model's completion, or raise it."""
    if isinstance(answer, BaseException):
        raise answer
    if isinstance(answer, str):
        return Completion(text=answer)
    if isinstance(answer, BaseModel):
        return Completion(text=answer.model_dump_json())
    return Completion(text=json.dumps(answer, ensure_ascii=False))

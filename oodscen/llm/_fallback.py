"""A second model for questions that the first does not answer."""

from oodscen._display import Brief
from oodscen.errors import EndpointDown, LLMError
from oodscen.llm._check import complete
from oodscen.protocols import LLM, Completion, Request


class FallbackLLM(Brief):
    """Asks a second model when the first gives no answer, and only the second once the first is down.

    An invalid answer is fed back to the first model as usual.

    Args:
        first: The preferred model.
        second: The fallback model.
    """

    _repr_fields = ("_first", "_second")

    def __init__(self, first: LLM, second: LLM) -> None:
        self.name = f"{first.name}, else {second.name}"
        self._first = first
        self._second = second
        self._is_down = False

    def complete(self, request: Request) -> Completion:
        """Return the first model's answer, or else the second's.

        Raises:
            LLMError: When neither model answers.
            RunStopped: When a cap is reached, or both endpoints are given up.
        """
        if not self._is_down:
            try:
                return _asked(self._first, request)
            except EndpointDown:
                self._is_down = True
            except LLMError:
                pass
        return _asked(self._second, request)


def _asked(llm: LLM, request: Request) -> Completion:
    """Return the answer of a model, with its name."""
    completion = complete(llm, request)
    return completion.model_copy(update={"answered_by": completion.answered_by or llm.name})

"""The circuit breaker: a model that is given up fails its own items and does not end the run."""

from oodscen.errors import EndpointDown, ModelSkipped
from oodscen.llm._wrapper import WrappingLLM
from oodscen.protocols import Completion, Request


class CircuitBreakerLLM(WrappingLLM):
    """Fails the question instead of the run when the wrapped model is given up.

    Args:
        llm: The wrapped model.
    """

    def complete(self, request: Request) -> Completion:
        """Pass the request on.

        Raises:
            ModelSkipped: When the model is given up.
            LLMError: When the model gives no answer.
            BudgetExceeded: When a cap is reached.
        """
        try:
            return self._llm.complete(request)
        except EndpointDown as error:
            raise ModelSkipped(
                f"{error.endpoint} is given up: {error.reason}", model=self.name
            ) from error

"""The circuit breaker: a model that is given up fails its own items and does not end the run."""

from oodscen.errors import EndpointDown, LLMError, ModelSkipped
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
            ModelSkipped: When the model was given up before the question was sent.
            LLMError: When the model gives no answer, or is given up meanwhile.
            BudgetExceeded: When a cap is reached.
        """
        try:
            return self._llm.complete(request)
        except EndpointDown as error:
            message = f"{error.endpoint} is given up: {error.reason}"
            if error.requests:
                raise LLMError(
                    message, model=self.name, retryable=True, requests=error.requests
                ) from error
            raise ModelSkipped(message, model=self.name) from error

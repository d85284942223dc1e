"""A model that is given up costs the items that need it, and does not end the run."""

from oodscen.errors import EndpointDown, NotAskedError
from oodscen.llm._wrapper import Wrapper
from oodscen.protocols import Completion, Request


class ContainedLLM(Wrapper):
    """Fails the question instead of the run where another model is given up.

    Args:
        llm: Who answers; its other attributes are reachable through this object.
    """

    def complete(self, request: Request) -> Completion:
        """Pass the request on.

        Raises:
            NotAskedError: When the model is given up.
            LLMError: When it gives no answer.
            BudgetExceeded: When a cap is reached.
        """
        try:
            return self._llm.complete(request)
        except EndpointDown as error:
            raise NotAskedError(
                f"{error.endpoint} is given up: {error.reason}", model=self.name
            ) from error

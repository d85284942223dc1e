"""Caps for models that are not called through litellm."""

from oodscen._members import optional
from oodscen.errors import UsageError
from oodscen.llm._check import complete
from oodscen.llm._remote.budget import Price, check_price
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.usage import charge, estimate_tokens
from oodscen.llm._wrapper import WrappingLLM
from oodscen.protocols import LLM, Completion, Request, Usage


class CappedLLM(WrappingLLM):
    """Holds another model to the caps of a run; a call counts as one request, or as many as it reports.

    Args:
        llm: The wrapped model.
        limits: The caps, and the limit on concurrent calls.
        label: The name by which the run knows the model, e.g. `module:attr`; a price may be given for it too.

    Raises:
        UsageError: When the cost is capped, and no price is given for the model, or the one that it states is
            malformed.
    """

    def __init__(self, llm: LLM, limits: Limits, label: str = "") -> None:
        super().__init__(llm)
        self.limits = limits
        self._price = limits.prices.get(llm.name) or limits.prices.get(label)
        if self._price is None:
            self._price = _stated_price(llm, is_needed=limits.budget.caps.cost_usd is not None)
        self._endpoint = limits.endpoint(f"model {llm.name}")
        self._dearest_usd = 0.0
        """Cost of the dearest call so far, which may be above the price if the model states costs."""

    def complete(self, request: Request) -> Completion:
        """Pass the request on if the caps allow it.

        Raises:
            BudgetExceeded: When they do not.
        """
        budget = self.limits.budget
        estimate = Usage(input_tokens=estimate_tokens(request), output_tokens=budget.answer_tokens)
        most = charge(Usage(), request, "", estimate, self._price).spent
        most = most._replace(cost_usd=max(most.cost_usd, self._dearest_usd))
        self.limits.check()
        with self._endpoint.slot():
            budget.reserve(most)
            used, answer_tokens = most, 0
            try:
                completion = complete(self._llm, request)
                answer = completion.text or completion.instead or ""
                usage, used = charge(completion.usage, request, answer, estimate, self._price)
                used = used._replace(requests=max(1, completion.requests))
                answer_tokens = usage.output_tokens
                self._dearest_usd = max(self._dearest_usd, used.cost_usd)
                return completion.model_copy(update={"usage": usage})
            except BaseException as error:
                used = most._replace(requests=max(1, getattr(error, "requests", 0)))
                vars(error)["requests"] = used.requests
                raise
            finally:
                budget.settle(most, used, answer_tokens)


def _stated_price(llm: LLM, *, is_needed: bool) -> Price | None:
    """Return the price that a model states, which may be anything; without one, a capped cost is refused."""
    stated, name = optional(llm, "price", None), llm.name
    fault = f"the price of {name!r} is not known"
    if stated is not None:
        try:
            return check_price(name, stated)
        except UsageError as error:
            fault = f"the price that {name!r} states is malformed: {error}"
    if not is_needed:
        return None
    raise UsageError(
        f"the cost of the run is capped and {fault}; give it in USD per million tokens of input and output, "
        f"e.g. --price {name}=0.5,1.5 (0,0 if it is free)"
    )

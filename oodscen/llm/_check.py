"""The contract of `LLM.complete`, checked at the boundary."""

from oodscen._members import conforming, described, working
from oodscen.errors import LLMError
from oodscen.protocols import LLM, Completion, Request


def complete(llm: LLM, request: Request) -> Completion:
    """Ask a model and check that it returns a completion.

    Raises:
        UsageError: When the object is not a model.
        LLMError: When the model fails or breaks its contract.
    """
    name = conforming("llm", llm).name
    with working("llm", name):
        completion = llm.complete(request)
    if not isinstance(completion, Completion):
        fault = f"{name} must return a Completion; its answer is {described(completion)}"
        raise LLMError(fault, model=name)
    # The constructor refuses it, but `model_construct` and `model_copy` do not.
    if not isinstance(completion.text, str):
        fault = f"{name} returned a Completion whose text is {described(completion.text)}"
        raise LLMError(fault, model=name)
    return completion

"""The contract of `LLM.complete`, checked at the boundary."""

from oodscen._members import conforming, described, working
from oodscen._words.redaction import redact_keys, redact_start
from oodscen.errors import LLMError
from oodscen.llm._reading import MAX_ANSWER
from oodscen.protocols import LLM, Completion, Request


def complete(llm: LLM, request: Request) -> Completion:
    """Ask a model and check that it returns a completion, which is `shortened`.

    Raises:
        UsageError: When the object is not a model.
        LLMError: When the model fails or breaks its contract.
    """
    name = conforming("llm", llm).name
    try:
        with working("llm", name):
            completion = llm.complete(request)
    except LLMError as error:
        if len(told := str(error)) > MAX_ANSWER:
            error.args = (redact_start(told, MAX_ANSWER),)
        raise
    if not isinstance(completion, Completion):
        fault = f"{name} must return a Completion; its answer is {described(completion)}"
        raise LLMError(fault, model=name)
    # The constructor refuses it, but `model_construct` and `model_copy` do not.
    if not isinstance(completion.text, str):
        fault = f"{name} returned a Completion whose text is {described(completion.text)}"
        raise LLMError(fault, model=name)
    return shortened(completion)


def shortened(completion: Completion) -> Completion:
    """Return a completion without the part of its text that is never read; the rest counts as cut off, and says so."""
    length = len(completion.text)
    if length <= MAX_ANSWER:
        return completion
    note = f" [cut off: {length:,} characters]"
    start = redact_start(completion.text, MAX_ANSWER - len(note), redacted=redact_keys)
    return completion.model_copy(update={"text": start + note, "is_cut_off": True})

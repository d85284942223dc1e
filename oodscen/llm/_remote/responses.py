"""Reads what litellm returns for a response: its text, and what it used."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from oodscen._words.redaction import redact_keys
from oodscen.llm._check import shortened
from oodscen.llm._remote.budget import Price, Spent
from oodscen.llm._remote.failures import Filtered, NoAnswer
from oodscen.llm._remote.usage import Charge, charge, count, plausible_usage
from oodscen.protocols import Completion, InsteadOfText, Request, Usage

_CUT_OFF = frozenset(
    "length max_tokens max_output_tokens model_length error abort aborted cancelled canceled timeout".split()
)
"""Servers' own words for an answer that did not come to its end."""


@dataclass(frozen=True)
class ResponseReader:
    """Reads the responses of one model."""

    sdk: ModuleType
    """litellm."""
    model: str
    """The model's name as litellm spells it."""
    price: Price | None
    is_own_price: bool
    """True if the price is the caller's, which goes before litellm's."""

    def completion(
        self, response: Any, request: Request, estimate: Usage
    ) -> tuple[Completion, Spent]:
        """Return the completion in a response, and what it counts as under the caps.

        Raises:
            NoAnswer: If it holds none.
            Filtered: If a filter withheld it.
        """
        if not response.choices:
            raise NoAnswer("the response holds no answer: its list of choices is empty")
        choice = response.choices[0]
        ending = getattr(choice, "finish_reason", "")
        # litellm takes an ending that it does not know for "stop", and keeps what OpenAI's fields lack apart.
        native_ending = _native_fields(choice).get("native_finish_reason")
        refusal = _native_fields(choice.message).get("refusal")
        text = choice.message.content or (refusal if isinstance(refusal, str) else "")
        instead = None if text.strip() else _in_place_of_text(choice.message)
        charged = self._charge(response, request, text or instead or "", estimate)
        if ending == "content_filter":
            raise Filtered("the answer was withheld or cut", charged)
        completion = shortened(
            Completion(
                text=text.encode("utf-8", "replace").decode(),
                usage=charged.usage,
                is_cut_off=ending == "length" or str(native_ending).casefold() in _CUT_OFF,
                instead=instead,
            )
        )
        text = redact_keys(completion.text)
        return completion.model_copy(update={"text": text}), charged.spent

    def _charge(self, response: Any, request: Request, text: str, estimate: Usage) -> Charge:
        """Return the usage that a response states, and its cost."""
        stated = getattr(response, "usage", None)
        details = getattr(stated, "prompt_tokens_details", None)
        usage = Usage(
            input_tokens=count(getattr(stated, "prompt_tokens", None)),
            output_tokens=count(getattr(stated, "completion_tokens", None)),
            cached_tokens=count(getattr(details, "cached_tokens", None)),
        )
        known = plausible_usage(usage, request)
        # litellm takes tokens that are not stated for none.
        if known.input_tokens and known.output_tokens and not self.is_own_price:
            # Not validated: litellm's cost may be any number.
            usage = usage.model_copy(update={"cost_usd": self._known_cost(response)})
        return charge(usage, request, text, estimate, self.price)

    def _known_cost(self, response: Any) -> float | None:
        """Return the cost that litellm knows, with the discount on cached tokens."""
        try:
            return float(self.sdk.completion_cost(completion_response=response, model=self.model))
        # litellm raises a bare Exception for a model without a price.
        except Exception:
            return None


def _in_place_of_text(message: Any) -> InsteadOfText | None:
    if getattr(message, "tool_calls", None) or getattr(message, "function_call", None):
        return "a tool call"
    return "reasoning" if getattr(message, "reasoning_content", None) else None


def _native_fields(part: Any) -> Mapping[str, Any]:
    """Return the fields of a response's part that litellm keeps as its server wrote them."""
    fields = getattr(part, "provider_specific_fields", None)
    return fields if isinstance(fields, Mapping) else {}

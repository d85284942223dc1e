"""Any language model that litellm reaches: hosted, local, or behind an OpenAI-compatible address."""

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, NoReturn
from urllib.parse import urlsplit

from oodscen._arguments import instance_of
from oodscen._display import Brief
from oodscen._io.files import MAX_BYTES
from oodscen._numbers import finite_number, seed_number, whole_number
from oodscen._seeding import stream
from oodscen._words.redaction import hide, redact, secrets_in, secrets_of
from oodscen.errors import ContentFiltered, LLMError, LLMTimeout, ResponseError, UsageError
from oodscen.llm._remote.budget import Price, Spent
from oodscen.llm._remote.call_bounds import CallBounds, apply_bounds
from oodscen.llm._remote.failures import FailedAttempt, Filtered, diagnose
from oodscen.llm._remote.limits import LONGEST_S, Limits, check_seconds
from oodscen.llm._remote.offline import SWITCH, is_loopback, is_offline
from oodscen.llm._remote.responses import ResponseReader
from oodscen.llm._remote.sdk import (
    JsonAbility,
    credential_settings,
    json_ability,
    known_price,
    load_litellm,
    resolve_model,
)
from oodscen.llm._remote.usage import charge, estimate_tokens
from oodscen.llm._remote.wire import provider_seed, wire_message
from oodscen.protocols import Completion, Request, Usage

NO_KEY = "none"
"""The key sent to a custom address if no key is set; such servers seldom require one."""

ALONE = 1_000
"""Concurrent requests of a model outside a run: as many as its caller has threads."""

LOOKUP_S = 10.0
"""Time limit of litellm's queries about a model's abilities, in seconds."""

LATE_RETRIES = 1
"""Retries after a timeout; a call that hangs once usually hangs again."""

_OWN = frozenset(
    "api_base base_url drop_params max_retries max_tokens messages model num_retries seed stream temperature timeout".split()
)
"""Arguments of `litellm.completion` that are not left to the caller's options."""


class LiteLLM(Brief):
    """A model by its litellm name: `gpt-4o`, `anthropic/claude-...`, `gemini/...`, `ollama/llama3`.

    litellm reads keys from the environment (`OPENAI_API_KEY`, `ANTHROPIC_API_KEY` ...); they are never stored
    here and are removed from every error.

    The answer's JSON schema is sent natively if litellm knows that the model accepts one, and JSON mode is
    requested if the provider has it; if a server refuses either, the request is sent without. The templates
    state the format in any case. If the provider takes seeds, each call has its own `provider_seed`: `(seed *
    1_000_003 + sample) % 2**31` for the question itself.

    Rate limits, timeouts, lost connections, server errors and unusable responses (an empty body, a web page,
    too large) are retried here and nowhere else, after the time in the server's `Retry-After`, or 1, 2, 4 ...
    seconds with jitter; a timeout is retried only once.

    Args:
        model: Name as litellm spells it. With `api_base`, a name without a provider known to litellm is
            assumed to be on an OpenAI-compatible server.
        api_base: Address of the server, e.g. `http://localhost:8000/v1`.
        seed: Seed of the run.
        timeout_s: Longest time for one attempt, from its start to the last byte; the limits's if left out.
        temperature: Sampling temperature; `None` leaves it to the provider.
        max_tokens: Longest answer; `None` leaves it to the provider.
        retries: Maximum number of retries.
        max_wait_s: Longest wait before a retry; a call is given up at once if the server asks for more.
        max_bytes: Largest response.
        limits: Caps, prices and endpoints, shared by the models of a run. Without it nothing is capped and
            no endpoint is given up.
        options: Further arguments of `litellm.completion`, e.g. `{"reasoning_effort": "low"}`, but none that is set here.
        sleep: Waits the given seconds; by default it returns early if the run is interrupted.

    Raises:
        MissingExtra: When litellm is not installed.
        UnknownComponent: When litellm knows neither model nor provider, with close matches.
        UsageError: When `OODSCEN_OFFLINE=1` forbids the address, or the cost is capped and the model's price
            is not known, or a number is out of its range, or `options` holds what is set here.
    """

    _repr_fields = ("name", "_api_base", "seed")

    def __init__(
        self,
        model: str,
        *,
        api_base: str | None = None,
        seed: int = 0,
        timeout_s: float | None = None,
        temperature: float | None = None,
        max_tokens: int | None = None,
        retries: int = 5,
        max_wait_s: float = 60.0,
        max_bytes: int = 10_000_000,
        limits: Limits | None = None,
        options: Mapping[str, Any] | None = None,
        sleep: Callable[[float], None] | None = None,
    ) -> None:
        self.name = model
        self._api_base = api_base
        if options is not None:
            instance_of("options", options, Mapping)
            if taken := sorted(_OWN & options.keys()):
                raise UsageError(f"options must not hold {', '.join(taken)}, which the client sets")
        self.seed = seed_number(seed)
        self.retries = whole_number("retries", retries)
        self.max_wait_s = finite_number("max_wait_s", max_wait_s, 0.0, LONGEST_S)
        self.max_bytes = whole_number("max_bytes", max_bytes, 1, MAX_BYTES)
        if temperature is not None:
            finite_number("temperature", temperature, 0.0)
        if max_tokens is not None:
            whole_number("max_tokens", max_tokens, 1, 1_000_000_000)
        self.limits = limits or Limits(concurrency=ALONE, patience_s=None)
        self.timeout_s = (
            self.limits.timeout_s if timeout_s is None else check_seconds("timeout_s", timeout_s)
        )
        self._sleep = sleep or self.limits.sleep
        self._sdk = sdk = load_litellm()
        if api_base is not None:
            _check_address(api_base)
        hide(
            [
                *secrets_in({**credential_settings(sdk), **(options or {})}),
                *secrets_of(api_base or ""),
            ]
        )
        # litellm asks some models' servers what they can do.
        with apply_bounds(CallBounds(LOOKUP_S, max_bytes)):
            self._model, provider, address = resolve_model(sdk, model, api_base)
            _check_offline(model, api_base, address)
            self.price = self.limits.prices.get(model) or known_price(sdk, self._model)
            """`None` where it is not known."""
        _check_priced(model, self.price, self.limits)
        self._reader = ResponseReader(
            sdk, self._model, self.price, is_own_price=model in self.limits.prices
        )
        self._endpoint = self.limits.endpoint(redact(api_base) if api_base else provider)
        self._without_format: set[str] = set()
        """Purposes of the questions whose answer format the server refuses."""
        self._arguments: dict[str, Any] = {
            "model": self._model,
            "timeout": self.timeout_s,
            "temperature": temperature,
            "max_tokens": max_tokens,
            "max_retries": 0,
            "num_retries": 0,
            "drop_params": True,
            **(options or {}),
        }
        if api_base is not None:
            self._arguments["api_base"] = api_base
            if provider == "openai" and not os.environ.get("OPENAI_API_KEY"):
                self._arguments.setdefault("api_key", NO_KEY)

    def complete(self, request: Request) -> Completion:
        """Ask the model, with retries after transient failures.

        Raises:
            LLMError: When there is no answer; `retryable` if a later attempt may succeed.
            RunStopped: When a cap is reached or the endpoint is given up.
        """
        sent: list[CallBounds] = []
        try:
            return self._answer(request, sent)
        except BaseException as error:
            # Whatever ends the call, an interruption as well, its requests were made.
            vars(error)["requests"] = len(sent)
            raise

    def _answer(self, request: Request, sent: list[CallBounds]) -> Completion:
        """Ask until there is an answer or no hope of one; the bounds of every request are added to `sent`."""
        arguments = {
            **self._arguments,
            "messages": [wire_message(message, self.name) for message in request.messages],
            "seed": provider_seed(self.seed, request.sample, request.attempt, request.repeat),
        }
        estimate = self._estimate(request)
        purpose = request.prompt.purpose
        response_format = self._response_format(request)
        is_refused = False
        retries = 0
        if pause := self._endpoint.pause(self.max_wait_s):
            self._sleep(pause)
        while True:
            form = {} if response_format is None else {"response_format": response_format}
            outcome = self._try({**arguments, **form}, request, estimate, sent)
            if isinstance(outcome, Completion):
                if is_refused:
                    self._without_format.add(purpose)
                return outcome.model_copy(update={"requests": len(sent)})
            if response_format is not None and outcome.may_refuse_format:
                response_format, is_refused = None, True
                continue
            wait_s = self._wait(outcome, retries, request)
            if wait_s is None:
                self._give_up(outcome)
            retries += 1
            self._sleep(wait_s)

    def _give_up(self, failure: FailedAttempt) -> NoReturn:
        """Raise the error of a call that will not be retried."""
        failure = self._explained(failure)
        self._endpoint.note_failed_call(failure, self.name)
        self._endpoint.check(self.name)
        raise self._error(failure)

    def _try(
        self, arguments: dict[str, Any], request: Request, estimate: Usage, sent: list[CallBounds]
    ) -> Completion | FailedAttempt:
        most = charge(Usage(), request, "", estimate, self.price).spent
        self.limits.check()
        with self._endpoint.slot(self.name) as begun:
            self.limits.check()
            self.limits.budget.reserve(most)
            used, answer_tokens = most, 0
            bounds = CallBounds(
                self.timeout_s,
                self.max_bytes,
                silence_s=self._endpoint.silence_s,
                is_alive=lambda url, seconds: self._endpoint.is_alive(url, _responds, seconds),
                is_closed=self.limits.is_over,
            )
            sent.append(bounds)
            try:
                with apply_bounds(bounds):
                    response = self._sdk.completion(**arguments)
                completion, used = self._reader.completion(response, request, estimate)
                answer_tokens = completion.usage.output_tokens
            # Servers send anything, and litellm passes on whatever its parsing of it raised.
            except Exception as error:
                failure = diagnose(self.name, error, bounds)
                used = Spent(1) if failure.is_free else most
                if isinstance(error, Filtered):
                    failure = replace(failure, usage=error.charge.usage)
                    used = error.charge.spent
            else:
                self._endpoint.note_answer(self.name)
                return completion
            finally:
                self.limits.budget.settle(most, used, answer_tokens)
        self.limits.check()
        if failure.kind == "late" and not self._is_there(bounds):
            failure = replace(failure, kind="unreachable")
        self._endpoint.note_failed_attempt(failure, begun, self.name)
        self._endpoint.check(self.name)
        return failure

    def _is_there(self, bounds: CallBounds) -> bool:
        """Return whether a server whose answer is late responds to anything."""
        if not bounds.is_sent or bounds.status is not None:
            return True
        return self._endpoint.is_alive(bounds.url, _responds)

    def _explained(self, failure: FailedAttempt) -> FailedAttempt:
        """Add to a failure that the server asked for too long a wait."""
        wait_s = failure.retry_after
        if not failure.retryable or wait_s is None or wait_s <= self.max_wait_s:
            return failure
        asked = f"{round(wait_s, 0):.12g} s"
        reason = f"the server asked to wait {asked}, more than max_wait_s {self.max_wait_s:g}"
        return replace(failure, message=f"{failure.message}; {reason}")

    def _error(self, failure: FailedAttempt) -> LLMError:
        if failure.kind == "filtered":
            return ContentFiltered(failure.message, model=self.name, usage=failure.usage)
        if failure.kind == "late":
            return LLMTimeout(failure.message, model=self.name, retryable=True)
        if failure.is_unusable:
            return ResponseError(
                failure.message, model=self.name, status=failure.status, raw=failure.raw
            )
        return LLMError(failure.message, model=self.name, retryable=failure.retryable)

    def _estimate(self, request: Request) -> Usage:
        """Return the tokens that one attempt may use."""
        output_tokens = self._arguments["max_tokens"] or self.limits.budget.answer_tokens
        return Usage(input_tokens=estimate_tokens(request), output_tokens=output_tokens)

    def _response_format(self, request: Request) -> dict[str, Any] | None:
        """Return the answer format to ask for; `None` if the model has none or has refused it."""
        if request.prompt.purpose in self._without_format:
            return None
        if self._json_ability == "schema":
            name = request.prompt.purpose.replace("-", "_")
            return {"type": "json_schema", "json_schema": {"name": name, "schema": request.schema}}
        return {"type": "json_object"} if self._json_ability == "mode" else None

    @cached_property
    def _json_ability(self) -> JsonAbility | None:
        """The answer formats that litellm says the model has; it asks some models' servers."""
        with apply_bounds(CallBounds(LOOKUP_S, self.max_bytes)):
            return json_ability(self._sdk, self._model)

    def _wait(self, failure: FailedAttempt, retries: int, request: Request) -> float | None:
        """Return the seconds to wait before the next attempt, or `None` to give up."""
        most = min(self.retries, LATE_RETRIES) if failure.kind == "late" else self.retries
        if not failure.retryable or retries >= most or self._endpoint.is_doubted(self.name):
            return None
        if failure.retry_after is not None:
            # An earlier retry would be refused again, and count against the caller.
            return failure.retry_after if failure.retry_after <= self.max_wait_s else None
        keys = ("retry", request.prompt.purpose, request.sample, request.attempt, retries)
        jitter = float(stream(self.seed, *keys).uniform(0.5, 1.0))
        return min(1 << retries, self.max_wait_s) * jitter


def _check_priced(model: str, price: Price | None, limits: Limits) -> None:
    """Refuse a model without a price if the cost is capped."""
    if limits.budget.caps.cost_usd is not None and price is None:
        raise UsageError(
            f"the cost of the run is capped and the price of {model!r} is not known; give it in USD per "
            f"million tokens of input and output, e.g. --price {model}=0.5,1.5 (0,0 for a model of "
            "your own), or cap requests or tokens instead"
        )


def _responds(url: str, timeout_s: float) -> bool:
    from oodscen.llm._remote.transport import responds

    return responds(url, timeout_s)


def _check_address(api_base: str) -> None:
    """Refuse an address that no request can be sent to."""
    api_base, mark, _ = api_base.partition("#")
    try:
        parts = urlsplit(api_base)
        is_sound = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
        is_sound &= not mark and not re.search(r"[\s\\]", api_base)
    except ValueError:
        is_sound = False
    if not is_sound:
        raise UsageError(
            f"{redact(api_base)!r:.200} is not the address of a server; write it as http://HOST:PORT/v1"
        )


def _check_offline(model: str, api_base: str | None, address: str | None) -> None:
    """Refuse an address outside this machine if the environment forbids the network."""
    if not is_offline() or is_loopback(address):
        return
    server = redact(api_base) if api_base else "its provider"
    raise UsageError(
        f"{SWITCH} is set, and {model!r} would be asked at {server}; only addresses on this "
        f"machine are allowed (127.0.0.1, localhost), or unset {SWITCH}"
    )

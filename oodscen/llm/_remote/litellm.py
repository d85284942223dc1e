"""Any language model that litellm reaches: hosted, local, or behind an OpenAI-compatible address."""

import base64
import logging
import os
import re
import threading
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from types import ModuleType
from typing import Any
from urllib.parse import urlsplit

from oodscen._display import Brief
from oodscen._files import MAX_BYTES
from oodscen._members import reason
from oodscen._numbers import finite_number, seed_number, whole_number
from oodscen._redaction import hide, redact, redact_keys, secrets_in, secrets_of
from oodscen._seeding import stream
from oodscen._text import plain
from oodscen.data._messages import Image, Message
from oodscen.errors import (
    ContentFiltered,
    LLMError,
    LLMTimeout,
    MissingExtra,
    ResponseError,
    UnknownComponent,
    UsageError,
)
from oodscen.llm._remote.budget import Price, Spent
from oodscen.llm._remote.call_bounds import CallBounds, active, apply_bounds
from oodscen.llm._remote.failures import FailedAttempt, Filtered, NoAnswer, diagnose
from oodscen.llm._remote.limits import LONGEST_S, Limits, check_seconds
from oodscen.llm._remote.offline import SWITCH, enforce, is_loopback, is_offline
from oodscen.llm._remote.usage import count, estimate_tokens, plausible_usage
from oodscen.protocols import Completion, Request, Usage

NO_KEY = "none"
"""The key sent to a custom address if no key is set; such servers seldom require one."""

ALONE = 1_000
"""Concurrent requests of a model outside a run: as many as its caller has threads."""

LOOKUP_S = 10.0
"""Time limit of litellm's queries about a model's abilities, in seconds."""

LATE_RETRIES = 1
"""Retries after a timeout; a call that hangs once usually hangs again."""

_LOGGERS = ("LiteLLM", "LiteLLM Router", "LiteLLM Proxy")
_import_lock = threading.Lock()


class LiteLLM(Brief):
    """A model by its litellm name: `gpt-4o`, `anthropic/claude-...`, `gemini/...`, `ollama/llama3`.

    litellm reads keys from the environment (`OPENAI_API_KEY`, `ANTHROPIC_API_KEY` ...); they are never stored
    here and are removed from every error.

    The answer's JSON schema is sent natively if litellm knows that the model accepts one, and JSON mode is
    requested if the provider has it; if a server refuses either, the request is sent without. The templates
    state the format in any case. If the provider takes seeds, each call has its own `provider_seed`: `(seed *
    1_000_003 + sample) % 2**31` for the question itself.

    Rate limits, timeouts, lost connections, server errors and unusable responses (empty, a web page, too
    large) are retried here and nowhere else, after the time in the server's `Retry-After`, or 1, 2, 4 ...
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
        options: Further arguments of `litellm.completion`, e.g. `{"reasoning_effort": "low"}`.
        sleep: Waits the given seconds; by default it returns early if the run is interrupted.

    Raises:
        MissingExtra: When litellm is not installed.
        UnknownComponent: When litellm knows neither model nor provider, with close matches.
        UsageError: When `OODSCEN_OFFLINE=1` forbids the address, or the cost is capped and the model's price
            is not known, or a number is out of its range.
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
        hide([*secrets_in({**_own_settings(sdk), **(options or {})}), *secrets_of(api_base or "")])
        # litellm asks some models' servers what they can do.
        with apply_bounds(CallBounds(LOOKUP_S, max_bytes)):
            self._model, provider, address = _resolve(sdk, model, api_base)
            _permit(model, api_base, address)
            self.price = self.limits.prices.get(model) or known_price(sdk, self._model)
            """`None` where it is not known."""
        _afford(model, self.price, self.limits)
        self._endpoint = self.limits.endpoint(redact(api_base) if api_base else provider)
        self._refused: set[str] = set()
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
        arguments = {
            **self._arguments,
            "messages": [wire_message(message, self.name) for message in request.messages],
            "seed": provider_seed(self.seed, request.sample, request.attempt),
        }
        most = self._most(request)
        purpose = request.prompt.purpose
        form = None if purpose in self._refused else self._response_format(request)
        refused = False
        tries = requests = 0
        if pause := self._endpoint.pause():
            self._sleep(min(pause, self.max_wait_s))
        while True:
            sent = {**arguments, "response_format": form} if form else arguments
            outcome = self._try(sent, request, most)
            requests += 1
            if isinstance(outcome, Completion):
                if refused:
                    self._refused.add(purpose)
                return outcome.model_copy(update={"requests": requests})
            if form and outcome.may_refuse_form:
                form, refused = None, True
                continue
            wait = self._wait(outcome, tries, request)
            if wait is None:
                outcome = self._explained(outcome)
                self._endpoint.given_up(outcome, self.name)
                self._endpoint.check(self.name)
                raise self._error(outcome, requests)
            tries += 1
            self._sleep(wait)

    def _try(
        self, arguments: dict[str, Any], request: Request, most: Spent
    ) -> Completion | FailedAttempt:
        self.limits.check()
        with self._endpoint.slot(self.name) as begun:
            self.limits.check()
            self.limits.budget.reserve(most)
            used, answered = most, 0
            bounds = CallBounds(
                self.timeout_s,
                self.max_bytes,
                silence_s=self._endpoint.silence_s,
                is_alive=lambda url, seconds: self._endpoint.is_alive(url, _responds, seconds),
                is_closed=self.limits.is_over,
            )
            try:
                with apply_bounds(bounds):
                    response = self._sdk.completion(**arguments)
                completion = self._completion(response, request)
                answered = completion.usage.output_tokens
                used = self._used(completion.usage, most)
            # Servers send anything, and litellm passes on whatever its parsing of it raised.
            except Exception as error:
                failure = diagnose(self.name, error, bounds)
                used = Spent(1) if failure.is_free else most
            else:
                self._endpoint.succeeded(self.name)
                return completion
            finally:
                self.limits.budget.settle(most, used, answered)
        self.limits.check()
        if failure.kind == "late" and not self._is_there(bounds):
            failure = replace(failure, kind="unreachable")
        self._endpoint.failed(failure, begun, self.name)
        self._endpoint.check(self.name)
        return failure

    def _is_there(self, bounds: CallBounds) -> bool:
        """Return whether a server whose answer is late responds to anything."""
        if not bounds.is_sent or bounds.status is not None:
            return True
        return self._endpoint.is_alive(bounds.url, _responds)

    def _explained(self, failure: FailedAttempt) -> FailedAttempt:
        """Add to a failure that the server asked for too long a wait."""
        asked = failure.retry_after
        if not failure.retryable or asked is None or asked <= self.max_wait_s:
            return failure
        said = f"; the server asked to wait {asked:.0f} s, more than max_wait_s {self.max_wait_s:g}"
        return replace(failure, message=f"{failure.message}{said}")

    def _error(self, failure: FailedAttempt, requests: int) -> LLMError:
        if failure.kind == "filtered":
            return ContentFiltered(failure.message, model=self.name, requests=requests)
        if failure.kind == "late":
            return LLMTimeout(failure.message, model=self.name, retryable=True, requests=requests)
        if failure.is_unusable:
            return ResponseError(
                failure.message,
                model=self.name,
                status=failure.status,
                raw=failure.raw,
                requests=requests,
            )
        return LLMError(
            failure.message, model=self.name, retryable=failure.retryable, requests=requests
        )

    def _most(self, request: Request) -> Spent:
        """Return the maximum cost of one attempt."""
        asked = estimate_tokens(request)
        answered = self._arguments.get("max_tokens") or self.limits.budget.answer_tokens
        cost = self.price.of(asked, answered) if self.price else 0.0
        return Spent(1, asked + answered, cost)

    def _used(self, usage: Usage, most: Spent) -> Spent:
        tokens = usage.input_tokens + usage.output_tokens
        if not tokens:
            return most
        cost = usage.cost_usd
        if cost is None and self.price is not None:
            cost = self.price.of(usage.input_tokens, usage.output_tokens)
        return Spent(1, tokens, cost or 0.0)

    def _completion(self, response: Any, request: Request) -> Completion:
        if not response.choices:
            raise NoAnswer("the response holds no answer: its list of choices is empty")
        choice = response.choices[0]
        if getattr(choice, "finish_reason", "") == "content_filter":
            raise Filtered("the answer was withheld or cut")
        text = choice.message.content or getattr(choice.message, "refusal", None) or ""
        said = getattr(response, "usage", None)
        details = getattr(said, "prompt_tokens_details", None)
        usage = Usage(
            input_tokens=count(getattr(said, "prompt_tokens", None)),
            output_tokens=count(getattr(said, "completion_tokens", None)),
            cached_tokens=count(getattr(details, "cached_tokens", None)),
        )
        cost = self._cost(response, usage.input_tokens, usage.output_tokens)
        return Completion(
            text=redact_keys(text.encode("utf-8", "replace").decode()),
            usage=plausible_usage(usage.model_copy(update={"cost_usd": cost}), request),
        )

    def _cost(self, response: Any, asked: int, answered: int) -> float | None:
        if (given := self.limits.prices.get(self.name)) is not None:
            return given.of(asked, answered)
        try:
            return float(self._sdk.completion_cost(completion_response=response, model=self._model))
        # litellm raises a bare Exception for a model without a price.
        except Exception:
            return None

    def _response_format(self, request: Request) -> dict[str, Any] | None:
        if self._ability == "schema":
            name = request.prompt.purpose.replace("-", "_")
            return {"type": "json_schema", "json_schema": {"name": name, "schema": request.schema}}
        return {"type": "json_object"} if self._ability == "mode" else None

    @cached_property
    def _ability(self) -> str:
        """The answer formats that litellm says the model has; it asks some models' servers."""
        with apply_bounds(CallBounds(LOOKUP_S, self.max_bytes)):
            return _json_ability(self._sdk, self._model)

    def _wait(self, failure: FailedAttempt, tries: int, request: Request) -> float | None:
        """Return the seconds to wait before the next attempt, or `None` to give up."""
        most = min(self.retries, LATE_RETRIES) if failure.kind == "late" else self.retries
        most = 0 if self._endpoint.is_doubted(self.name) else most
        if not failure.retryable or tries >= most:
            return None
        if failure.retry_after is not None:
            # An earlier retry would be refused again, and count against the caller.
            return failure.retry_after if failure.retry_after <= self.max_wait_s else None
        keys = ("retry", request.prompt.purpose, request.sample, request.attempt, tries)
        jitter = float(stream(self.seed, *keys).uniform(0.5, 1.0))
        return min(float(2**tries), self.max_wait_s) * jitter


def load_litellm() -> ModuleType:
    """Import litellm without output and without its download of a price list.

    Raises:
        MissingExtra: When litellm is not installed.
        UsageError: When litellm is installed but cannot be loaded.
    """
    enforce()
    with _import_lock:
        os.environ.setdefault("LITELLM_LOCAL_MODEL_COST_MAP", "True")
        # litellm's type definitions make pydantic warn, some of them only on first use; so do
        # responses whose fields have other types than the API's.
        for message in (r".*ReadOnly. qualifier", "Pydantic serializer warnings"):
            warnings.filterwarnings(
                "ignore", message=message, category=UserWarning, module=r"pydantic\."
            )
        _check_environment()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                import litellm

                litellm.ModelResponse()
                from litellm.llms.custom_httpx import http_handler
                from litellm.llms.openai import common_utils

                from oodscen.llm._remote.transport import guard, install
        except ImportError:
            raise MissingExtra("language models through litellm", "llm", "litellm") from None
        except Exception as error:
            needs = "; it needs a temporary folder that it can write, such as TMPDIR may name"
            more = needs if isinstance(error, OSError) else ""
            raise UsageError(f"litellm cannot be loaded: {reason(error)}{more}") from None
        litellm.suppress_debug_info = True
        litellm.telemetry = False
        for name in _LOGGERS:
            logging.getLogger(name).addFilter(_quiet)
        install(http_handler, common_utils)
        # litellm keeps one client that it made on import.
        if (handler := getattr(litellm, "module_level_client", None)) is not None:
            guard(handler.client)
        module: ModuleType = litellm
        return module


def _check_environment() -> None:
    """Check the proxies and certificates that the environment names: litellm fails on them at any time.

    Raises:
        UsageError: If httpx cannot use them.
    """
    try:
        import httpx
    except ImportError:
        return  # litellm brings it, and is missing as well.
    try:
        httpx.Client().close()
    except OSError as error:
        raise UsageError(
            f"the certificates that SSL_CERT_FILE or SSL_CERT_DIR names cannot be read: {reason(error)}"
        ) from None
    except (ImportError, ValueError, httpx.InvalidURL) as error:
        raise UsageError(
            f"a proxy that the environment names cannot be used: {reason(error)}; mend or unset HTTPS_PROXY, "
            "HTTP_PROXY, ALL_PROXY or NO_PROXY"
        ) from None


def _quiet(record: logging.LogRecord) -> bool:
    """Redact a log line of litellm; drop it during a call, whose errors say what it does, unless LITELLM_LOG is set.

    litellm quotes what a server sent, which may hold a key or steer a terminal.
    """
    record.msg, record.args = plain(redact(record.getMessage())), ()
    record.exc_info = record.exc_text = None
    return active() is None or "LITELLM_LOG" in os.environ


def known_price(sdk: ModuleType, model: str) -> Price | None:
    """Return litellm's price of a model, or `None` if it knows none."""
    try:
        asked, answered = sdk.cost_per_token(
            model=model, prompt_tokens=1_000_000, completion_tokens=1_000_000
        )
    # litellm raises a bare Exception for a model without a price.
    except Exception:
        return None
    return Price(float(asked), float(answered))


def _afford(model: str, price: Price | None, limits: Limits) -> None:
    """Refuse a model without a price if the cost is capped."""
    if limits.budget.caps.cost_usd is not None and price is None:
        raise UsageError(
            f"the cost of the run is capped and the price of {model!r} is not known; give it in USD per "
            f"million tokens of input and output, e.g. --price {model}=0.5,1.5 (0,0 for a model of "
            "your own), or cap requests or tokens instead"
        )


def provider_seed(seed: int, sample: int, attempt: int = 1) -> int:
    """Return the seed for one call to a provider: below 2**31, as some require.

    A repair has another seed than the question, since a model might otherwise repeat its fault word for word.
    """
    return (seed * 1_000_003 + sample + (attempt - 1) * 500_000_003) % 2**31


_MARKS_CACHE = re.compile(r"anthropic|claude", re.IGNORECASE)
"""Models whose providers cache a prefix only where a request marks its end."""


def wire_message(message: Message, model: str = "") -> dict[str, Any]:
    """Return a message in OpenAI's format; pictures become base64 data URLs.

    Raises:
        LLMError: When a picture cannot be read.
    """
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    if message.role == "system" and _MARKS_CACHE.search(model):
        # Other providers find repeated prefixes by themselves.
        parts[0]["cache_control"] = {"type": "ephemeral"}
    elif not message.images:
        return {"role": message.role, "content": message.text}
    for image in message.images:
        try:
            url = data_url(image)
        except OSError as error:
            reason = error.strerror or str(error)
            raise LLMError(f"cannot read the image {image.name}: {reason}", model=model) from error
        parts.append({"type": "image_url", "image_url": {"url": url}})
    return {"role": message.role, "content": parts}


def data_url(image: Image) -> str:
    """Return a picture as a data URL in its own format (JPEG or PNG)."""
    data = image.read()
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _resolve(sdk: ModuleType, model: str, api_base: str | None) -> tuple[str, str, str | None]:
    """Return the name for litellm, the provider, and the provider's address if litellm knows it."""
    providers = [str(getattr(name, "value", name)) for name in sdk.provider_list]
    head, slash, rest = model.partition("/")
    if api_base is not None:
        named = model if slash and head in providers else f"openai/{model}"
        return named, named.partition("/")[0], api_base
    try:
        _, provider, _, address = sdk.get_llm_provider(model=model)
    except sdk.exceptions.BadRequestError:
        known = {*sdk.model_cost, *providers, *(f"{name}/{rest}" for name in providers if rest)}
        raise UnknownComponent("llm", model, known) from None
    return model, provider, address


def _responds(url: str, timeout_s: float) -> bool:
    from oodscen.llm._remote.transport import responds

    return responds(url, timeout_s)


def _own_settings(sdk: Any) -> dict[str, Any]:
    """Return the settings of litellm that can hold a user's credentials."""
    found = {name: value for name, value in vars(sdk).items() if isinstance(value, str)}
    return found | {"headers": sdk.headers or {}}


def _check_address(api_base: str) -> None:
    """Refuse an address that no request can be sent to."""
    try:
        parts = urlsplit(api_base)
        is_sound = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
        is_sound &= not re.search(r"[\s\\]", api_base)
    except ValueError:
        is_sound = False
    if not is_sound:
        raise UsageError(
            f"{redact(api_base)!r:.200} is no address of a server; write it as http://HOST:PORT/v1"
        )


def _permit(model: str, api_base: str | None, address: str | None) -> None:
    """Refuse an address outside this machine if the environment forbids the network."""
    if not is_offline() or is_loopback(address):
        return
    where = redact(api_base) if api_base else "its provider"
    raise UsageError(
        f"{SWITCH} is set, and {model!r} would be asked at {where}; only addresses on this "
        f"machine are allowed (127.0.0.1, localhost), or unset {SWITCH}"
    )


def _json_ability(sdk: ModuleType, model: str) -> str:
    """Return `schema` if a model takes a JSON schema, `mode` if it has a JSON mode, else an empty string."""
    if sdk.supports_response_schema(model=model):
        return "schema"
    parameters = sdk.get_supported_openai_params(model=model) or ()
    return "mode" if "response_format" in parameters else ""

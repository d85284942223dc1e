"""Any language model that litellm reaches: hosted, local, or behind an OpenAI-compatible address."""

import base64
import os
import threading
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import ModuleType
from typing import Any

from oodscen._redaction import hide, redact, redact_keys, secrets_in, secrets_of
from oodscen._seeding import stream
from oodscen.data._messages import Image, Message
from oodscen.errors import (
    LateError,
    LLMError,
    MissingExtra,
    RefusedError,
    ResponseError,
    UnknownComponent,
    UsageError,
)
from oodscen.llm._remote.call_bounds import Bounds, bounded
from oodscen.llm._remote.failures import Failure, Filtered, diagnose
from oodscen.llm._remote.limits import Price, Spent, Traffic, check_seconds
from oodscen.llm._remote.offline import SWITCH, enforce, is_loopback, is_offline
from oodscen.llm._remote.usage import believed, count, estimate_tokens
from oodscen.protocols import Completion, Request, Usage

NO_KEY = "none"
"""Sent as the key to an own address where no key is set: such servers seldom want one."""

ALONE = 1_000
"""Requests at once of a model that is no part of a run: as many as its caller has threads."""

LOOKUP_S = 10.0
"""Longest time for what litellm asks a server about a model before anything is asked of the model itself."""

LATE_RETRIES = 1
"""Further tries after one that was not answered in time; what hangs once hangs again, as a rule."""

_import_lock = threading.Lock()


class LiteLLM:
    """A model by its litellm name: `gpt-4o`, `anthropic/claude-...`, `gemini/...`, `ollama/llama3`.

    Keys are read by litellm from the environment (`OPENAI_API_KEY`, `ANTHROPIC_API_KEY` ...); they are
    never stored here and are removed from every error.

    The answer's JSON schema is sent natively where litellm knows that the model takes one, JSON mode
    is asked for where the provider has it, and a server that refuses either is asked without;
    the templates state the format in any case. Each call is sent with a `provider_seed` of its own where
    the provider takes seeds: `(seed * 1_000_003 + sample) % 2**31` for the question itself.

    Rate limits, timeouts, lost connections, server errors and responses that are none (empty, a web
    page, too large) are retried here and nowhere else, after the time the server names in `Retry-After`, or
    1, 2, 4 ... seconds with jitter; what is not answered in time is tried once more only.

    Args:
        model: Name as litellm spells it. With `api_base`, a name without a provider litellm knows is taken to
            be served by an OpenAI-compatible server.
        api_base: Address of the server, e.g. `http://localhost:8000/v1`.
        seed: Of the run.
        timeout_s: Longest time for one try, from its beginning to the last byte; that of the traffic
            if left out.
        temperature: Sampling temperature; `None` leaves it to the provider.
        max_tokens: Longest answer; `None` leaves it to the provider.
        retries: Further tries after the first.
        max_wait_s: Longest wait before one retry; a server that asks for more is given up.
        max_bytes: Largest response.
        traffic: Caps, prices and endpoints, shared by the models of a run; alone, nothing is capped and
            no endpoint is given up.
        options: Further arguments of `litellm.completion`, e.g. `{"reasoning_effort": "low"}`.
        sleep: Waits the given seconds; until then or an interruption of the run if left out.

    Raises:
        MissingExtra: When litellm is not installed.
        UnknownComponent: When litellm knows neither model nor provider, with close matches.
        UsageError: When `OODSCEN_OFFLINE=1` forbids the address, or the cost is capped and the
            model's price is not known.
    """

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
        traffic: Traffic | None = None,
        options: Mapping[str, Any] | None = None,
        sleep: Callable[[float], None] | None = None,
    ) -> None:
        self.name = model
        self.seed = seed
        self.retries = retries
        self.max_wait_s = max_wait_s
        self.max_bytes = max_bytes
        self.traffic = traffic or Traffic(concurrency=ALONE, patience_s=None)
        self.timeout_s = (
            self.traffic.timeout_s if timeout_s is None else check_seconds("timeout_s", timeout_s)
        )
        self._sleep = sleep or self.traffic.sleep
        self._sdk = sdk = load_litellm()
        settings = {name: value for name, value in vars(sdk).items() if name.islower()}
        hide([*secrets_in({**settings, **(options or {})}), *secrets_of(api_base or "")])
        # Of some models litellm asks their server what they can do.
        with bounded(Bounds(LOOKUP_S, max_bytes)):
            self._model, provider, address = _resolve(sdk, model, api_base)
            _permit(model, api_base, address)
            self.price = self.traffic.prices.get(model) or known_price(sdk, self._model)
            """`None` where it is not known."""
            self._json = _json_ability(sdk, self._model)
        _afford(model, self.price, self.traffic)
        self._endpoint = self.traffic.endpoint(redact(api_base) if api_base else provider)
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
        """Ask the model, retrying what is worth retrying.

        Raises:
            LLMError: When there is no answer; `retryable` where another time may bring one.
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
                self._endpoint.given_up(outcome, self.name)
                self._endpoint.check(self.name)
                raise self._error(outcome, requests)
            tries += 1
            self._sleep(wait)

    def _try(
        self, arguments: dict[str, Any], request: Request, most: Spent
    ) -> Completion | Failure:
        self.traffic.check()
        with self._endpoint.slot(self.name) as begun:
            self.traffic.check()
            self.traffic.budget.reserve(most)
            used, answered = most, 0
            bounds = Bounds(
                self.timeout_s,
                self.max_bytes,
                silence_s=self._endpoint.silence_s,
                is_alive=lambda url, seconds: self._endpoint.is_alive(url, _responds, seconds),
                is_closed=self.traffic.is_over,
            )
            try:
                with bounded(bounds):
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
                self.traffic.budget.settle(most, used, answered)
        self.traffic.check()
        if failure.kind == "late" and not self._is_there(bounds):
            failure = replace(failure, kind="unreachable")
        self._endpoint.failed(failure, begun, self.name)
        self._endpoint.check(self.name)
        return failure

    def _is_there(self, bounds: Bounds) -> bool:
        """Whether a server whose answer is late responds to anything."""
        if not bounds.is_sent or bounds.status is not None:
            return True
        return self._endpoint.is_alive(bounds.url, _responds)

    def _error(self, failure: Failure, requests: int) -> LLMError:
        if failure.kind == "filtered":
            return RefusedError(failure.message, model=self.name, requests=requests)
        if failure.kind == "late":
            return LateError(failure.message, model=self.name, retryable=True, requests=requests)
        if failure.is_no_response:
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
        """Return what one try may cost."""
        asked = estimate_tokens(request)
        answered = self._arguments.get("max_tokens") or self.traffic.budget.answer_tokens
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
        message = response.choices[0].message
        text = message.content or getattr(message, "refusal", None) or ""
        if not text and getattr(response.choices[0], "finish_reason", "") == "content_filter":
            raise Filtered("the answer was withheld")
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
            usage=believed(usage.model_copy(update={"cost_usd": cost}), request),
        )

    def _cost(self, response: Any, asked: int, answered: int) -> float | None:
        if (given := self.traffic.prices.get(self.name)) is not None:
            return given.of(asked, answered)
        try:
            return float(self._sdk.completion_cost(completion_response=response, model=self._model))
        # litellm raises a bare Exception for a model that has no price.
        except Exception:
            return None

    def _response_format(self, request: Request) -> dict[str, Any] | None:
        if self._json == "schema":
            name = request.prompt.purpose.replace("-", "_")
            return {"type": "json_schema", "json_schema": {"name": name, "schema": request.schema}}
        return {"type": "json_object"} if self._json == "mode" else None

    def _wait(self, failure: Failure, tries: int, request: Request) -> float | None:
        """Return how long to wait before the next try; `None` to give up."""
        most = min(self.retries, LATE_RETRIES) if failure.kind == "late" else self.retries
        most = 0 if self._endpoint.is_doubted(self.name) else most
        if not failure.retryable or tries >= most:
            return None
        if failure.retry_after is not None:
            return failure.retry_after if failure.retry_after <= self.max_wait_s else None
        keys = ("retry", request.prompt.purpose, request.sample, request.attempt, tries)
        jitter = float(stream(self.seed, *keys).uniform(0.5, 1.0))
        return min(float(2**tries), self.max_wait_s) * jitter


def load_litellm() -> ModuleType:
    """Import litellm, quietly and without its download of a price list.

    Raises:
        MissingExtra: When it is not installed.
        UsageError: When it is, and cannot be loaded.
    """
    enforce()
    with _import_lock:
        os.environ.setdefault("LITELLM_LOCAL_MODEL_COST_MAP", "True")
        # Its own type definitions make pydantic warn, some of them only when they are first used.
        warnings.filterwarnings(
            "ignore", message=r".*ReadOnly. qualifier", category=UserWarning, module=r"pydantic\."
        )
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
        except OSError as error:
            reason = error.strerror or str(error)
            raise UsageError(
                f"litellm cannot be loaded: {reason}; it needs a temporary folder that it can write, such as "
                "TMPDIR may name"
            ) from None
        litellm.suppress_debug_info = True
        litellm.telemetry = False
        install(http_handler, common_utils)
        # litellm keeps one client that was made before.
        if (handler := getattr(litellm, "module_level_client", None)) is not None:
            guard(handler.client)
        module: ModuleType = litellm
        return module


def known_price(sdk: ModuleType, model: str) -> Price | None:
    """Return what litellm says a model costs; `None` where it does not know."""
    try:
        asked, answered = sdk.cost_per_token(
            model=model, prompt_tokens=1_000_000, completion_tokens=1_000_000
        )
    # litellm raises a bare Exception for a model that has no price.
    except Exception:
        return None
    return Price(float(asked), float(answered))


def _afford(model: str, price: Price | None, traffic: Traffic) -> None:
    """Refuse a model without a price where the cost is capped."""
    if traffic.budget.caps.cost_usd is not None and price is None:
        raise UsageError(
            f"the cost of the run is capped and the price of {model!r} is not known; give it in USD per "
            f"million tokens of input and output, e.g. --price {model}=0.5,1.5 (0,0 for a model of "
            "your own), or cap requests or tokens instead"
        )


def provider_seed(seed: int, sample: int, attempt: int = 1) -> int:
    """Return the seed that a provider is given for one call: below 2**31, as some demand.

    A repair has another seed than the question, or a model might repeat its fault word for word.
    """
    return (seed * 1_000_003 + sample + (attempt - 1) * 500_000_003) % 2**31


def wire_message(message: Message, model: str = "") -> dict[str, Any]:
    """Write a message in OpenAI's format; pictures become base64 data URLs.

    Raises:
        LLMError: When a picture cannot be read.
    """
    if not message.images:
        return {"role": message.role, "content": message.text}
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    for image in message.images:
        try:
            url = data_url(image)
        except OSError as error:
            reason = error.strerror or str(error)
            raise LLMError(f"cannot read the image {image.name}: {reason}", model=model) from error
        parts.append({"type": "image_url", "image_url": {"url": url}})
    return {"role": message.role, "content": parts}


def data_url(image: Image) -> str:
    """Return a picture as a data URL of its own format (JPEG or PNG)."""
    data = image.read()
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _resolve(sdk: ModuleType, model: str, api_base: str | None) -> tuple[str, str, str | None]:
    """Return the name for litellm, the provider, and the provider's address where litellm knows it."""
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


def _permit(model: str, api_base: str | None, address: str | None) -> None:
    """Refuse an address outside this machine where the environment forbids the network."""
    if not is_offline() or is_loopback(address):
        return
    where = redact(api_base) if api_base else "its provider"
    raise UsageError(
        f"{SWITCH} is set, and {model!r} would be asked at {where}; only addresses on this "
        f"machine are allowed (127.0.0.1, localhost), or unset {SWITCH}"
    )


def _json_ability(sdk: ModuleType, model: str) -> str:
    """Say whether a model takes a JSON `schema`, has a JSON `mode`, or neither (empty)."""
    if sdk.supports_response_schema(model=model):
        return "schema"
    parameters = sdk.get_supported_openai_params(model=model) or ()
    return "mode" if "response_format" in parameters else ""

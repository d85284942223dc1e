"""Any language model that litellm reaches: hosted, local, or behind an OpenAI-compatible address."""

import base64
import os
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from ipaddress import ip_address
from types import ModuleType
from typing import Any
from urllib.parse import urlsplit

from oodscen.errors import LLMError, MissingExtra, UnknownComponent, UsageError
from oodscen.llms.redaction import redact
from oodscen.messages import Image, Message
from oodscen.protocols import Completion, Request, Usage
from oodscen.seeding import stream

NO_KEY = "none"
"""Sent as the key to an own address where no key is set: such servers seldom want one."""

_SHOWN = 500
"""Longest error text passed on, in characters; some servers answer with whole web pages."""

_READ = 20_000
"""How much of an error text is looked at; far more than is passed on, so that no key is cut in two."""

_ABOUT_CONTENT = ("ContextWindowExceededError", "ContentPolicyViolationError")
"""litellm's names of errors with status 400 that another answer format would not mend."""

_import_lock = threading.Lock()


class LiteLLM:
    """A model by its litellm name: `gpt-4o`, `anthropic/claude-...`, `gemini/...`, `ollama/llama3`.

    Keys are read by litellm from the environment (`OPENAI_API_KEY`, `ANTHROPIC_API_KEY` ...); they are
    never stored here and are removed from every error.

    The answer's JSON schema is sent natively where litellm knows that the model takes one, JSON mode
    is asked for where the provider has it, and a server that refuses either is asked without;
    the templates state the format in any case. Each call is sent with a `provider_seed` of its own where
    the provider takes seeds: `(seed * 1_000_003 + sample) % 2**31` for the question itself.

    Rate limits, timeouts, lost connections and server errors are retried here and nowhere else, after
    the time the server names in `Retry-After`, or 1, 2, 4 ... seconds with jitter.

    Args:
        model: Name as litellm spells it. With `api_base`, a name without a provider litellm knows is taken to
            be served by an OpenAI-compatible server.
        api_base: Address of the server, e.g. `http://localhost:8000/v1`.
        seed: Of the run.
        timeout_s: Longest wait for a server that stays silent, per try.
        temperature: Sampling temperature; `None` leaves it to the provider.
        max_tokens: Longest answer; `None` leaves it to the provider.
        retries: Further tries after the first.
        max_wait_s: Longest wait before one retry; a server that asks for more is given up.
        options: Further arguments of `litellm.completion`, e.g. `{"reasoning_effort": "low"}`.
        sleep: Waits the given seconds.

    Raises:
        MissingExtra: When litellm is not installed.
        UnknownComponent: When litellm knows neither model nor provider, with close matches.
        UsageError: When `OODSCEN_OFFLINE=1` forbids the address.
    """

    def __init__(
        self,
        model: str,
        *,
        api_base: str | None = None,
        seed: int = 0,
        timeout_s: float = 120.0,
        temperature: float | None = None,
        max_tokens: int | None = None,
        retries: int = 3,
        max_wait_s: float = 60.0,
        options: Mapping[str, Any] | None = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.name = model
        self.seed = seed
        self.retries = retries
        self.max_wait_s = max_wait_s
        self._sleep = sleep
        self._sdk = sdk = load_litellm()
        self._model, provider, address = _resolve(sdk, model, api_base)
        _permit(model, api_base, address)
        self._json = _json_ability(sdk, self._model)
        self._refused: set[str] = set()
        self._arguments: dict[str, Any] = {
            "model": self._model,
            "timeout": timeout_s,
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
        """
        arguments = {
            **self._arguments,
            "messages": [wire_message(message, self.name) for message in request.messages],
            "seed": provider_seed(self.seed, request.sample, request.attempt),
        }
        purpose = request.prompt.purpose
        form = None if purpose in self._refused else self._response_format(request)
        refused = False
        tries = 0
        while True:
            outcome = self._try({**arguments, "response_format": form} if form else arguments)
            if isinstance(outcome, Completion):
                if refused:
                    self._refused.add(purpose)
                return outcome
            if form and outcome.may_refuse_form:
                form, refused = None, True
                continue
            wait = self._wait(outcome, tries, request)
            if wait is None:
                raise LLMError(outcome.message, model=self.name, retryable=outcome.retryable)
            tries += 1
            self._sleep(wait)

    def _try(self, arguments: dict[str, Any]) -> "Completion | _Failure":
        try:
            response = self._sdk.completion(**arguments)
            return self._completion(response)
        # Servers send anything, and litellm passes on whatever its parsing of it raised.
        except Exception as error:
            return _failure(self.name, error, str(arguments.get("api_key", "")))

    def _completion(self, response: Any) -> Completion:
        message = response.choices[0].message
        text = message.content or getattr(message, "refusal", None) or ""
        usage = getattr(response, "usage", None)
        try:
            cost = float(self._sdk.completion_cost(completion_response=response, model=self._model))
        # litellm raises a bare Exception for a model that has no price.
        except Exception:
            cost = None
        return Completion(
            text=text.encode("utf-8", "replace").decode(),
            usage=Usage(
                input_tokens=getattr(usage, "prompt_tokens", None) or 0,
                output_tokens=getattr(usage, "completion_tokens", None) or 0,
                cost_usd=cost,
            ),
        )

    def _response_format(self, request: Request) -> dict[str, Any] | None:
        if self._json == "schema":
            name = request.prompt.purpose.replace("-", "_")
            return {"type": "json_schema", "json_schema": {"name": name, "schema": request.schema}}
        return {"type": "json_object"} if self._json == "mode" else None

    def _wait(self, failure: "_Failure", tries: int, request: Request) -> float | None:
        """Return how long to wait before the next try; `None` to give up."""
        if not failure.retryable or tries >= self.retries:
            return None
        if failure.retry_after is not None:
            return failure.retry_after if failure.retry_after <= self.max_wait_s else None
        keys = ("retry", request.prompt.purpose, request.sample, request.attempt, tries)
        jitter = float(stream(self.seed, *keys).uniform(0.5, 1.0))
        return min(float(2**tries), self.max_wait_s) * jitter


class _Failure:
    """What went wrong in one try."""

    def __init__(
        self, message: str, *, retryable: bool, may_refuse_form: bool, retry_after: float | None
    ) -> None:
        self.message = message
        self.retryable = retryable
        self.may_refuse_form = may_refuse_form
        self.retry_after = retry_after


def load_litellm() -> ModuleType:
    """Import litellm, quietly and without its download of a price list.

    Raises:
        MissingExtra: When it is not installed.
    """
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
        except ImportError:
            raise MissingExtra("language models through litellm", "llm", "litellm") from None
        litellm.suppress_debug_info = True
        litellm.telemetry = False
        module: ModuleType = litellm
        return module


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


def _permit(model: str, api_base: str | None, address: str | None) -> None:
    """Refuse an address outside this machine where the environment forbids the network."""
    if os.environ.get("OODSCEN_OFFLINE", "") in ("", "0") or is_loopback(address):
        return
    where = redact(api_base) if api_base else "its provider"
    raise UsageError(
        f"OODSCEN_OFFLINE is set, and {model!r} would be asked at {where}; only addresses on this "
        "machine are allowed (127.0.0.1, localhost), or unset OODSCEN_OFFLINE"
    )


def is_loopback(address: str | None) -> bool:
    """Whether an address is certain to be on this machine."""
    try:
        host = urlsplit(address or "").hostname or ""
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False


def _json_ability(sdk: ModuleType, model: str) -> str:
    """Say whether a model takes a JSON `schema`, has a JSON `mode`, or neither (empty)."""
    if sdk.supports_response_schema(model=model):
        return "schema"
    parameters = sdk.get_supported_openai_params(model=model) or ()
    return "mode" if "response_format" in parameters else ""


def _failure(model: str, error: Exception, key: str) -> _Failure:
    status = getattr(error, "status_code", None)
    text = str(error)[:_READ].partition("Traceback (most recent call last)")[0]
    text = " ".join(redact(text, [key]).split())
    text = text if len(text) <= _SHOWN else f"{text[:_SHOWN]} ..."
    # A response that litellm could not read carries no status: the server may do better next time.
    retryable = status is None or status in (408, 409, 425, 429) or status >= 500
    if "insufficient_quota" in text or isinstance(error, ImportError):
        retryable = False
    reason = f"{type(error).__name__}: {text}" if text else type(error).__name__
    return _Failure(
        f"{model} gave no answer: {reason}",
        retryable=retryable,
        may_refuse_form=status in (400, 422) and type(error).__name__ not in _ABOUT_CONTENT,
        retry_after=_retry_after(error),
    )


def _retry_after(error: Exception) -> float | None:
    """Read the seconds that a server asks to wait; both forms of the header are understood."""
    headers: Any = getattr(error, "litellm_response_headers", None)
    if not headers:
        headers = getattr(getattr(error, "response", None), "headers", None) or {}
    try:
        if (milliseconds := headers.get("retry-after-ms")) is not None:
            return max(0.0, float(milliseconds) / 1000.0)
        value = headers.get("retry-after")
        if value is None:
            return None
        if value.strip().replace(".", "", 1).isdigit():
            return float(value)
        moment = parsedate_to_datetime(value)
        moment = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
        return max(0.0, (moment - datetime.now(UTC)).total_seconds())
    except (AttributeError, TypeError, ValueError):
        return None

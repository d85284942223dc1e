"""litellm: loaded without noise, and what it knows about a model."""

import logging
import os
import threading
import warnings
from collections.abc import Iterator
from functools import lru_cache
from types import ModuleType
from typing import Any, Literal

from oodscen._members import reason
from oodscen._words.redaction import redact
from oodscen._words.text import printable
from oodscen.errors import MissingExtra, UnknownComponent, UsageError
from oodscen.llm._remote.budget import Price
from oodscen.llm._remote.call_bounds import active
from oodscen.llm._remote.offline import enforce

_LOGGERS = ("LiteLLM", "LiteLLM Router", "LiteLLM Proxy")
_CLIENTS = ("anthropic", "httpcore", "httpx", "openai")
"""The packages below litellm, which log headers if OPENAI_LOG and the like say so."""
_import_lock = threading.Lock()

JsonAbility = Literal["schema", "mode"]
"""A JSON schema for the answer, or JSON without one."""


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
        _check_environment(tuple(sorted(_network_settings())))
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
            remedy = "; it needs a temporary folder that it can write, such as TMPDIR may name"
            hint = remedy if isinstance(error, OSError) else ""
            raise UsageError(f"litellm cannot be loaded: {reason(error)}{hint}") from None
        litellm.suppress_debug_info = True
        litellm.telemetry = False
        _filter_logs()
        install(http_handler, common_utils)
        # litellm keeps one client that it made on import.
        if (handler := getattr(litellm, "module_level_client", None)) is not None:
            guard(handler.client)
        module: ModuleType = litellm
        return module


def _filter_logs() -> None:
    """Keep credentials, and what could steer a terminal, out of the logs of litellm and its clients."""
    for name in _LOGGERS:
        logging.getLogger(name).addFilter(_quiet)
    # A logger's filter does not see what the loggers below it write.
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] in _CLIENTS:
            logging.getLogger(name).addFilter(_redacted)


def _network_settings() -> Iterator[tuple[str, str]]:
    """Yield the variables of the environment that name proxies or certificates, with their values."""
    for name, value in os.environ.items():
        if name.casefold().endswith("_proxy") or name.startswith("SSL_CERT_"):
            yield name, value


@lru_cache(maxsize=1)
def _check_environment(settings: tuple[tuple[str, str], ...]) -> None:
    """Check the proxies and certificates that the environment names: litellm fails on them at any time.

    Args:
        settings: The variables that httpx reads, with their values; sound ones are checked once, which takes 50 ms.

    Raises:
        UsageError: If httpx cannot use them.
    """
    try:
        import httpx
    except ImportError:
        return  # litellm brings it, and is missing as well.
    try:
        with httpx.Client() as client:
            for proxy in client._mounts.values():
                _check_port(getattr(getattr(proxy, "_pool", None), "_proxy_url", None))
    except OSError as error:
        raise UsageError(
            f"the certificates that SSL_CERT_FILE or SSL_CERT_DIR names cannot be read: {reason(error)}"
        ) from None
    except (ImportError, ValueError, httpx.InvalidURL) as error:
        raise UsageError(
            f"a proxy that the environment names cannot be used: {reason(error)}; mend or unset HTTPS_PROXY, "
            "HTTP_PROXY, ALL_PROXY or NO_PROXY"
        ) from None


def _check_port(url: Any) -> None:
    """Refuse the address of a proxy whose port is none; httpx takes any number."""
    port = getattr(url, "port", None)
    if port is not None and not 1 <= port <= 65_535:
        raise ValueError(f"{port} is no port, which is a number from 1 to 65535")


def _quiet(record: logging.LogRecord) -> bool:
    """Redact a log line of litellm; drop it during a call, whose errors say what it does, unless LITELLM_LOG is set.

    litellm quotes what a server sent, which may hold a key or steer a terminal.
    """
    return _redacted(record) and (active() is None or "LITELLM_LOG" in os.environ)


def _redacted(record: logging.LogRecord) -> bool:
    """Redact a log line; of one whose arguments do not fit, keep the format, as an error here would fail the call."""
    try:
        line = record.getMessage()
    except Exception:
        line = repr(record.msg)
    record.msg, record.args = printable(redact(line)), ()
    record.exc_info = record.exc_text = None
    return True


def known_price(sdk: ModuleType, model: str) -> Price | None:
    """Return litellm's price of a model, or `None` if it knows none."""
    try:
        input_usd, output_usd = sdk.cost_per_token(
            model=model, prompt_tokens=1_000_000, completion_tokens=1_000_000
        )
    # litellm raises a bare Exception for a model without a price.
    except Exception:
        return None
    return Price(float(input_usd), float(output_usd))


def resolve_model(sdk: ModuleType, model: str, api_base: str | None) -> tuple[str, str, str | None]:
    """Return the name for litellm, the provider, and the provider's address if litellm knows it."""
    providers = [str(getattr(name, "value", name)) for name in sdk.provider_list]
    head, slash, rest = model.partition("/")
    if api_base is not None:
        named = model if slash and head in providers else f"openai/{model}"
        return named, named.partition("/")[0], api_base
    try:
        _, provider, _, address = sdk.get_llm_provider(model=model)
    except sdk.exceptions.BadRequestError:
        names = {*sdk.model_cost, *providers, *(f"{name}/{rest}" for name in providers if rest)}
        raise UnknownComponent("llm", model, names) from None
    return model, provider, address


def credential_settings(sdk: ModuleType) -> dict[str, Any]:
    """Return the settings of litellm that can hold a user's credentials."""
    texts = {name: value for name, value in vars(sdk).items() if isinstance(value, str)}
    return texts | {"headers": sdk.headers or {}}


def json_ability(sdk: ModuleType, model: str) -> JsonAbility | None:
    """Return `schema` if a model takes a JSON schema, `mode` if it has a JSON mode, else `None`."""
    if sdk.supports_response_schema(model=model):
        return "schema"
    parameters = sdk.get_supported_openai_params(model=model) or ()
    return "mode" if "response_format" in parameters else None

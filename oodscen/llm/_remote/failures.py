"""Failed attempts to reach a model, and their meaning for the item and the endpoint."""

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any, Literal

from oodscen._io.json import parse_json
from oodscen._words.redaction import redact_start
from oodscen._words.text import one_line
from oodscen.llm._remote.call_bounds import KEPT_BYTES, CallBounds
from oodscen.llm._remote.usage import Charge
from oodscen.protocols import Usage

Kind = Literal["item", "filtered", "limit", "late", "unreachable", "erring", "denied"]
"""The meaning of a failure.

`item`: the request is refused, which says nothing about other items. `filtered`: the provider's content
filter declines the item. `limit`: too many calls. `late`: the time is up, whether or not the server is alive.
`unreachable`: no response at all. `erring`: an unusable response (server errors, web pages, empty or endless
bodies). `denied`: every call will be refused (no valid key, no quota).
"""

_MAX_SHOWN = 500
"""Maximum length of an error text, in characters; some servers answer with whole web pages."""

_MAX_QUOTED = 100
"""Maximum number of characters of an unusable response that its message quotes."""

_MAX_RAW = 4_000
"""Maximum number of characters of an unusable response that are kept."""

_TRANSIENT: frozenset[Kind] = frozenset({"limit", "late", "unreachable", "erring"})
"""Kinds of failures after which a later attempt may succeed."""

_MEANINGS: dict[int, Kind] = {
    401: "denied",
    402: "denied",
    403: "erring",
    404: "erring",
    408: "late",
    409: "erring",
    425: "erring",
    429: "limit",
}
"""Meanings of the statuses below 500 that are not about the item."""

_FILTER = re.compile(
    r"content[_ ]?policy|content[_ ]?filter|content management policy|responsible ?ai ?policy"
    r"|(?:safety|moderation) (?:system|filter|policy)|data_inspection_failed|moderation_blocked",
    re.IGNORECASE,
)
"""Names of providers' content filters in error texts."""

_CODES = ("code", "type", "status", "reason")
"""Members of an error's body that name it."""

_DENIAL = re.compile(
    r"insufficient_quota|credit balance is too low|API_KEY_INVALID|API key not valid|Incorrect API key",
    re.IGNORECASE,
)
"""Words by which providers refuse a key or an account, whatever the status: Gemini answers 400 to an invalid key."""

_BROKEN = {
    "size": "the response has more than {detail} bytes",
    "encoding": "the response is compressed although plain text was asked for",
    "redirect": "the server redirects to {detail}, and redirects are not followed; if that is the right "
    "address of the API, give it as the server's address",
    "proxy": "a proxy is asked over http:// only; mend HTTPS_PROXY or ALL_PROXY",
    "offline": "OODSCEN_OFFLINE is set, and {detail} is not this machine",
}
"""Messages for calls that their bounds ended, where nothing else about the failure matters."""

_UNSENDABLE = "a key or a name in the environment holds characters that a request cannot carry"


class Filtered(Exception):
    """Raised when a content filter withheld or cut the answer; callers never see it."""

    def __init__(self, message: str, charge: Charge) -> None:
        self.charge = charge
        super().__init__(message)


class NoAnswer(Exception):
    """Raised for a response that is well-formed but holds no answer; callers never see it."""


@dataclass(frozen=True)
class FailedAttempt:
    """One attempt without an answer."""

    message: str
    kind: Kind
    retryable: bool
    may_refuse_format: bool = False
    """True if the same request may succeed without an answer format."""
    retry_after: float | None = None
    """Seconds that the server asks to wait."""
    status: int | None = None
    """Status of the HTTP response, if there was one."""
    raw: str = ""
    """The beginning of an unreadable response."""
    usage: Usage | None = None
    """Usage that a filtered response states."""

    @property
    def is_unusable(self) -> bool:
        """True if a response arrived but was unusable: empty, a web page, too large."""
        is_error = self.status is not None and self.status >= 400
        return self.kind == "erring" and self.retryable and not is_error

    @property
    def is_free(self) -> bool:
        """True if the response was an error, which no provider bills."""
        return self.status is not None and self.status >= 400


def diagnose(model: str, error: Exception, bounds: CallBounds) -> FailedAttempt:
    """Classify an exception of litellm, without any credentials in the texts.

    Args:
        model: The model's name for the message.
        error: The exception.
        bounds: The bounds of the call, which know what really arrived; litellm gives every error a status.
    """
    from litellm.exceptions import ContextWindowExceededError  # Late: only its errors come here.

    status = bounds.status if bounds.is_sent else getattr(error, "status_code", None)
    cause = _root_cause(error)
    words, cause_words = _words(error), _words(cause)
    text = _short(words)
    if one_line(cause_words) not in one_line(words):
        text = f"{text} ({_short(cause_words)})"
    told = " ".join((words, cause_words, *_codes(bounds.head)))
    kind, reason = _meaning(_kind(status, told, error), text, error, bounds)
    if _is_unsendable(cause):
        kind, reason = "denied", _UNSENDABLE
    raw = ""
    if kind == "erring" and (status is None or status < 400):
        raw = _start(bounds)
        if bounds.broken is None and bounds.is_sent:
            reason = _unreadable(raw, reason)
    is_lasting = bounds.broken in ("redirect", "proxy", "offline") or status in (403, 404)
    return FailedAttempt(
        message=f"{model} gave no answer: {reason}",
        kind=kind,
        retryable=kind in _TRANSIENT and not is_lasting and not isinstance(error, ImportError),
        may_refuse_format=(
            status in (400, 422)
            and kind == "item"
            and not isinstance(error, ContextWindowExceededError)
        ),
        retry_after=retry_after(error),
        status=status,
        raw=raw,
    )


def _codes(body: bytes) -> Iterator[str]:
    """Yield the codes by which a body names its error; litellm's words leave them out."""
    with suppress(ValueError):
        values = [parse_json(body)]
        while values:
            value = values.pop()
            if isinstance(value, list):
                values += value
            elif isinstance(value, dict):
                values += value.values()
                yield from (str(value[name]) for name in _CODES if name in value)


def _unreadable(raw: str, reason: str) -> str:
    """Return the reason for which a response was unusable, with its beginning."""
    if not raw.strip():
        return "the response is empty"
    return f"{reason}; it begins: {_short(raw)[:_MAX_QUOTED]}"


def _meaning(kind: Kind, text: str, error: Exception, bounds: CallBounds) -> tuple[Kind, str]:
    """Return the kind of a failure as the call's bounds correct it, and its reason in words.

    Args:
        kind: The kind by the status and the words of the error.
        text: The words, cut to fit into a message.
        error: The exception.
        bounds: The bounds of the call.
    """
    if bounds.broken in _BROKEN:
        return "erring", _BROKEN[bounds.broken].format(detail=bounds.detail)
    if bounds.broken == "silence":
        return "unreachable", "the server accepts connections and says nothing"
    if bounds.broken == "time" or (bounds.is_over and kind in ("unreachable", "erring")):
        return "late", "the response did not end in time"
    if bounds.broken == "closed":
        return kind, "the run was interrupted"
    if isinstance(error, NoAnswer):
        return kind, text
    if kind == "filtered":
        return kind, f"the provider's content filter declined it: {text}"
    return kind, f"{type(error).__name__}: {text}" if text else type(error).__name__


def _short(text: str) -> str:
    """Return a text on one line, without credentials and cut to a length that fits into a message."""
    text = one_line(redact_start(text, _MAX_RAW))
    return text if len(text) <= _MAX_SHOWN else f"{text[:_MAX_SHOWN]} ..."


def _words(error: BaseException) -> str:
    """Return the words of an error without the traceback that litellm puts into some."""
    return str(error).partition("Traceback (most recent call last)")[0]


def _root_cause(error: BaseException) -> BaseException:
    """Return the root cause of an error; litellm's own words leave it out."""
    while (before := error.__cause__ or error.__context__) is not None:
        error = before
    return error


def _is_unsendable(cause: BaseException) -> bool:
    """Return whether a header of the request cannot be sent; the body is UTF-8."""
    is_ascii = isinstance(cause, UnicodeEncodeError) and cause.encoding == "ascii"
    return is_ascii or type(cause).__name__ == "LocalProtocolError"


def _start(bounds: CallBounds) -> str:
    """Return the beginning of a response's body without credentials."""
    is_cut = len(bounds.head) >= KEPT_BYTES
    return redact_start(bounds.head.decode("utf-8", "replace"), _MAX_RAW, is_cut=is_cut)


def _kind(status: int | None, text: str, error: Exception) -> Kind:
    from litellm.exceptions import ContentPolicyViolationError

    if isinstance(error, Filtered | ContentPolicyViolationError):
        return "filtered"
    if _DENIAL.search(text) or isinstance(error, ImportError):
        return "denied"
    if status is None:
        return "unreachable"
    if status in (400, 403, 422, 451) and _FILTER.search(text):
        return "filtered"
    return _MEANINGS.get(status, "item" if 400 <= status < 500 else "erring")


def retry_after(error: Exception) -> float | None:
    """Return the seconds that a server asks to wait, from either header that says so."""
    headers: Any = getattr(error, "litellm_response_headers", None)
    if not headers:
        headers = getattr(getattr(error, "response", None), "headers", None)
    if not isinstance(headers, Mapping):
        return None
    for name, unit in (("retry-after-ms", 1e-3), ("retry-after", 1.0)):
        seconds = _seconds(headers.get(name), unit)
        if seconds is not None:
            return seconds
    return None


def _seconds(value: Any, unit: float) -> float | None:
    """Return the seconds that a number of units or a date means; `None` if it means none."""
    try:
        seconds = unit * float(value)
    except (TypeError, ValueError):
        try:
            moment = parsedate_to_datetime(value)
            moment = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
            seconds = max(0.0, (moment - datetime.now(UTC)).total_seconds())
        except (AttributeError, TypeError, ValueError, OverflowError):
            return None
    return seconds if seconds >= 0.0 else None

"""Removes credentials from everything that is shown or written."""

import base64
import html
import json
import os
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any
from urllib.parse import parse_qsl, quote, quote_plus, urlsplit

HIDDEN = "[redacted]"

SHORTEST = 8
"""Shorter values are not treated as credentials: replacing them would garble ordinary text."""

_SECRET_NAME = re.compile(
    r"(?: KEY | TOKEN | SECRET | PASSWORD | PASSWD | PASSPHRASE | CREDENTIAL | JWT | BEARER"
    r"  | (?<![A-Z0-9]) (?: PAT | PASS | AUTHORIZATION ) ) S? (?![A-Z])"
    r"(?! .* [_-] (?: FILE | PATH | DIR | URL | URI | NAME | TYPE ) $ )",
    re.IGNORECASE | re.VERBOSE,
)
"""Matches names of variables, arguments and headers that hold a credential rather than the place of one."""

_SHAPES = re.compile(
    r"""
      (?<![A-Za-z0-9]) (?: sk | pk | rk | gsk | xai | hf | r8 | pplx | nvapi ) [-_] [\w-]{8,}
    | (?<![A-Za-z0-9]) AIza [\w-]{20,}
    | (?<![A-Za-z0-9]) (?: AKIA | ASIA ) [A-Z0-9]{12,}
    | (?<![A-Za-z0-9]) eyJ [\w-]{8,} \. [\w-]{8,} \. [\w-]*
    | (?<= :// ) [^/\s@]+ (?= @ )
    | (?P<query> [?&] (?i: (?: api [-_]? | access [-_]? )? (?: key | token ) ) = ) [^\s&"']+
    | (?P<header>
        (?i: (?: authorization | (?: x [-_] )? (?: goog [-_] )? api [-_] key ) ["']? \s* [:=] \s* ["']?
             (?: (?: bearer | basic ) \s+ )?
           | bearer \s )
      ) [^\s"',;]{6,}
    """,
    re.VERBOSE,
)

_told: set[str] = set()
"""Credentials that are in no environment variable."""


def redact(text: str, known: Iterable[str] = ()) -> str:
    """Replace the credentials in a text.

    This covers everything that `redact_keys` covers, and anything that looks like a provider's key, a bearer
    token, or a password or key in an address or header.
    """
    return _SHAPES.sub(_hidden, redact_keys(text, known))


def redact_keys(text: str, known: Iterable[str] = ()) -> str:
    """Replace only known credentials. Meant for model output, where text that looks like a key is content.

    Known are the given values, the values passed to `hide`, and the values of environment variables with KEY,
    TOKEN, SECRET, PASSWORD, CREDENTIALS, JWT, BEARER or PAT as a word in their names. They are also found when
    escaped for JSON, HTML or an address, or in Base64. Values shorter than `SHORTEST` characters are kept.
    """
    held = (value for name, value in os.environ.items() if _SECRET_NAME.search(name))
    values = {value for value in (*held, *_told, *known) if len(value) >= SHORTEST}
    return _any_of(frozenset(values - {HIDDEN, HIDDEN[1:-1]})).sub(HIDDEN, text)


def hide(values: Iterable[str]) -> None:
    """Register credentials in this process, so that they are redacted from now on."""
    _told.update(value for value in values if len(value) >= SHORTEST)


def secrets_in(arguments: Mapping[str, Any]) -> list[str]:
    """Return the credentials in named arguments or headers, including nested ones."""
    found = []
    for name, value in arguments.items():
        if isinstance(value, Mapping):
            found += secrets_in(value)
        elif isinstance(value, str) and _SECRET_NAME.search(str(name)):
            # A header may put its scheme before the credential.
            found += [value, value.split()[-1]] if value.strip() else []
    return found


def secrets_of(address: str) -> list[str]:
    """Return the password and keys in an address."""
    try:
        parts = urlsplit(address)
        return [*filter(None, [parts.password]), *secrets_in(dict(parse_qsl(parts.query)))]
    except ValueError:
        return []


@lru_cache(maxsize=64)
def _any_of(values: frozenset[str]) -> re.Pattern[str]:
    """Return a pattern that matches these credentials in every encoding, and never matches if there are none."""
    forms = sorted({form for value in values for form in _forms(value)}, key=len, reverse=True)
    return re.compile("|".join([*map(_escaped, values), *map(re.escape, forms)]) or "(?!)")


def _escaped(value: str) -> str:
    """Return a pattern of a value of which JSON may have escaped any characters."""
    return "".join(rf"(?:{re.escape(one)}|\\u(?i:{ord(one):04x}))" for one in value)


def _forms(value: str) -> set[str]:
    data = value.encode("utf-8", "replace")
    quoted = {quote(data, safe=""), quote(data), quote_plus(data)}
    lower = {re.sub("%[0-9A-F]{2}", lambda code: code[0].lower(), text) for text in quoted}
    escaped = {json.dumps(value)[1:-1], json.dumps(value, ensure_ascii=False)[1:-1]}
    return {value, html.escape(value), *quoted, *lower, *escaped, *_encoded(data)}


def _encoded(data: bytes) -> set[str]:
    """Return the Base64 encodings of a value at every alignment, without characters shared with its neighbours."""
    forms = set()
    for before in range(3):
        first, end = -(-8 * before // 6), 8 * (before + len(data)) // 6
        for encode in (base64.b64encode, base64.urlsafe_b64encode):
            forms.add(encode(b"\0" * before + data).decode("ascii")[first:end])
    return forms


def _hidden(found: re.Match[str]) -> str:
    return f"{found['query'] or found['header'] or ''}{HIDDEN}"

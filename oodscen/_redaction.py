"""Removes credentials from everything that is shown or written."""

import base64
import os
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from html.entities import html5
from itertools import groupby
from typing import Any
from urllib.parse import parse_qsl, urlsplit

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
    any of their characters are escaped, as in JSON, HTML or an address, or in Base64. Values shorter than `SHORTEST` characters are kept.
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
    longest_first = sorted(values, key=lambda value: (-len(value), value))
    forms = sorted({form for value in values for form in _encoded(value)}, key=len, reverse=True)
    return re.compile("|".join([*map(_escaped, longest_first), *map(re.escape, forms)]) or "(?!)")


def _escaped(value: str) -> str:
    """Return a pattern of a value of which any characters may be escaped, each in its own way."""
    pattern = ""
    for one, run in groupby(value):
        count = len(list(run))
        # Every level of JSON doubles a backslash.
        most = 4 * count if one == "\\" else count
        pattern += f"(?:{_character(one)}){{{count},{most}}}"
    return pattern


@lru_cache(maxsize=1024)
def _character(one: str) -> str:
    r"""Return a pattern of a character as it is, or escaped for JSON, Python, HTML or an address.

    Escaping twice is covered as well: `\\u005a`, `%255A`, `&amp;#90;`.
    """
    code = ord(one)
    units = one.encode("utf-16-be", "surrogatepass")
    pairs = zip(units[::2], units[1::2], strict=True)
    data = one.encode("utf-8", "replace")
    forms = [
        rf"&(?:amp;)*#(?:0*{code}|[xX]0*(?i:{code:x}));?",
        "".join(rf"{_SLASHES}u(?i:{high:02x}{low:02x})" for high, low in pairs),
        rf"{_SLASHES}(?:u\{{0*(?i:{code:x})\}}|U(?i:{code:08x}))",
        "".join(rf"%(?:25)*(?i:{byte:02x})" for byte in data),
        rf"&(?:amp;)*(?:{'|'.join(map(re.escape, _NAMES[one]))});?" if one in _NAMES else "",
        rf"{_SLASHES}x(?i:{code:02x})" if code < 256 else "",
        rf"{_SLASHES}{re.escape(_SHORT.get(one, one))}" if one in _SHORT or one in "\"'/" else "",
        r"\+" if one == " " else "",
        re.escape(one),
    ]
    return "|".join(filter(None, forms))


def _entities() -> dict[str, list[str]]:
    """Return the names of HTML's entities by the character that they stand for."""
    found: dict[str, list[str]] = {}
    for name, one in html5.items():
        if len(one) == 1 and name.endswith(";"):
            found.setdefault(one, []).append(name[:-1])
    return found


_NAMES = _entities()
_SLASHES = r"\\{1,8}"
"""The backslashes before an escape; bounded, as a search without a bound takes cubic time."""
_SHORT = {"\b": "b", "\t": "t", "\n": "n", "\f": "f", "\r": "r"}
"""JSON's short escapes of control characters."""


def _encoded(value: str) -> set[str]:
    """Return the Base64 encodings of a value at every alignment, without characters shared with its neighbours."""
    forms, data = set(), value.encode("utf-8", "replace")
    for before in range(3):
        first, end = -(-8 * before // 6), 8 * (before + len(data)) // 6
        for encode in (base64.b64encode, base64.urlsafe_b64encode):
            forms.add(encode(b"\0" * before + data).decode("ascii")[first:end])
    return forms


def _hidden(found: re.Match[str]) -> str:
    return f"{found['query'] or found['header'] or ''}{HIDDEN}"

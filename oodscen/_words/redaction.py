"""Removes credentials from everything that is shown or written."""

import base64
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache, lru_cache
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
      (?<![A-Za-z0-9]) (?: (?: sk | pk | rk | gsk | xai | r8 | pplx | nvapi ) [-_] [\w-]{8,} | hf_ \w{8,} )
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

_NAMED = re.compile(
    r"""(?<!\w)(?P<name>[A-Za-z_]\w{0,63})(?P<is>["']?\s?[=:]\s?)(?P<quote>["'])(?:\\.|(?!(?P=quote))[^\\]){1,500}(?P=quote)"""
)
"""A field and its text, as in `password='...'` and `{'token': '...'}`."""

_DASHES = "‐‑‒–—―−"
"""Characters that stand for a hyphen where text is typeset."""
_SLASHES = r"\\{1,8}"
"""The backslashes before an escape; bounded, as a search without a bound takes cubic time."""
_SHORT = {"\b": "b", "\t": "t", "\n": "n", "\f": "f", "\r": "r"}
"""JSON's short escapes of control characters."""
_BREAK = rf"(?:\s|{_SLASHES}[rn]|%(?:25)?0[aAdD])"
"""A line break or a space, also escaped."""
_SOFT_BREAK = rf"(?:={_BREAK}{{1,2}})?"
"""A line break that quoted-printable text adds."""
_QUOTE = rf"(?:(?:{_SLASHES})?[\"'])?"
"""A quotation mark, also escaped, or nothing."""
_BETWEEN = rf"(?:{_QUOTE}(?:(?:[,;:._-]|{_BREAK}){{1,3}}{_QUOTE})?(?:0x|{_SLASHES}x|U\+|00)?)"
"""The characters between two bytes in hexadecimal digits."""
_ELLIPSIS = re.compile(
    rf"(\s?(?:[\[(]|(?:{_SLASHES})?['\"]){{0,2}}"
    rf"(?:\.{{3,}}|…|\*{{3,}}|{_SLASHES}u2026|&(?:amp;)?(?:hellip|\#8230|\#x2026);)"
    rf"(?:[\])]|(?:{_SLASHES})?['\"]){{0,2}}\s?)",
    re.IGNORECASE,
)
"""A mark that something is left out, with the blanks, brackets and quotes around it."""
_MARGIN = 20_000
"""Characters that are searched beyond those that are shown."""
_WIDEST = 40
"""Characters that an escaped character can take."""

_told: set[str] = set()
"""Credentials that are in no environment variable."""


def redact(text: str, known: Iterable[str] = ()) -> str:
    """Replace the credentials in a text.

    This covers everything that `redact_keys` covers, and anything that looks like a provider's key, a bearer
    token, or a password or key in an address or header.
    """
    return _SHAPES.sub(_hidden, redact_keys(text, known))


def redact_repr(text: str) -> str:
    """Replace the credentials in the representation of an object, with all that its fields name as such."""
    return redact(_NAMED.sub(_without_value, text))


def redact_keys(text: str, known: Iterable[str] = ()) -> str:
    """Replace only known credentials. Meant for model output, where text that looks like a key is content.

    Known are the given values, the values passed to `hide`, and the values of environment variables with KEY,
    TOKEN, SECRET, PASSWORD, CREDENTIALS, JWT, BEARER or PAT as a word in their names. They are also found when
    any of their characters are escaped, as in JSON, HTML, an address or quoted-printable text, in Base64, also twice,
    as hexadecimal digits and as a list of numbers, decimal or octal. Values shorter than `SHORTEST` characters are kept,
    and so are shorter pieces of a value beside an ellipsis; longer ones are replaced.
    """
    if len(text) < SHORTEST or not (values := _known(known)):
        return text
    return _without_pieces(_any_of(values).sub(HIDDEN, text), values)


def redact_start(
    text: str,
    length: int,
    *,
    is_cut: bool = False,
    redacted: Callable[[str], str] = redact,
) -> str:
    """Return the beginning of a redacted text; a credential that a cut divides leaves nothing.

    Args:
        text: A text of any length, of which only the beginning is searched.
        length: Number of characters to return at most.
        is_cut: True if the text is itself the beginning of a longer one.
        redacted: Replaces the credentials; `redact_keys` in model output.
    """
    end = _WIDEST * max(map(len, _known(())), default=0)
    read = length + max(_MARGIN, 2 * end)
    shown = redacted(text[:read])
    if is_cut or len(text) > read:
        shown = shown[: max(0, len(shown) - end)]
    return shown[:length]


def _known(more: Iterable[str]) -> frozenset[str]:
    """Return all credentials that are known, and the given ones."""
    held = (value for name, value in os.environ.items() if _is_secret(name))
    values = {value for value in (*held, *_told, *more) if len(value) >= SHORTEST}
    return frozenset(values - {HIDDEN, HIDDEN[1:-1]})


@lru_cache(maxsize=1024)
def _is_secret(name: str) -> bool:
    """Return whether a variable, argument or header of a name holds a credential."""
    return bool(_SECRET_NAME.search(name))


def hide(values: Iterable[str]) -> None:
    """Register credentials in this process, so that they are redacted from now on."""
    _told.update(value for value in values if len(value) >= SHORTEST)


def secrets_in(arguments: Mapping[str, Any]) -> list[str]:
    """Return the credentials in named arguments or headers, including nested ones."""
    found = []
    for name, held in arguments.items():
        for value in held if isinstance(held, list | tuple) else (held,):
            if isinstance(value, Mapping):
                found += secrets_in(value)
            elif isinstance(value, str) and _is_secret(str(name)):
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


def _without_pieces(text: str, values: frozenset[str]) -> str:
    """Replace the pieces of values that end or begin at an ellipsis, as in `'Ab3dEf6hIj9k...Rs8tUv2w'`."""
    parts = _ELLIPSIS.split(text)
    if len(parts) > 1:  # JSON escapes the quotes in a value.
        values |= {json.dumps(value, ensure_ascii=False)[1:-1] for value in values}
    for index in range(0, len(parts), 2):
        if index + 1 < len(parts) and (end := _longest(values, parts[index], is_end=True)):
            parts[index] = parts[index][:-end] + HIDDEN
        if index and (start := _longest(values, parts[index], is_end=False)):
            parts[index] = HIDDEN + parts[index][start:]
    return "".join(parts)


def _longest(values: frozenset[str], part: str, *, is_end: bool) -> int:
    """Return the length of the longest end or start of a part that stands in a value; 0 if it is too short."""
    longest = 0
    for value in values:
        count = SHORTEST
        while count <= len(part) and (part[-count:] if is_end else part[:count]) in value:
            longest, count = max(longest, count), count + 1
    return longest


@lru_cache(maxsize=64)
def _any_of(values: frozenset[str]) -> re.Pattern[str]:
    """Return a pattern that matches these credentials in every encoding, and never matches if there are none."""
    longest_first = sorted(values, key=lambda value: (-len(value), value))
    coded = {form for value in values for form in (*_base64(value), *_digits(value))}
    forms = sorted(coded, key=lambda form: (-len(form), form))
    return re.compile("|".join([*map(_escaped, longest_first), *forms]) or "(?!)")


def _escaped(value: str) -> str:
    """Return a pattern of a value of which any characters may be escaped, each in its own way."""
    pattern = ""
    for char, run in groupby(value):
        count = len(list(run))
        # Every level of JSON doubles a backslash.
        most = 4 * count if char == "\\" else count
        pattern += f"(?:(?:{_character(char)}){_SOFT_BREAK}){{{count},{most}}}"
    return pattern


@lru_cache(maxsize=1024)
def _character(char: str) -> str:
    r"""Return a pattern of a character as it is, or escaped for code, JSON, HTML, an address or a mail.

    Escaping twice is covered as well: `\\u005a`, `%255A`, `&amp;#90;`, `=3D5A`.
    """
    code = ord(char)
    units = char.encode("utf-16-be", "surrogatepass")
    pairs = zip(units[::2], units[1::2], strict=True)
    data = char.encode("utf-8", "replace")
    names = "|".join(map(re.escape, _entities().get(char, ())))
    bytewise = "".join(rf"{_SLASHES}(?:x(?i:{byte:02x})|0?{byte:03o})" for byte in data)
    latin = rf"{_SLASHES}(?:x(?i:{code:02x})|0{{0,3}}{code:o}|o\{{0{{0,8}}{code:o}\}})"
    # No text may match two of these: the search for a long value would take exponential time.
    forms = [
        rf"&(?:amp;){{0,8}}#(?:0{{0,8}}{code}|[xX]0{{0,8}}(?i:{code:x}));?",
        "".join(rf"{_SLASHES}u(?i:{high:02x}{low:02x})" for high, low in pairs),
        rf"{_SLASHES}(?:[ux]\{{0{{0,8}}(?i:{code:x})\}}|U(?i:{code:08x}))",
        "".join(rf"%(?:25){{0,8}}(?i:{byte:02x})" for byte in data),
        _SOFT_BREAK.join(rf"=(?:3[dD]){{0,8}}(?i:{byte:02x})" for byte in data),
        rf"&(?:amp;){{0,8}}(?:{names});?" if names else "",
        bytewise if code > 127 else "",
        latin if code < 256 else "",
        rf"{_SLASHES}{re.escape(_SHORT.get(char, char))}"
        if char in _SHORT or char in "\"'/"
        else "",
        r"[+_]" if char == " " else "",
        re.escape(char),
    ]
    return "|".join(filter(None, forms))


@cache
def _entities() -> dict[str, list[str]]:
    """Return the names of HTML's entities by the character that they stand for."""
    names: dict[str, list[str]] = {}
    for name, char in html5.items():
        if len(char) == 1 and name.endswith(";"):
            names.setdefault("-" if char in _DASHES else char, []).append(name[:-1])
    return names


def _base64(value: str) -> set[str]:
    """Return patterns of a value in Base64, once and twice, at every alignment."""
    once = _aligned(value.encode("utf-8", "replace"), base64.b64encode, base64.urlsafe_b64encode)
    twice = {two for one in once for two in _aligned(one.encode("ascii"), base64.b64encode)}
    return {
        f"{_BREAK}{{0,2}}".join(
            mark if mark.isalnum() else f"(?:{_character(mark)})" for mark in coded
        )
        for coded in once | twice
    }


def _aligned(data: bytes, *encoders: Callable[[bytes], bytes]) -> set[str]:
    """Return bytes in Base64 at every alignment, without characters shared with their neighbours."""
    return {
        encode(b"\0" * before + data).decode("ascii")[
            -(-8 * before // 6) : 8 * (before + len(data)) // 6
        ]
        for before in range(3)
        for encode in encoders
    }


def _digits(value: str) -> set[str]:
    """Return patterns of a value whose bytes are written as numbers: hexadecimal, decimal or octal, also in quotes."""
    data = value.encode("utf-8", "replace")
    listed = rf"{_QUOTE}(?:[,;]|{_BREAK}){{1,3}}{_QUOTE}"
    return {
        _BETWEEN.join(f"(?i:{byte:02x})" for byte in data),
        *(
            rf"(?<!\d){listed.join(numbers)}(?!\d)"
            for numbers in (
                [f"0{{0,2}}{byte}" for byte in data],
                [f"(?:0[oO])?0{{0,2}}{byte:o}" for byte in data],
            )
        ),
    }


def _hidden(match: re.Match[str]) -> str:
    return f"{match['query'] or match['header'] or ''}{HIDDEN}"


def _without_value(match: re.Match[str]) -> str:
    if not _is_secret(match["name"]):
        return match[0]
    return f"{match['name']}{match['is']}{match['quote']}{HIDDEN}{match['quote']}"

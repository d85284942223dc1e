"""Credentials leave no trace."""

import base64
import codecs
import html
import html.entities
import itertools
import json
import quopri
import re
import reprlib
from urllib.parse import quote, unquote

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from oodscen._words.redaction import (
    HIDDEN,
    SHORTEST,
    redact,
    redact_keys,
    redact_start,
    secrets_in,
    secrets_of,
)

# What a key can consist of; a key of letters alone may be a word, which is hidden all the same.
keys = st.text(st.characters(min_codepoint=0x21, max_codepoint=0x7E), min_size=8, max_size=40)
secrets = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=8, max_size=40)


@settings(max_examples=15)
@given(secrets, st.text(), st.text())
def test_a_known_value_is_hidden_wherever_it_stands(secret, before, after):
    shown = redact(f"{before}{secret}{after}{secret}", [secret])
    assert secret not in shown.replace(HIDDEN, "")


@settings(max_examples=10)
@given(keys.filter(lambda key: key not in HIDDEN), st.binary(max_size=5), st.binary(max_size=5))
def test_a_known_value_is_hidden_however_it_is_written(key, before, after):
    pair = base64.b64encode(before + key.encode() + after).decode()
    for form in (json.dumps(key), quote(key, safe=""), quote(key), html.escape(key), pair):
        shown = redact_keys(f"so {form} it is", [key])
        assert HIDDEN in shown
        assert key not in shown.replace(HIDDEN, "")


@settings(max_examples=10)
@given(
    keys.filter(lambda key: key not in HIDDEN),
    *(st.binary(max_size=4) for _ in range(4)),
)
def test_a_known_value_is_hidden_in_base64_of_base64(key, before, after, first, last):
    once = base64.b64encode(before + key.encode() + after)
    shown = redact_keys(f"so {base64.b64encode(first + once + last).decode()} it is", [key])
    assert HIDDEN in shown


@settings(max_examples=10)
@given(keys)
def test_hiding_twice_is_hiding_once(key):
    once = redact(f"so {key} it is", [key])
    assert redact(once) == once


NAMES = """OPENAI_API_KEY AWS_BEARER_TOKEN_BEDROCK SNOWFLAKE_JWT WATSONX_APIKEY WATSONX_ZENAPIKEY AWS_ACCESS_KEY_ID
    AZURE_PASSWORD AZURE_CLIENT_SECRET GITHUB_PAT GIGACHAT_CREDENTIALS VERCEL_OIDC_TOKEN HF_TOKEN DB_PASS"""
OTHERS = """PATH TOKENIZERS_PARALLELISM KEYBOARD AWS_WEB_IDENTITY_TOKEN_FILE GITHUB_COPILOT_API_KEY_URL COMPASS
    XAI_OAUTH_TOKEN_DIR OPENAI_API_BASE PATIENCE"""


@pytest.mark.parametrize("name", NAMES.split())
def test_variables_of_credentials_are_known_by_their_names(monkeypatch, name):
    monkeypatch.setenv(name, "eightchr")
    assert redact_keys("so eightchr it is") == f"so {HIDDEN} it is"


@pytest.mark.parametrize("name", OTHERS.split())
def test_other_variables_are_not(monkeypatch, name):
    monkeypatch.setenv(name, "eightchr")
    assert redact_keys("so eightchr it is") == "so eightchr it is"


def test_arguments_headers_and_addresses_hold_credentials():
    options = {
        "api_key": "one",
        "max_tokens": 8,
        "extra_headers": {"X-Api-Key": "two", "Authorization": "Basic three", "X-Title": "four"},
        "fallbacks": [{"model": "seven", "api_key": "eight"}],
        "tokens": ("nine", "ten"),
    }
    assert secrets_in(options) == [
        *("one", "one", "two", "two", "Basic three", "three"),
        *("eight", "eight", "nine", "nine", "ten", "ten"),
    ]
    assert secrets_of("https://me:five@host/v1?key=six&model=m") == ["five", "six", "six"]
    assert secrets_of("http://[") == []


@pytest.mark.parametrize(
    "text",
    [
        "x-api-key: SECRETS",
        '"api_key": "SECRETS"',
        "Authorization: Basic SECRETS",
        "/v1?api_key=SECRETS&a=1",
    ],
)
def test_headers_and_queries_with_keys_are_hidden(text):
    assert redact(text) == text.replace("SECRETS", HIDDEN)


def test_values_of_the_environment_are_hidden(monkeypatch):
    monkeypatch.setenv("MY_PROVIDER_API_KEY", "correct horse battery")
    monkeypatch.setenv("GITHUB_TOKEN", "staple-staple")
    monkeypatch.setenv("SHORT_KEY", "a")
    text = "with correct horse battery and staple-staple, a day"
    assert redact(text) == f"with {HIDDEN} and {HIDDEN}, a day"


@pytest.mark.parametrize(
    "secret",
    [
        "sk-test-0123456789",
        "sk-proj-abc_DEF-0123456789",
        "gsk_0123456789abcdef",
        "hf_abcdefghijklmnop",
        "AIzaSyA-0123456789_abcdefghijkl",
        "AKIA0123456789ABCDEF",
        "eyJhbGciOiJI.eyJzdWIiOiIx.c2lnbmF0dXJl",
    ],
)
def test_the_shapes_of_providers_keys_are_hidden(secret):
    for text in (secret, f"key={secret}", f"('{secret}')", f"Bearer {secret}", f"{secret}."):
        assert secret not in redact(text)


def test_the_name_of_an_organisation_is_no_key():
    name = "huggingface/hf-internal-testing/tiny-random-gpt2"
    assert redact(name) == name


def test_bearer_tokens_and_passwords_in_addresses_are_hidden():
    assert redact("Authorization: Bearer abc.def/ghi+jkl") == f"Authorization: Bearer {HIDDEN}"
    assert redact("https://me:secret@host/v1") == f"https://{HIDDEN}@host/v1"
    assert redact("https://host/v1?key=abcdef&x=1") == f"https://host/v1?key={HIDDEN}&x=1"


@pytest.mark.parametrize(
    "text",
    [
        "the task-oriented risk of a desk-bound driver",
        "Connection refused: http://127.0.0.1:8000/v1",
        "model gpt-4o-2024-08-06 is overloaded",
        "a brisk-moving cyclist",
    ],
)
def test_ordinary_text_stays(text):
    assert redact(text) == text


NAMES_OF = {one: name[:-1] for name, one in html.entities.html5.items() if name.endswith(";")}

ESCAPES = (
    lambda one: one,
    lambda one: "".join(f"%{byte:02X}" for byte in one.encode()),
    lambda one: "".join(f"%{byte:02x}" for byte in one.encode()),
    lambda one: f"&#{ord(one)};",
    lambda one: f"&#{ord(one):05d}",
    lambda one: f"&#x{ord(one):x};",
    lambda one: f"&#X{ord(one):02X};",
    lambda one: json.dumps(one)[1:-1],
    lambda one: "".join(f"\\u{unit:04x}" for unit in units(one)),
    lambda one: "".join(f"\\u{unit:04X}" for unit in units(one)),
    lambda one: f"\\x{ord(one):02x}" if ord(one) < 256 else one,
    lambda one: f"\\x{ord(one):02X}" if ord(one) < 256 else one,
    lambda one: html.escape(one),
    lambda one: "".join(f"%25{byte:02X}" for byte in one.encode()),
    lambda one: "".join(f"={byte:02X}" for byte in one.encode()),
    lambda one: "".join(f"={byte:02x}=\r\n" for byte in one.encode()),
    lambda one: "".join(f"\\{byte:03o}" for byte in one.encode()),
    lambda one: "".join(f"\\\\{byte:03o}" for byte in one.encode()),
    lambda one: f"\\u{{{ord(one):x}}}",
    lambda one: f"\\x{{{ord(one):X}}}",
    lambda one: f"&{NAMES_OF[one]};" if one in NAMES_OF else one,
    lambda one: f"&amp;{NAMES_OF[one]};" if one in NAMES_OF else one,
    lambda one: "&hyphen;" if one == "-" else one,
)
"""Escapes of one character, in either case."""


others = st.text(st.characters(categories=["L", "N", "P", "S"]), min_size=8, max_size=20)


def units(one):
    data = one.encode("utf-16-be")
    return [int.from_bytes(data[at : at + 2]) for at in range(0, len(data), 2)]


def decoded(text):
    """Return every reading of a text in which some of the escapes are undone, in several orders."""
    escape = re.compile(r"(?:\\u[0-9a-fA-F]{4})+|\\x[0-9a-fA-F]{2}|\\[0-7]{1,3}|\\.")

    def unprinted(text):
        return quopri.decodestring(text.encode("utf-8", "replace")).decode("utf-8", "replace")

    def unescaped(text):
        return escape.sub(
            lambda found: (
                codecs.decode(found[0], "unicode_escape", "ignore")
                .encode("utf-16", "surrogatepass")
                .decode("utf-16", "replace")
            ),
            text,
        )

    for steps in itertools.permutations((unquote, html.unescape, unescaped, unprinted)):
        found = text
        for step in steps:
            found = step(found)
            yield found
        yield unquote(found)


@settings(max_examples=15)
@given(st.data())
def test_no_mixture_of_escapes_leaves_a_key_that_can_be_decoded(data):
    key = data.draw((keys | others).filter(lambda key: key not in HIDDEN))
    ways = data.draw(st.lists(st.sampled_from(ESCAPES), min_size=1, max_size=len(key)))
    form = "".join(way(one) for way, one in zip(itertools.cycle(ways), key, strict=False))
    shown = redact_keys(f"so {form} it is", [key])
    assert shown == f"so {HIDDEN} it is"
    assert not any(key in reading for reading in decoded(shown))


def spaced(data, width):
    """Return bytes as numbers in the ways in which programs list them."""
    digits = [f"{byte:02x}" for byte in data]
    yield from (data.hex(), data.hex().upper(), *(data.hex(mark) for mark in " :-_"))
    yield from ("".join(f"\\x{two}" for two in digits), ", ".join(f"0x{two}" for two in digits))
    yield repr("\n".join(map(str, data)))
    yield from (str(list(data)), json.dumps({"type": "Buffer", "data": list(data)}))
    for listed in (
        list(map(str, data)),
        [hex(byte) for byte in data],
        [f"{byte:o}" for byte in data],
    ):
        yield from (str(listed), json.dumps(listed), json.dumps(json.dumps(listed)))
    yield from (
        str([oct(byte) for byte in data]).replace("'", ""),
        " ".join(f"{byte:03o}" for byte in data),
    )
    for whole, mark in itertools.product(
        (data.hex(), base64.b64encode(data).decode()), ("\n", "\r\n")
    ):
        lines = mark.join(whole[at : at + width] for at in range(0, len(whole), width))
        yield from (lines, json.dumps(lines)[1:-1], json.dumps(json.dumps(lines)))
        yield quote(lines, safe="")


@pytest.mark.parametrize(
    "key", ["k3y-0f-8", "k3y-0f-thirt!", "hV0f8m2Lr9wQb5Tz1Xc7Nn4Jd6/k3Ps8+a0Ue2Io"]
)
def test_a_key_is_hidden_as_numbers_and_over_several_lines(key):
    for form in spaced(key.encode(), 16):
        shown = redact_keys(f"so {form} it is", [key])
        assert HIDDEN in shown
        assert not re.search(r"[0-9a-fA-F]{4}|\d, \d", shown.replace(HIDDEN, ""))


@settings(max_examples=30)
@given(st.integers(0, 60), st.integers(0, 300), st.sampled_from(ESCAPES), st.data())
def test_a_key_that_the_end_of_a_long_text_divides_leaves_nothing(before, length, escape, data):
    key = "hV0f8m2Lr9wQb5Tz1Xc7Nn4Jd6Gk3Ps8Ya0Ue2Io"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OPENAI_API_KEY", key)
        text = " " * before + 1_500 * "".join(map(escape, key))
        text = text[: data.draw(st.integers(len(text) // 2, len(text)))]
        shown = redact_start(text, length, is_cut=True)
    assert not any(one.isalnum() for one in shown.replace("redacted", "").strip(" []redact="))


@pytest.mark.parametrize("escape", ESCAPES)
def test_a_key_is_found_whichever_of_its_characters_are_escaped(monkeypatch, escape):
    key = "Zq8xW2pL"
    monkeypatch.setenv("OPENAI_API_KEY", key)
    for step in (1, 2, 3):
        text = "".join(one if at % step else escape(one) for at, one in enumerate(key))
        assert redact_keys(f'{{"text": "a {text} b"}}') == f'{{"text": "a {HIDDEN} b"}}'


def test_a_key_that_begins_another_leaves_nothing_of_it():
    assert redact_keys("so abcdefgh-secret it is", ["abcdefgh", "abcdefgh-secret"]) == (
        f"so {HIDDEN} it is"
    )


def test_a_key_of_backslashes_takes_no_longer():
    assert redact_keys("\\" * 60 + "!", ["\\a" * 30]) == "\\" * 60 + "!"
    assert redact_keys("\\" * 400, ["\\" * 40 + "z"]) == "\\" * 400


@settings(max_examples=12)
@given(
    st.text("0123456789abcdefghijklmnopqrstuvwxyzABCDEFGH-_", min_size=16, max_size=60),
    st.text("., ", max_size=60),
    st.text("., ", max_size=60),
)
def test_what_a_shortened_message_leaves_of_a_key_is_hidden(key, before, after):
    """pydantic and reprlib shorten values in their messages before the message can be redacted."""
    said = before + key + after
    with pytest.raises(ValidationError) as caught:
        TypeAdapter(list[int]).validate_python(said)
    for text in (
        str(caught.value),
        json.dumps(reprlib.repr(said)),
        said[:20] + "…",
        "…" + said[-20:],
    ):
        shown = redact_keys(text, [key])
        assert redact_keys(shown, [key]) == shown
        for at in range(len(key) - SHORTEST + 1):
            assert key[at : at + SHORTEST] not in shown


@settings(max_examples=30)
@given(
    st.text("abcABC01\"\\\n'\u00e9", min_size=20, max_size=40),
    st.integers(SHORTEST, 12),
    st.sampled_from(["...", " … ", "***"]),
)
def test_the_pieces_of_a_key_that_json_escapes_are_hidden(key, size, mark):
    key = f"{key[:size]}-{key[size:]}"
    for text in (f"{key[: size + 1]}{mark} and so on", f"it is {mark}{key[size:]}"):
        shown = json.loads(redact_keys(json.dumps(text, ensure_ascii=False), [key]))
        for at in range(len(key) - SHORTEST + 1):
            assert key[at : at + SHORTEST] not in shown


def test_an_ellipsis_beside_ordinary_words_leaves_them():
    text = "It waited... and drove on… (no key)"
    assert redact_keys(text, ["0123456789abcdef"]) == text
    assert redact_keys("0123456..." + text, ["0123456789abcdef"]) == "0123456..." + text


@pytest.mark.parametrize(
    "mark", ["...", " ... ", " [...] ", "***", "&hellip;", "&#8230;", "'...'", " (…) ", "\\u2026"]
)
def test_whatever_stands_for_what_was_left_out(mark):
    key = "Ab3dEf6hIj9kLm2nRs8tUv2w"
    assert redact_keys(f"{key[:12]}{mark}{key[-8:]}", [key]) == f"{HIDDEN}{mark}{HIDDEN}"

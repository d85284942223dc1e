"""Credentials leave no trace."""

import base64
import html
import json
from urllib.parse import quote

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._redaction import HIDDEN, redact, redact_keys, secrets_in, secrets_of

# What a key can consist of; a key of letters alone may be a word, which is hidden all the same.
keys = st.text(st.characters(min_codepoint=0x21, max_codepoint=0x7E), min_size=8, max_size=40)
secrets = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=8, max_size=40)


@given(secrets, st.text(), st.text())
def test_a_known_value_is_hidden_wherever_it_stands(secret, before, after):
    shown = redact(f"{before}{secret}{after}{secret}", [secret])
    assert secret not in shown.replace(HIDDEN, "")


@settings(max_examples=40)
@given(keys, st.binary(max_size=5), st.binary(max_size=5))
def test_a_known_value_is_hidden_however_it_is_written(key, before, after):
    pair = base64.b64encode(before + key.encode() + after).decode()
    for form in (json.dumps(key), quote(key, safe=""), quote(key), html.escape(key), pair):
        shown = redact_keys(f"so {form} it is", [key])
        assert HIDDEN in shown
        assert key not in shown.replace(HIDDEN, "")


@settings(max_examples=40)
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
    }
    assert secrets_in(options) == ["one", "one", "two", "two", "Basic three", "three"]
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


@pytest.mark.parametrize("which", [slice(None), slice(None, None, 2), slice(3)])
def test_a_key_is_found_whichever_of_its_characters_are_escaped(monkeypatch, which):
    key = "Zq8xW2pL"
    monkeypatch.setenv("OPENAI_API_KEY", key)
    escaped = {index: f"\\u{ord(one):04x}" for index, one in list(enumerate(key))[which]}
    text = "".join(escaped.get(index, one) for index, one in enumerate(key))
    assert redact_keys(f'{{"text": "a {text} b"}}') == f'{{"text": "a {HIDDEN} b"}}'

"""Credentials leave no trace."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.llms.redaction import HIDDEN, redact

secrets = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=8, max_size=40)


@given(secrets, st.text(), st.text())
def test_a_known_value_is_hidden_wherever_it_stands(secret, before, after):
    shown = redact(f"{before}{secret}{after}{secret}", [secret])
    assert secret not in shown.replace(HIDDEN, "")


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

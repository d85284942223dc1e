from hypothesis import given
from hypothesis import strategies as st

from oodscen.report._tolerant_reader import make_printable


@given(st.text(st.characters(codec=None)))
def test_printable_text_can_be_encoded_and_stays_so(text: str) -> None:
    once = make_printable(text)
    once.encode("utf-8")
    assert make_printable(once) == once
    assert not any(ord(char) < 32 and char not in "\t\n\r" for char in once)

"""Claims quote the words that make them."""

import pytest

from oodscen.data._claim import Claim
from oodscen.prompts._scenario.extract_claims import Claims, ExtractClaims

QUESTION = ExtractClaims(text="A deer stands in the lane in fog.")


@pytest.mark.parametrize(
    ("quote", "is_one"),
    [
        ("in fog", True),
        ("FOG.", True),
        ("in the", False),
        ("a", False),
        ("", False),
        ("mist", False),
    ],
)
def test_a_quote_is_in_the_text_and_more_than_articles_and_prepositions(quote, is_one):
    claim = Claim(kind="weather", value="fog", quote=quote)
    assert (QUESTION.check(Claims(claims=[claim])) == []) is is_one

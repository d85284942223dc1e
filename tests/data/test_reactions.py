"""Who tried every action, in words."""

import pytest

from oodscen.data._reactions import drivers_in_words


@pytest.mark.parametrize(
    ("reactions_s", "rehearses", "words"),
    [
        (
            (0.2, 0.5, 0.8),
            True,
            "drivers who react sooner or later, on a road with a little less grip and at a slightly different speed",
        ),
        ((0.2, 0.5), False, "drivers who react sooner or later"),
        (
            (0.25,),
            True,
            "a driver who reacts after 0.25 s, also on a road with a little less grip and at a slightly different speed",
        ),
        ((0.4,), False, "a driver who reacts after 0.4 s"),
    ],
)
def test_only_what_was_varied_is_told(reactions_s, rehearses, words):
    assert drivers_in_words(reactions_s, rehearses=rehearses) == words

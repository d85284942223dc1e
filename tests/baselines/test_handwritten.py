import re

from oodscen._words.text import folded_words
from oodscen.baselines._handwritten import by_subject, handwritten_driving

TEXTS = handwritten_driving().texts


def test_there_are_enough_on_many_subjects_and_all_differ():
    assert len(TEXTS) >= 1200
    assert len({folded_words(text) for text in TEXTS}) == len(TEXTS)
    assert len(by_subject()) >= 60
    assert min(len(texts) for texts in by_subject().values()) >= 5


def test_every_text_is_a_clean_line():
    for text in TEXTS:
        assert re.fullmatch(r"[A-Z0-9].*[.?!]", text), text
        assert text == " ".join(text.split())
        assert 4 <= len(text.split()) <= 32


def test_no_text_tells_of_anything_out_of_the_ordinary():
    strange = r"accident|crash(?! barrier| cushion)|suddenly|flood|overturned|debris|wrong way|swerve|skid|collid|on fire|injured|roadblock|checkpoint"
    assert [text for text in TEXTS if re.search(strange, text, re.IGNORECASE)] == []

"""Whole numbers in English texts, in digits and in words."""

import re

_ONES = "one two three four five six seven eight nine".split()
_TEENS = "ten eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen".split()
_TENS = "twenty thirty forty fifty sixty seventy eighty ninety".split()
_VALUES: dict[str, int] = {
    **{word: number for number, word in enumerate([*_ONES, *_TEENS], 1)},
    **{word: 10 * tens for tens, word in enumerate(_TENS, 2)},
    "single": 1,
    "both": 2,
}
_SCALES = {"thousand": 1000, "hundred": 100, "dozen": 12}
_LIMIT = 1000

_ONE, _TEN, _TEEN = "|".join(_ONES), "|".join(_TENS), "|".join(_TEENS)
_IN_WORDS = re.compile(
    rf"(?:(?:an?|(?P<thousand>{_ONE}))[ -]thousand)?"
    rf"(?:(?:^|[ -](?:and )?)(?:an?|(?P<hundred>{_ONE}))[ -]hundred|^(?:an?|(?P<dozen>{_ONE}))[ -]dozen)?"
    rf"(?:(?:^|[ -](?:and )?)(?P<rest>(?:{_TEN})(?:[ -](?:{_ONE}))?|{_ONE}|{_TEEN}))?"
)
_IN_DIGITS = re.compile(r"([1-9][0-9]{0,2}(?:[, ][0-9]{3})+|[1-9][0-9]{0,3})(?:\.0{1,2})?")

_SCALE = r"(?:(?:(?:an?|several|a few) )?(?:hundred|thousand|million|dozen|score)s?)"
_WORD = rf"(?:{_TEEN}|{_TEN}|{_ONE}|zero|half|{_SCALE})"
_DIGITS = r"[0-9](?:[0-9]|[.,'’ ](?=[0-9]))*"
NUMBER = rf"(?:{_DIGITS}|{_WORD}(?:(?: and (?:an? )?| an? |[ -]){_WORD})*(?!\w))"
"""Regular expression of a number in full, whether it can be read or not."""
COUNT = (
    r"(?!(?:one|half|zero)\b(?! (?:hundred|thousand))"
    rf"|(?:(?:an?|several|a few) )?(?:dozen|score|million)s?\b|several|a few|\w+s of\b){NUMBER}"
)
"""Regular expression of a number in full that counts several things; `one` and `a dozen` are none."""

_BEGINS = re.compile(r"(?:^\s*|(?:[^\W_]|[.,;:!?)\]}\"'”’–—-])\s+|[—(\[])[(\[\"'“‘]*$")
"""Matches text before a number that begins there: nothing, or a word or a sign of sentences and then a blank.

Any other sign belongs to the number and makes it another one.
"""
_EARLIER = rf"(?:(?<![\w:.,-])[0-9][0-9.,'’]*|\b{_WORD}|[½¼¾])"
_METRES = r" ?(?:[ckm]?m|(?:centi|kilo)?met(?:re|er)s?)\b"
_ENDS = re.compile(rf"{_METRES}|\s|(?:[.,:'’](?![0-9])|[;!?)\]}}\"”–—-])|$", re.IGNORECASE)
"""Matches text after a number that ends there: nothing, a blank, a sign of sentences, or metres."""
_JOINT = r"-?,? (?:to|or|and|by|in|till|until|through|plus|x)(?: an?)? "
_APART = r"\s*(?:[^\w\s.;!?()\[\]]|_|\.\.)\W*"
"""A sign that does not end a clause, between two numbers."""
_GOES_ON = re.compile(
    rf"{_EARLIER}(?:(?: ?[^\W\d_]+)?{_JOINT}|(?:{_METRES})?{_APART})$|(?:\b(?:{_TEN}|{_SCALE})|[0-9½¼¾]) $",
    re.IGNORECASE,
)
"""Matches text before a number of metres that is the end of a larger one, of a range, or of a sum."""
_COUNT_GOES_ON = re.compile(
    rf"{_EARLIER}(?:(?:[ -]lanes?)?{_JOINT}|{_APART})$|\b(?:{_TEN}|{_SCALE}) $", re.IGNORECASE
)
_MORE = r"(?: (?:the|an?|some|about|around|roughly|next|first|last))* $"
_CHANGED = (
    "minus|plus|point|times|twice|thrice|double|triple|half(?: of)?"
    "|(?:thirds?|quarters?|fourths?|fifths?|sixths?|eighths?|tenths?|fractions?|per ?cent|multiples?) of"
)
_BOUNDED = re.compile(
    r"\b(?:than|over|under|below|above|beyond|within|up to|upwards? of|at (?:most|least)|between|(?:maxim|minim)\w+(?: of)?"
    rf"|not|not even|exceed(?:s|ing)|every|{_CHANGED}){_MORE}",
    re.IGNORECASE,
)
_BOUNDED_COUNT = re.compile(
    rf"\b(?:than|up to|at most|maximum(?: of)?|almost|nearly|not|not even|no|{_CHANGED}){_MORE}",
    re.IGNORECASE,
)

_OPEN = re.compile(
    rf"(?:{_METRES})?(?: (?:ahead|away|further|down|along|in front|of|on|the|this|ego|car|vehicle|road|street|lane))*"
    r"(?:,? (?:give or take|plus or minus|plus[-/ ]minus|onwards?|(?:and|or) (?:more|less|beyond|further|farther|nearer|closer)(?! \w+s\b))\b"
    r"|,? (?:at (?:most|least)|minimum|maximum)(?! (?:an?|one|two|three)\b))",
    re.IGNORECASE,
)
"""Matches text after a number of metres that makes it a bound, or leaves a range open."""


def whole_number(words: str) -> int | None:
    """Return the whole number from 1 to 1000 that words or digits give; `None` if they give none."""
    plain = re.sub(r"^a (?=single$)", "", words.casefold())
    digits, spoken = _IN_DIGITS.fullmatch(plain), _IN_WORDS.fullmatch(plain)
    if digits:
        value = int(re.sub(r"[, ]", "", digits[1]))
    elif spoken and plain:
        value = sum(_VALUES[part] for part in re.findall(r"\w+", spoken["rest"] or ""))
        for name, scale in _SCALES.items():
            value += scale * _VALUES.get(spoken[name] or "", 1) * (name in plain)
    else:
        value = _VALUES.get(plain, 0)
    return value if 0 < value <= _LIMIT else None


def number_at(text: str, start: int, end: int, *, counts: bool = False) -> int | None:
    """Return the whole number from 1 to 1000 that a text gives between two positions.

    It is `None` if there is none, or if it is part of a larger number, an end of a range, or a bound. If it counts
    things, `at least` and `over` are no bounds.
    """
    lead = text[max(0, start - 40) : start]
    others = (_COUNT_GOES_ON, _BOUNDED_COUNT) if counts else (_GOES_ON, _BOUNDED)
    is_apart = _BEGINS.search(lead) and _ENDS.match(text, end)
    is_open = not counts and _OPEN.match(text, end)
    if is_open or not is_apart or any(other.search(lead) for other in others):
        return None
    return whole_number(text[start:end])

"""Sentences that say in general words that something is ordinary, or that it is not.

They give a direction in an encoder's space, from *ordinary* to *not ordinary*, without an example of either:
each pair is one frame with two words of opposite judgement in it. No sentence tells an event of an OOD
text, and none was taken from one; they were written for English encoders trained on sentences.
"""

from functools import cache

_JUDGEMENTS = """
normal abnormal | usual unusual | routine extraordinary | calm alarming | expected unexpected | familiar strange
| orderly chaotic | safe dangerous | harmless hazardous | correct wrong | legal illegal | intact damaged
| controlled uncontrolled | gentle violent | clear obstructed | common rare | sensible absurd | boring shocking
| uneventful catastrophic | proper improper | everyday freak | tidy wrecked | peaceful frightening
"""
_FRAMES = (
    "The situation in traffic is {}.",
    "A road user does something {}.",
    "Something {} on the road ahead.",
    "The scene is {}.",
    "We drive through a scene that is {}.",
    "{}",
    "Q: How is the road ahead? A: It is {}.",
    "I meet something {} on my way home.",
)
_THINGS = (
    "The car ahead",
    "The lorry",
    "The bus",
    "The cyclist",
    "The motorcyclist",
    "The pedestrian",
    "The animal",
    "The crowd",
    "The police",
    "The weather",
    "The road surface",
    "The traffic light",
    "The bridge",
    "The load",
    "Something beside the road",
    "The other driver",
)
_CONDUCT = (
    ("is where it belongs", "is where it should never be"),
    ("behaves as usual", "behaves as nobody expects"),
    ("is harmless", "is a danger to us"),
    ("is in order", "is broken and out of control"),
    ("leaves our way free", "blocks our way"),
    ("is an ordinary sight", "is a bizarre sight"),
    ("keeps to the rules", "breaks all the rules"),
    ("needs no reaction", "forces us to stop at once"),
)
_SENTENCES = (
    (
        "Q: Is anything unusual? A: No, everything is normal.",
        "Q: Is anything unusual? A: Yes, this is very strange.",
    ),
    ("An ordinary day on the road.", "An extraordinary day on the road."),
    ("Normal driving, nothing to report.", "Emergency while driving, report at once."),
    ("I have seen this a thousand times.", "I have never seen anything like this."),
    ("Everyone stays calm and drives on.", "Everyone panics and nobody can drive on."),
    ("It is safe to continue.", "It is not safe to continue."),
    ("Expected behaviour, no hazard.", "Unexpected behaviour, severe hazard."),
    ("A common situation in everyday traffic.", "A freak incident in everyday traffic."),
    ("The scene is peaceful.", "The scene is chaos."),
    ("Nobody is in danger.", "People are in danger."),
    ("Routine.", "Disaster."),
    ("Everything stays in its place.", "Something has come loose from its place."),
)

Pairs = tuple[tuple[str, str], ...]
"""What is ordinary, and what is not, in the same frame."""


@cache
def anchors() -> tuple[Pairs, Pairs, Pairs]:
    """Return the pairs of three kinds: judgements, conduct of things on the road, sentences."""
    words = [pair.split() for pair in _JUDGEMENTS.split("|")]
    judgements = tuple(
        (_filled(frame, calm), _filled(frame, odd)) for calm, odd in words for frame in _FRAMES
    )
    conduct = tuple(
        (f"{thing} {calm}.", f"{thing} {odd}.") for thing in _THINGS for calm, odd in _CONDUCT
    )
    return judgements, conduct, _SENTENCES


def _filled(frame: str, word: str) -> str:
    text = frame.format(word)
    return text[:1].upper() + text[1:]

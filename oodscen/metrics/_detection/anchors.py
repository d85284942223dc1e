"""Sentences that call something ordinary, or not ordinary, in general words.

They give directions in an encoder's space, from *ordinary* to *not ordinary*. Most pairs are one frame filled
with two
words of opposite judgement. `_KINDS` describes weather, loads, structures, signals and so on, as they should be
and gone
wrong. These are kinds of events, so a detector that uses them knows these kinds beforehand. No sentence was taken
from
an OOD text. All were written by hand, for English encoders trained on sentences, by an author who had read the
*tune*
half of the controls.
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
_KINDS = (
    ("The weather is fine and harmless.", "The weather is violent and destroys things."),
    ("The wind is light.", "The wind throws vehicles about."),
    ("One can see far.", "One can see nothing at all."),
    ("The sky is as on any day.", "Something terrible comes down from the sky."),
    ("The road surface gives good grip.", "The road surface gives no grip at all."),
    ("Cars brake and steer normally.", "Cars slide and spin."),
    ("The liquid stays in its tank.", "The liquid has spilled all over the road."),
    ("The lane is clean and dry.", "The lane is covered and slippery."),
    ("The load is tied down.", "The load has come off."),
    ("The trailer is attached.", "The trailer has broken loose."),
    ("It stays on its vehicle.", "It flies towards us."),
    ("It stands upright beside the road.", "It has collapsed across the road."),
    ("The structure is intact.", "The structure has given way."),
    ("It hangs high above the traffic.", "It has dropped onto the traffic."),
    ("The ground is solid.", "The ground has opened up."),
    ("The signals work.", "The signals have failed."),
    ("The sign is right.", "The sign is false."),
    ("Everyone has a turn in order.", "Everyone goes at the same time."),
    ("The lights are on.", "All lights have gone out."),
    ("The road goes on as the map says.", "The road ends without warning."),
    ("The closure is signed and lit.", "There is an unmarked hole."),
    ("The markings lead the way.", "The markings lead off the road."),
    ("It drives in our direction.", "It drives against the traffic."),
    ("It comes on its own side of the road.", "It comes straight at us in our lane."),
    ("It keeps to its side of the barrier.", "It is on the wrong side of the barrier."),
    ("It slows down gently.", "It stops dead in a live lane."),
    ("It waits until we have passed.", "It shoots out in front of us."),
    ("It indicates and changes lane.", "It swerves into us without warning."),
    ("The vehicle is parked.", "The vehicle is wrecked."),
    ("The bus stands on its wheels.", "The bus lies on its roof."),
    ("There is no damage.", "There is fire and smoke."),
    ("They stand in order.", "They have crashed into each other."),
    ("It is a vehicle that one sees every day.", "It is a thing that has no place on a road."),
    ("It fits into its lane.", "It fills the whole road."),
    ("It moves with the traffic.", "It crawls along the fast lane."),
    ("The animals are behind a fence.", "The animals are loose on the road."),
    ("The animal stays at the roadside.", "The animal runs in front of us."),
    ("A pet on a lead.", "A wild beast in the street."),
    ("People walk on the pavement.", "People run about on the carriageway."),
    ("They cross at the green light.", "They lie in our lane."),
    ("A child holds a hand.", "A child is alone among the cars."),
    ("He stands behind a barrier.", "He hangs on to a moving vehicle."),
    ("The crowd is beside the road.", "The crowd has taken over the road."),
    ("People wait in line.", "People flee in panic."),
    ("The street is free.", "The street is blocked by a mob."),
    ("We may drive on.", "We are stopped and threatened."),
    ("Officers chat.", "Officers chase somebody."),
)

Pairs = tuple[tuple[str, str], ...]
"""Pairs of an ordinary and a not ordinary text in the same frame."""


@cache
def anchors() -> tuple[Pairs, Pairs, Pairs, Pairs]:
    """Return the four sorts of pairs: judgements, conduct of things on the road, sentences, kinds of events."""
    words = [pair.split() for pair in _JUDGEMENTS.split("|")]
    judgements = tuple(
        (_filled(frame, calm), _filled(frame, odd)) for calm, odd in words for frame in _FRAMES
    )
    conduct = tuple(
        (f"{thing} {calm}.", f"{thing} {odd}.") for thing in _THINGS for calm, odd in _CONDUCT
    )
    return judgements, conduct, _SENTENCES, _KINDS


def _filled(frame: str, word: str) -> str:
    text = frame.format(word)
    return text[:1].upper() + text[1:]

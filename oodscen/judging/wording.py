"""How people name the discrete actions, in text brought to one form."""

import re
import unicodedata
from bisect import bisect
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen.judging.languages import FOREIGN_ACTIONS
from oodscen.judging.patterns import compiled, either, few

# ------------------------------------------------------------------ one form for all text


def normalise(text: str) -> str:
    """Return text in which wording is looked for: lower case, plain marks, no markup.

    Lines stay; underscores and hyphens between letters become spaces, `camelCase` is taken apart.
    """
    text = _squeezed(unicodedata.normalize("NFKC", text))
    text = _INVISIBLE.sub("", text)
    text = text.replace("\u3002", ". ").replace("\u3001", ", ")
    text = re.sub(r"[\u2018\u2019\u02bc]", "'", text)
    text = _CAMEL_CASE.sub(lambda found: re.sub(r"(?<=[a-z])(?=[A-Z])", " ", found.group()), text)
    text = _LATEX.sub(r"\1", text)
    text = text.casefold()
    text = _MARKUP.sub(" ", text)
    text = _HYPHEN.sub(" ", text)
    text = _DASH.sub(" \u2014 ", text)
    return _squeezed(text).strip()


_INVISIBLE = re.compile(
    r"[\u200b-\u200f\u2060\ufeff\u00ad\ufe0f\u20e3\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]"
)
_CAMEL_CASE = re.compile(r"\b(?:[a-z]+)(?:[A-Z][a-z]+)+\b|\b(?:[A-Z][a-z]+){2,}\b")
_LATEX = re.compile(r"\\(?:text(?:bf|tt|rm)?|math(?:rm|bf|tt))\s*\{([^{}\n]*)\}")
_MARKUP = re.compile(r"[*`\"_~#>\u201c\u201d\u00ab\u00bb]|\\(?=[_*])")
_HYPHEN = re.compile(r"(?<=[a-z])[-\u2010\u2011](?=[a-z])")
_DASH = re.compile(r"[^\S\n]*[\u2013\u2014][^\S\n]*|(?<=\S)[^\S\n]+--?\s+")


def _squeezed(text: str) -> str:
    return re.sub(r" ?\n[\n ]*", "\n", re.sub(r"[^\S\n]+", " ", text))


# ------------------------------------------------------------------ where options are named


class Mention(NamedTuple):
    """Where a text names an option."""

    start: int
    end: int
    option: str
    """Its id."""


def find_actions(text: str, offered: Sequence[str]) -> list[Mention]:
    """Find where a normalised text names one of the offered actions; the longest name wins."""
    found = []
    for name in offered:
        finder = _FINDERS.get(name) or re.compile(rf"\b{re.escape(normalise(name))}\b")
        for match in finder.finditer(text):
            is_place = name == "stop" and _STOPPING_PLACE.search(
                text[max(0, match.start() - 12) : match.start()]
            )
            if match.group() and not is_place:
                found.append(Mention(match.start(), match.end(), name))
    return longest(found)


def longest(found: Sequence[Mention]) -> list[Mention]:
    """Keep the longest of mentions that overlap; return them in order."""
    kept: list[Mention] = []
    for one in sorted(found, key=lambda m: (m.start - m.end, m.start)):
        place = bisect(kept, one)
        before = kept[place - 1].end if place else 0
        after = kept[place].start if place < len(kept) else one.end
        if before <= one.start and one.end <= after:
            kept.insert(place, one)
    return kept


_STOPPING_PLACE = compiled(r"\b(?:bus|tram|truck|pit|rest|taxi|coach|non|short) *-? *$")
"""Before a "stop" that is no action: "bus stop", "non-stop", "truck stop"."""

# ------------------------------------------------------------------ words for the actions

_OWN = r"(?:(?:the|my|your|its|our|a|this|same|present|current|constant|steady|initial|original) )*"
_HALT = either(r"stop(?:ping)?", r"halt(?:ing)?", r"park(?:ing)?")
_BRAKING = r"brak(?:e|ing)"
_APPLY = r"(?:appl|us|press)(?:y|e|ing)? (?:the )?brakes?"
_THE_CAR = r"the (?:car|vehicle|ego)"
_GENTLY = r"(?:gently|lightly|softly|slightly|gradually)"
_COMFORTABLY = r"(?:comfortably|normally|smoothly|steadily|moderately|calmly)"
_MOVE = either(
    r"chang(?:e|ing)",
    r"mov(?:e|ing)",
    r"merg(?:e|ing)",
    r"shift(?:ing)?",
    r"switch(?:ing)?",
    r"swerv(?:e|ing)",
    r"steer(?:ing)?",
    r"veer(?:ing)?",
    r"cut(?:ting)?",
    r"go(?:ing)?",
    r"get(?:ting)?",
    r"turn(?:ing)?",
    r"evad(?:e|ing)",
    r"dodg(?:e|ing)",
    r"div(?:e|ert)(?:ing)?",
)


def _sideways(side: str) -> str:
    """Return how one changes to the lane on a side."""
    other = "right" if side == "left" else "left"
    lanes = r"(?:lanes?|sides?)"
    way = rf"(?:on|in|over|on ?to|in ?to|to|towards?|for)? *{_OWN}"
    across = r"(?:over |across |out )*"
    neighbour = (
        r"(?:next|adjacent|neighbou?ring|free|empty|open|outer|inner|oncoming)?"
        rf" *{lanes}? *(?:on |to )?{_OWN}"
    )
    not_its_edge = (
        r"(?! *(?:hand )?"
        r"(?:edge|shoulder|kerb|curb|side of the road|roadside|verge"
        r"|away|now|behind|in front|ahead)\b)"
    )
    return either(
        rf"(?:lane )?chang(?:e|ing) *{lanes}? *(?:over )?{way} *{side}(?: hand)?(?: lane)?"
        + not_its_edge,
        rf"{_MOVE} (?:over |across |out |(?:(?:one|a|1) )?lanes? )*{way} *{side}"
        rf"(?: hand)?(?: (?:lane|side))?{not_its_edge}",
        rf"{_MOVE} {across}(?:in ?to|on ?to|to) the {neighbour} *{side}{not_its_edge}",
        rf"(?:tak(?:e|ing)|us(?:e|ing)) (?:the|my|your) {side}(?: hand)? lane",
        rf"{side} (?:hand )?lane change",
        rf"lane *chang(?:e|ing),? (?:(?:on *to|in *to|to|towards?) )?{_OWN}{side}",
        r"(?:overtak(?:e|ing)|pass(?:ing)?|go(?:ing)? a?round)(?: \w+){0,3} (?:on|to|via) the "
        rf"{side}(?: side| lane)?",
        rf"(?:lane|action) {side}\b",
        # "left or right", "left/right": the second of two sides
        rf"(?<={other}\s)(?:lane )?(?:or|and|/) (?:to )?(?:the )?{side}\b",
        rf"(?<={other})/{side}\b",
    )


def _pulling_over() -> str:
    """Return how one leaves the road at its edge and stops there."""
    of_the_road = r"(?: of the road)?"
    at_the_side = (
        r"the (?:right )?(?:(?:hard )?shoulder|roadside|side|edge|verge|kerb|curb|lay ?by)"
        + of_the_road
    )
    to_the_edge = (
        r"the (?:right )?(?:(?:hard )?shoulder|roadside|edge|verge|kerb|curb|side)" + of_the_road
    )
    return either(
        r"pull(?:ing)? *(?:over|off|aside|in)\b"
        r"(?: (?:on )?to the (?:right|side|shoulder))?"
        r"(?: (?:and|then) (?:stop(?:ping)?|halt|park))?"
        rf"(?: (?:on|at) the (?:right )?(?:shoulder|roadside|side|edge|verge){of_the_road})?",
        r"pull(?:ing)? (?:up )?(?:on ?to|to|in ?to) the (?:right(?: hand)? *)?"
        r"(?:(?:hard )?shoulder|roadside|side|edge|verge|right|kerb|curb|lay ?by)"
        rf"{of_the_road}(?: and (?:stop|halt|park)\w*)?",
        r"(?:slow(?:ing)?(?: down)? *(?:,|and)? *(?:then )?)?"
        rf"{_MOVE} (?:over )?(?:on ?to|to|in ?to) {to_the_edge}"
        r"(?: or (?:(?:on|to) )?the shoulder)?"
        r"(?:(?:,| and| to)+ (?:stop|halt|park)\w*(?: there)?)?",
        rf"(?:{_HALT}|com(?:e|ing) to a (?:stop|halt)) (?:on|at|by|in|along) {at_the_side}",
        r"park(?:ing)? (?:the (?:car|vehicle) )?(?:on|at|by) the (?:shoulder|roadside|side)",
    )


def _braking_hard() -> str:
    """Return how one brakes as hard as one can."""
    as_hard_as = r"as hard as(?: \w+){0,3}"
    to_a_stop = r"(?: to a (?:stop|halt))?"
    return either(
        r"(?:(?:perform|do|make) )?(?:an? )?"
        r"(?:emergency|panic|crash|full|hard|maximum|max|maximal|immediate hard"
        r"|strong|heavy|harsh|sharp)"
        rf" *-? *brak(?:e|es|ing)\b{to_a_stop}",
        r"(?:emergency|panic|crash) *-? *stop(?:ping)?",
        rf"{_BRAKING} "
        + either(
            as_hard_as,
            r"(?:(?:very|really) )?"
            + either(
                r"hard|sharply|fully|firmly|heavily|violently",
                r"at once and hard",
                r"with (?:full|maximum|all) (?:force|power|strength)",
            ),
        )
        + to_a_stop,
        r"(?:appl|us|press|hit)(?:y|e|ing)? (?:the )?brakes? "
        rf"(?:hard|firmly|fully|heavily|sharply|{as_hard_as}|with (?:full|maximum) \w+)",
        r"(?:slam(?:ming)?|stamp(?:ing)?|jam(?:ming)?|stomp(?:ing)?|stand(?:ing)?) (?:on )?"
        r"(?:the )?brakes?(?: on)?",
        r"stop(?:ping)? as (?:hard|quickly|fast|abruptly) as "
        r"(?:possible|the road allows|(?:i|we) can)",
        r"\baeb\b",
    )


def _stopping() -> str:
    """Return how one brakes comfortably to a stop."""
    manner = r"(?:complete|full|smooth|controlled|comfortable|safe)"
    standstill = r"(?:stop|halt|standstill)"
    return either(
        rf"{_BRAKING} (?:(?:{_COMFORTABLY}|gently|softly|gradually|slowly) )?"
        rf"to (?:a )?(?:{manner} )?{standstill}",
        rf"{_BRAKING} {_COMFORTABLY}",
        r"(?:comfortabl[ey]|normal(?:ly)?|smooth(?:ly)?|moderate(?:ly)?|controlled)"
        rf" (?:{_BRAKING}|stop)",
        either(
            r"slow(?:ing)?(?: down)?",
            r"decelerat\w+",
            r"com(?:e|ing)",
            r"bring(?:ing)? (?:the )?(?:car|vehicle|ego(?: vehicle)?|it)",
        )
        + rf" (?:\w+ )?to an? (?:(?:{manner}|gentle) )*{standstill}",
        rf"(?:{_BRAKING}|slow(?:ing)? down|decelerat\w+) (?:{_GENTLY} )?and (?:come to a )?{standstill}",
        r"(?:a )?(?:complete|full|dead|safe) stop",
        r"\bstop(?:ping)?\b"
        # no action: "stop sign", "a stop over", "stop thinking"
        r"(?! (?:signs?|lines?|lights?|signals?|lamps?|watch|motion|over|by|at nothing))"
        r"(?! (?!moving|driving|keeping)\w+ing\b)"
        rf"(?: {_THE_CAR}(?: vehicle)?)?",
        r"\bhalt(?:ing)?\b(?! (?:sign|line))",
        r"\bstand ?still\b",
    )


def _slowing_down() -> str:
    """Return how one slows down without stopping."""
    speed = r"(?:speed|velocity|pace)"
    return either(
        r"slow *down\b(?: (?:gently|gradually|carefully|slightly))?",
        rf"{_BRAKING} (?:{_GENTLY}|a (?:bit|little))",
        rf"(?:gentl[ey]|light(?:ly)?|soft(?:ly)?|slight(?:ly)?|mild(?:ly)?) {_BRAKING}",
        r"slowing(?: down)?\b",
        rf"{_APPLY} {_GENTLY}",
        # an order, not a description: "slow traffic"
        rf"\bslow\b(?= *(?:{_THE_CAR}|to\b|gently|gradually|carefully|[.,;!]|$))",
        r"decelerat(?:e|ing|ion)\b(?: (?:gently|gradually|smoothly))?",
        r"(?:reduc|lower|decreas|halv|cut|drop|eas)(?:e|ing|ting|ping|t|p)? "
        rf"{_OWN}{speed}(?: (?:by|to) half)?",
        r"(?:eas(?:e|ing)|lift(?:ing)?|com(?:e|ing)|let(?:ting)?) (?:off|up)"
        r"(?: (?:on )?(?:the )?(?:gas|throttle|accelerator|pedal))?",
        r"half (?:(?:the|my|its) )?speed",
        r"speed reduction",
    )


def _keeping_on() -> str:
    """Return how one drives on as before."""
    this_speed = r"(?: at (?:the )?(?:same|current|this|present) speed)?"
    as_before = either(
        r"to driv\w+",
        r"driving|straight|forwards?|ahead",
        r"as (?:is|before|normal|planned|usual)",
        r"normally|unchanged",
        r"in (?:the )?lane",
        rf"(?:at|with) {_OWN}speed",
        r"on (?:my|the|its) (?:way|course)",
    )
    return either(
        r"(?:keep|maintain|hold|retain|preserv)(?:e|ing)? *(?:(?:up|to|at|with) )?"
        rf"{_OWN}(?:lane and (?:the )?)?(?:speed|velocity|pace)\b",
        r"keep(?:ing)? (?:on )?(?:going|driving|moving|cruising|rolling)"
        rf"(?: (?:straight|forwards?|on|ahead))?{this_speed}",
        rf"(?:continu|proceed)(?:e|ing)? (?:on )?(?:{as_before} *)+",
        r"\b(?:continue|proceed)\b(?= *(?:[.!,]|$))",
        r"(?:driv(?:e|ing)|carry(?:ing)?|go(?:ing)?) (?:straight )?on\b(?! (?:the|a|to)\b)",
        rf"(?:stay|remain|travel|driv)(?:e|ing)? {few(3)}(?:at|on) (?:the )?"
        r"(?:same|current|present|constant|this) (?:speed|course)",
        r"stay(?:ing)? (?:on |the )*course",
        r"\bcruis(?:e|ing)\b",
        r"(?:no|without) (?:change (?:of|in) speed|braking (?:needed|required|necessary))",
        r"do(?:ing)? nothing\b",
        r"speed unchanged",
    )


ACTION_WORDS: Mapping[str, str] = {
    "pull_over": _pulling_over(),
    "emergency_brake": _braking_hard(),
    "change_lane_left": _sideways("left"),
    "change_lane_right": _sideways("right"),
    "slow_down": _slowing_down(),
    "keep_speed": _keeping_on(),
    "stop": _stopping(),
}
"""By action id: a source of `oodscen.judging.patterns` over normalised text."""

_FINDERS = {name: compiled(words, FOREIGN_ACTIONS[name]) for name, words in ACTION_WORDS.items()}

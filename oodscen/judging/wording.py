"""How people name the discrete actions, and how they reject, correct and conclude."""

import re
import unicodedata
from bisect import bisect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from oodscen.judging.languages import ANSWER, CONDITION, DENIAL, FOREIGN_ACTIONS, IS


class Mention(NamedTuple):
    """Where a text names an option."""

    start: int
    end: int
    option: str
    """Its id."""


_LANES = r"(?:lanes?|sides?)"
_OWN = (
    r"(?:(?:the|my|your|its|our|a|this|same|present|current|constant|steady|initial|original)\s+)*"
)
_MOVE = (
    r"(?:chang(?:e|ing)|mov(?:e|ing)|merg(?:e|ing)|shift(?:ing)?|switch(?:ing)?|swerv(?:e|ing)|steer(?:ing)?"
    r"|veer(?:ing)?|cut(?:ting)?|go(?:ing)?|get(?:ting)?|turn(?:ing)?|evad(?:e|ing)|dodg(?:e|ing)|div(?:e|ert)(?:ing)?)"
)


def _sideways(side: str) -> str:
    other = "right" if side == "left" else "left"
    way = rf"(?:on|in|over|on ?to|in ?to|to|towards?|for)?\s*{_OWN}"
    beside = rf"(?:next|adjacent|neighbou?ring|free|empty|open|outer|inner|oncoming)?\s*{_LANES}?\s*(?:on\s+|to\s+)?{_OWN}"
    edge = r"(?!\s*(?:hand\s+)?(?:edge|shoulder|kerb|curb|side of the road|roadside|verge|away|now|behind|in front|ahead)\b)"
    return "|".join(
        (
            rf"(?:lane\s+)?chang(?:e|ing)\s*{_LANES}?\s*(?:over\s+)?{way}\s*{side}(?:\s+hand)?(?:\s+lane)?{edge}",
            rf"{_MOVE}\s+(?:over\s+|across\s+|out\s+|(?:one\s+|a\s+|1\s+)?lanes?\s+)*{way}\s*{side}(?:\s+hand)?(?:\s+(?:lane|side))?{edge}",
            rf"{_MOVE}\s+(?:over\s+|across\s+|out\s+)*(?:in ?to|on ?to|to)\s+the\s+{beside}\s*{side}{edge}",
            rf"(?:tak(?:e|ing)|us(?:e|ing))\s+(?:the|my|your)\s+{side}(?:\s+hand)?\s+lane",
            rf"{side}\s+(?:hand\s+)?lane\s+change",
            rf"lane\s*chang(?:e|ing),?\s+(?:(?:on\s*to|in\s*to|to|towards?)\s+)?{_OWN}{side}",
            rf"(?:overtak(?:e|ing)|pass(?:ing)?|go(?:ing)? (?:a)?round)(?:\s+\w+){{0,3}}\s+(?:on|to|via)\s+the\s+{side}(?:\s+side|\s+lane)?",
            rf"(?:lane|action)\s+{side}\b",
            rf"(?<={other} )(?:lane\s+)?(?:or|and|/)\s+(?:to\s+)?(?:the\s+)?{side}\b|(?<={other})/{side}\b",
        )
    )


ACTION_WORDS: Mapping[str, str] = {
    "pull_over": "|".join(
        (
            r"pull(?:ing)?\s*(?:over|off|aside|in)\b(?:\s+(?:on\s+)?to\s+the\s+(?:right|side|shoulder))?(?:\s+(?:and|then)\s+(?:stop(?:ping)?|halt|park))?(?:\s+(?:on|at)\s+the\s+(?:right\s+)?(?:shoulder|roadside|side|edge|verge)(?:\s+of\s+the\s+road)?)?",
            r"pull(?:ing)?\s+(?:up\s+)?(?:on ?to|to|in ?to)\s+the\s+(?:right(?:\s+hand)?\s*)?(?:(?:hard\s+)?shoulder|roadside|side|edge|verge|right|kerb|curb|lay ?by)(?:\s+of\s+the\s+road)?(?:\s+and\s+(?:stop|halt|park)\w*)?",
            rf"(?:slow(?:ing)?(?:\s+down)?\s*(?:,|and)?\s*(?:then\s+)?)?{_MOVE}\s+(?:over\s+)?(?:on ?to|to|in ?to)\s+the\s+(?:right\s+)?(?:hard\s+)?(?:shoulder|roadside|edge|verge|kerb|curb|side)(?:\s+of\s+the\s+road)?(?:\s+or\s+(?:on\s+|to\s+)?the\s+shoulder)?(?:(?:,|\s+and|\s+to)+\s+(?:stop|halt|park)\w*(?:\s+there)?)?",
            r"(?:stop(?:ping)?|halt(?:ing)?|park(?:ing)?|com(?:e|ing)\s+to\s+a\s+(?:stop|halt))\s+(?:on|at|by|in|along)\s+the\s+(?:right\s+)?(?:(?:hard\s+)?shoulder|roadside|side|edge|verge|kerb|curb|lay ?by)(?:\s+of\s+the\s+road)?",
            r"park(?:ing)?\s+(?:the\s+(?:car|vehicle)\s+)?(?:on|at|by)\s+the\s+(?:shoulder|roadside|side)",
        )
    ),
    "emergency_brake": "|".join(
        (
            r"(?:perform\s+|do\s+|make\s+)?(?:an?\s+)?(?:emergency|panic|crash|full|hard|maximum|max|maximal|immediate\s+hard|strong|heavy|harsh|sharp)\s*-?\s*(?:brak(?:e|es|ing)\b)(?:\s+to\s+a\s+(?:stop|halt))?",
            r"(?:emergency|panic|crash)\s*-?\s*stop(?:ping)?",
            r"brak(?:e|ing)\s+(?:as\s+hard\s+as(?:\s+\w+){0,3}|(?:very\s+|really\s+)?(?:hard|sharply|fully|firmly|heavily|violently|at\s+once\s+and\s+hard|with\s+(?:full|maximum|all)\s+(?:force|power|strength)))(?:\s+to\s+a\s+(?:stop|halt))?",
            r"(?:appl|us|press|hit)(?:y|e|ing)?\s+(?:the\s+)?brakes?\s+(?:hard|firmly|fully|heavily|sharply|as\s+hard\s+as(?:\s+\w+){0,3}|with\s+(?:full|maximum)\s+\w+)",
            r"(?:slam(?:ming)?|stamp(?:ing)?|jam(?:ming)?|stomp(?:ing)?|stand(?:ing)?)\s+(?:on\s+)?(?:the\s+)?brakes?(?:\s+on)?",
            r"stop(?:ping)?\s+as\s+(?:hard|quickly|fast|abruptly)\s+as\s+(?:possible|the\s+road\s+allows|(?:i|we)\s+can)",
            r"\baeb\b",
        )
    ),
    "change_lane_left": _sideways("left"),
    "change_lane_right": _sideways("right"),
    "slow_down": "|".join(
        (
            r"slow\s*down\b(?:\s+(?:gently|gradually|carefully|slightly))?",
            r"(?:brak(?:e|ing)\s+(?:gently|lightly|softly|slightly|gradually|a\s+(?:bit|little))|(?:gentl[ey]|light(?:ly)?|soft(?:ly)?|slight(?:ly)?|mild(?:ly)?)\s+brak(?:e|ing))",
            r"slowing(?:\s+down)?\b",
            r"(?:appl|us|press)(?:y|e|ing)?\s+(?:the\s+)?brakes?\s+(?:gently|lightly|softly|slightly|gradually)",
            r"\bslow\b(?=\s*(?:the\s+(?:car|vehicle|ego)|to\b|gently|gradually|carefully|[.,;!]|$))",
            r"decelerat(?:e|ing|ion)\b(?:\s+(?:gently|gradually|smoothly))?",
            rf"(?:reduc|lower|decreas|halv|cut|drop|eas)(?:e|ing|ting|ping|t|p)?\s+{_OWN}(?:speed|velocity|pace)(?:\s+(?:by|to)\s+half)?",
            r"(?:eas(?:e|ing)|lift(?:ing)?|com(?:e|ing)|let(?:ting)?)\s+(?:off|up)(?:\s+(?:on\s+)?(?:the\s+)?(?:gas|throttle|accelerator|pedal))?",
            r"half\s+(?:the\s+|my\s+|its\s+)?speed",
            r"speed\s+reduction",
        )
    ),
    "keep_speed": "|".join(
        (
            rf"(?:keep|maintain|hold|retain|preserv)(?:e|ing)?\s*(?:up\s+|to\s+|at\s+|with\s+)?{_OWN}(?:lane\s+and\s+(?:the\s+)?)?(?:speed|velocity|pace)\b",
            r"keep(?:ing)?\s+(?:on\s+)?(?:going|driving|moving|cruising|rolling)(?:\s+(?:straight|forwards?|on|ahead))?(?:\s+at\s+(?:the\s+)?(?:same|current|this|present)\s+speed)?",
            rf"(?:continu|proceed)(?:e|ing)?\s+(?:on\s+)?(?:(?:to\s+driv\w+|driving|straight|forwards?|ahead|as\s+(?:is|before|normal|planned|usual)|normally|unchanged|in\s+(?:the\s+)?lane|at\s+{_OWN}speed|with\s+{_OWN}speed|on\s+(?:my|the|its)\s+(?:way|course))\s*)+",
            r"\bcontinue\b(?=\s*(?:[.!,]|$))",
            r"\bproceed\b(?=\s*(?:[.!,]|$))",
            r"(?:driv(?:e|ing)|carry(?:ing)?|go(?:ing)?)\s+(?:straight\s+)?on\b(?!\s+(?:the|a|to)\b)",
            r"(?:stay|remain|travel|driv)(?:e|ing)?\s+(?:\w+\s+){0,3}?(?:at|on)\s+(?:the\s+)?(?:same|current|present|constant|this)\s+(?:speed|course)",
            r"stay(?:ing)?\s+(?:on\s+|the\s+)*course",
            r"\bcruis(?:e|ing)\b",
            r"(?:no|without)\s+(?:change\s+(?:of|in)\s+speed|braking\s+(?:needed|required|necessary))",
            r"do(?:ing)?\s+nothing\b",
            r"speed\s+unchanged",
        )
    ),
    "stop": "|".join(
        (
            r"(?:brak(?:e|ing)\s+(?:(?:comfortably|normally|smoothly|steadily|moderately|calmly|gently|softly|gradually|slowly)\s+)?(?:to\s+(?:a\s+)?(?:(?:complete|full|smooth|controlled|comfortable|safe)\s+)?(?:stop|halt|standstill)))",
            r"brak(?:e|ing)\s+(?:comfortably|normally|smoothly|steadily|moderately|calmly)|(?:comfortabl[ey]|normal(?:ly)?|smooth(?:ly)?|moderate(?:ly)?|controlled)\s+(?:brak(?:e|ing)|stop)",
            r"(?:slow(?:ing)?(?:\s+down)?|decelerat\w+|com(?:e|ing)|bring(?:ing)?\s+(?:the\s+)?(?:car|vehicle|ego(?:\s+vehicle)?|it))\s+(?:\w+\s+)?to\s+an?\s+(?:(?:complete|full|smooth|controlled|comfortable|safe|gentle)\s+)*(?:stop|halt|standstill)",
            r"(?:a\s+)?(?:complete|full|dead|safe)\s+stop",
            r"\bstop(?:ping)?\b(?!\s+(?:signs?|lines?|lights?|signals?|lamps?|watch|motion|over|by|at\s+nothing|using|worrying))(?:\s+(?:the\s+(?:car|vehicle|ego(?:\s+vehicle)?)))?",
            r"\bhalt(?:ing)?\b(?!\s+(?:sign|line))",
            r"\bstand\s+still\b|\bstandstill\b",
        )
    ),
}
"""By action id: a regular expression over normalised text (see `normalise`)."""

_NOT_STOP = re.compile(r"\b(?:bus|tram|truck|pit|rest|taxi|coach|non|short)\s*-?\s*$")
_FINDERS = {
    name: re.compile(f"{words}|{FOREIGN_ACTIONS[name]}") for name, words in ACTION_WORDS.items()
}


def normalise(text: str) -> str:
    """Return text in which wording is looked for: lower case, plain marks, no markup.

    Lines stay; underscores and hyphens between letters become spaces, `camelCase` is taken apart.
    """
    text = unicodedata.normalize("NFKC", text)
    text = _squeezed(text)
    text = re.sub(
        r"[\u200b-\u200f\u2060\ufeff\u00ad\ufe0f\u20e3\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]",
        "",
        text,
    )
    text = re.sub(r"[\u3002\u3001]", lambda mark: ". " if mark.group() == "\u3002" else ", ", text)
    text = re.sub(r"[\u2018\u2019\u02bc]", "'", text)
    text = re.sub(r"\b(?:[a-z]+)(?:[A-Z][a-z]+)+\b|\b(?:[A-Z][a-z]+){2,}\b", _apart, text)
    text = re.sub(r"\\(?:text(?:bf|tt|rm)?|math(?:rm|bf|tt))\s*\{([^{}\n]*)\}", r"\1", text)
    text = text.casefold()
    text = re.sub(r"[*`\"_~#>\u201c\u201d\u00ab\u00bb]|\\(?=[_*])", " ", text)
    text = re.sub(r"(?<=[a-z])[-\u2010\u2011](?=[a-z])", " ", text)
    text = re.sub(r"[^\S\n]*[\u2013\u2014][^\S\n]*|(?<=\S)[^\S\n]+--?\s+", " \u2014 ", text)
    return _squeezed(text).strip()


def _squeezed(text: str) -> str:
    return re.sub(r" ?\n[\n ]*", "\n", re.sub(r"[^\S\n]+", " ", text))


def _apart(match: re.Match[str]) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", match.group())


def find_actions(text: str, offered: Sequence[str]) -> list[Mention]:
    """Find where a normalised text names one of the offered actions; the longest name wins."""
    found = []
    for name in offered:
        finder = _FINDERS.get(name) or re.compile(rf"\b{re.escape(normalise(name))}\b")
        for match in finder.finditer(text):
            if match.end() == match.start():
                continue
            if name == "stop" and _NOT_STOP.search(
                text[max(0, match.start() - 12) : match.start()]
            ):
                continue
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


# ------------------------------------------------------------------ how a mention is meant

_NEGATIONS = re.compile(
    r"\b(?:not|n't|dont|cannot|cant|wont|never|neither|nor|no|isnt|doesnt|shouldnt|nicht|kein\w*|statt|anstatt|ohne|sans|sin|pas|au\s+lieu\s+de|en\s+lugar\s+de"
    r"|instead\s+of|rather\s+than|(?:as\s+)?opposed\s+to|rul(?:e|es|ed|ing)\s+out|reject(?:s|ed|ing)?|exclud(?:e|ed|ing)"
    r"|discard(?:ed|ing)?|dismiss(?:ed|ing)?|unsafe\s+to|dangerous\s+to|risky\s+to|too\s+(?:late|dangerous|risky|close|fast)\s+to|impossible\s+to"
    r"|(?:unnecessary|unwise|mistake|wrong|reckless|foolish|fatal)\s+to|(?:worst|bad)\s+(?:choice|option|idea|action)\s+(?:is|would\s+be)|hardly|less\s+\w+\s+than|better\s+than|safer\s+than|over\s+just)\b"
    r"|(?<=[a-z])n't\b"
)
_NEAR_NEGATIONS = re.compile(
    r"\b(?:avoid(?:ing)?|without|instead\s+of|except|against|unlike|than|no\s+more)\s+(?:\w+\s+){0,1}$|\bover\s+$"
)
_SCOPE_ENDS = re.compile(
    r"[.;!?\n\u2014]|\b(?:but|however|so|therefore|thus|hence|then|instead(?!\s+of)|rather(?!\s+than)|because|since|sondern|(?:and|i)\s+(?:will\s+|would\s+)?(?:choose|pick|select|go|take|opt))\b|:(?!\S)"
)
_AFTERWARDS = re.compile(
    r"^\s*(?:\w+\s+){0,3}?(?:(?:is|are|would\s+be|will\s+be|seems|looks|was|'s)\s+(?:\w+\s+){0,2}?"
    r"(?:not\s+(?:safe|possible|available|advisable|needed|necessary|enough|ideal|good|recommended|an?\b)|unsafe|dangerous|risky|riskier|impossible|unavailable|blocked|unnecessary|insufficient|inadequate|worse|wrong|out\s+of|excessive|overkill"
    r"|a\s+bad|the\s+worst|a\s+mistake|ruled|rejected|no\s+(?:good|option|longer)|too\b)"
    r"|(?:is|are|would|wo|ca|do|does|could|should|can)\s*(?:n't|not\b)|cannot|can't|won't|isn't|doesn't|wouldn't|never\s+works"
    r"|would\s+(?:\w+\s+)?(?:hit|collide|cause|risk|fail|lead|end|result|put|be\s+(?:too|un|dangerous|risky|hit))"
    r"|(?:fails?|risks?|leads?\s+to\s+a\s+(?:crash|collision))\b|\?)"
)
_HEDGES = re.compile(
    r"\b(?:could|might|may|maybe|perhaps|possibly|consider(?:ed|ing)?|possible|if|unless|whether|options?(?:\s+are|\s+include|:)|between|either|alternativ\w+"
    r"|otherwise|ahead|pedestrians?|they|he|she|although|though|while|at\s+first(?:\s+glance|\s+sight)?|initially|first\s+(?:idea|thought|instinct|impulse)|in\s+principle|usually|second\s+best"
    r"|(?:prepared?|ready|readiness|able)\s+to|ready\s+for)\b[^.;!?\n,]*$"
)
_HEDGED_AFTER = re.compile(
    r"^\s*(?:could|might|may|is\s+(?:an|one|another)\s+option|(?:is|would\s+be|seems)\s+(?:also\s+)?(?:possible|feasible|tempting|acceptable|an\s+option))\b"
)
_CONDITIONED = re.compile(
    r"\b(?:if|unless|in\s+case)\b[^,]*,[^,]*$|\b(?:otherwise|else|if\s+not)\b[^.;!?\n]*$"
)
CROSS = r"[\u274c\u274e\u2716\u2717\u2718\u00d7\U0001f6ab]"
TICK = r"[\u2705\u2611\u2713\u2714]"
_CRASHES = re.compile(
    r"\s*,?\s*(?:we|i|it|the\s+\w+)\s+(?:may|might|could|would|will|'d|'ll)\s+(?:\w+\s+)?(?:collide|hit|crash)"
)
_TICKED = re.compile(rf"^\W*{TICK}\W*$")
_EARLIER = re.compile(
    r"\b(?:initially|at\s+first|originally|(?:would|'d)\s+have\s+(?:said|chosen|picked))\b[^.;!?\n]*$"
)
_LATER_CHOICE = re.compile(
    r"\b(?:(?:second|2nd|third|3rd)(?!\s+(?:frame|image|picture|photo|lane|vehicle|car))|alternative|alternatively|backup|back\s+up|fallback|runner\s+up|next\s+best)\b[^.;!?\n]*$"
)
_CLAUSE = re.compile(r"[.;!?,:\n\u2014]")
_FALLBACK = re.compile(r"\bor\s+(?:\w+\s+)?$")
_CONDITION = re.compile(r"^\s*(?:if|when|in\s+case|should|as\s+needed|only\s+if)\b")
_MARKED_WRONG = re.compile(
    rf"^\s*(?:[(:\u2014-]\s*)?(?:no\b|{CROSS})"
    r"|^\s*[(:\u2014-]\s*(?:\w+ly\s+)?(?:not\s+(?:safe|possible|available|advisable|needed|necessary|enough|ideal|good|recommended|an?\b)|unsafe|dangerous|too|impossible|unnecessar\w+|risky|insufficient|excessive|wrong|overkill)\b"
)
CORRECTIONS = re.compile(
    r"(?:^|[\s.,;!?\u2014(])(?:wait\b|actually\b|no,|no\.\.+|nope\b|correction\b|scratch\s+that|on\s+second\s+thou?ghts?|let\s+me\s+(?:reconsider|rethink|correct)|hold\s+on"
    r"|i\s+take\s+(?:that|it)\s+back|i\s+(?:was\s+wrong|misspoke|meant|mean)\b|sorry,|oops|hmm,?\s+no|strike\s+that|revis(?:ed|ing|ion)\b|changed?\s+my\s+mind|edit:|my\s+mistake)"
)
FINAL = re.compile(
    r"(?:final(?:ly)?\s+(?:answer|choice|decision|action|verdict|selection|output|recommendation)|\banswer|\bans|\bverdict|\bfinal|\baction|\bchoice|\bdecision|\bchosen(?:\s+action)?|\bselected(?:\s+action)?|\bselection|\brecommendation|\bconclusion|\boutput|\bresult|\bboxed|(?<![a-z])(?:"
    + ANSWER
    + r")|<\s*(?:answer|action|choice|final)\b[^a-z]*)"
    r"\s*(?:is|"
    + IS
    + r"|was|would\s+be|=+|:+|\u2014|->|\u2192|\{|\(|\)|\]|\s)+\s*(?:to\s+|option\s+|action\s+)?"
)
CHOICE = re.compile(
    r"\b(?:i\s+(?:\w+\s+)?(?:choose|pick|select|vote|opt|go|recommend|suggest|advise|decide|will|would|shall|should|must|need|want|take|prefer|say)"
    r"|i'(?:d|ll|m)\b|i\s+am\s+going\s+to|let'?s|(?:it|one|we|you|the\s+(?:ego|car|vehicle|driver|ego\s+vehicle|ego\s+car|self\s+driving\s+car))\s+(?:should|must|will|needs?\s+to|has\s+to|have\s+to|ought\s+to|would\s+(?:best|better))"
    r"|(?<!second )(?:best|safest|right|correct|wisest|most\s+(?:sensible|appropriate|prudent|reasonable)|safer|better|only|proper|optimal|appropriate|recommended)\s+(?:\w+\s+){0,3}?(?:is|would\s+be|seems|:)"
    r"|(?:best|safest|wisest|better|advisable|prudent|necessary|required|safer)\s+to|(?:going|go|went)\s+(?:with|for)|opt(?:ing)?\s+for|my\s+(?:pick|vote|preference|suggestion|advice)|recommended\s*:|choosing|choose|select|pick)\b"
)
CONCLUSION = re.compile(
    r"\b(?:therefore|thus|hence|so|consequently|overall|in\s+(?:conclusion|summary|short|sum|the\s+end)|ultimately|accordingly|in\s+total|that\s+leaves|leaving|only\s+\w+\s+remains|=>)\b"
)
PRAISE = re.compile(
    r"^\s*(?:\w+\s+){0,6}?(?:is|are|would\s+be|seems|looks|remains|it\s+is)\s+(?:\w+\s+){0,2}?(?:best|safest|safer|better|right|correct|answer|choice|wisest|preferable|appropriate|advisable|my\s+\w+|required|needed|necessary|the\s+(?:only|way))\b"
    r"|^\s*[.,!]?\s*(?:it\s+is|that'?s\s+(?:my|the)\s+(?:answer|choice|final))"
)


WINDOW = 400
"""How far around a mention its meaning is looked for, in characters."""


@dataclass(frozen=True)
class Meant:
    """How a text means one mention."""

    mention: Mention
    level: int
    """-2 rejected, -1 only considered, 0 named, 1 concluded, 2 chosen, 3 given as the answer."""


def meaning(text: str, mention: Mention) -> Meant:
    """Return how strongly a normalised text chooses, or rejects, what it mentions."""
    near = max(0, mention.start - WINDOW)
    ends = re.finditer(r"[.;!?](?:\s|$)|\n", text[near : mention.start])
    start = near + max((match.end() for match in ends), default=0)
    before = text[start : mention.start]
    rest = text[mention.end : mention.end + WINDOW]
    stop = re.search(r"[.;!\n]|\?", rest)
    after = rest[: stop.start()] if stop else rest
    is_question = bool(stop and stop.group() == "?")
    if _is_rejected(before, after) or _is_denied(before, after):
        return Meant(mention, -2)
    scope = before[_last_end(_SCOPE_ENDS, before, but=r"because|since|:") :]
    if is_question or (_FALLBACK.search(before) and _CONDITION.search(after)):
        return Meant(mention, -1)
    if _LATER_CHOICE.search(before) or _EARLIER.search(scope):
        return Meant(mention, -1)
    if _TICKED.search(before) or (FINAL.search(before) and _reaches(FINAL, before)):
        return Meant(mention, 3)
    if _CONDITIONED.search(scope) or CONDITION.search(before):
        return Meant(mention, -1)
    if _reaches(CHOICE, before):
        return Meant(mention, 2)
    if _HEDGES.search(scope) or _HEDGED_AFTER.search(after):
        return Meant(mention, -1)
    if PRAISE.search(after):
        return Meant(mention, 2)
    if CONCLUSION.search(before):
        return Meant(mention, 1)
    return Meant(mention, 0)


def _is_rejected(before: str, after: str) -> bool:
    scope = before[_last_end(_SCOPE_ENDS, before) :]
    negations = list(_NEGATIONS.finditer(scope))
    if negations:
        between = scope[negations[-1].end() :]
        in_list = re.search(r"\b(?:or|nor)\s+(?:\w+\s+){0,2}$", between)
        if "," not in between or in_list or re.match(r"\s*,?\s*(?:or|nor)\b", after):
            return True
    if _NEAR_NEGATIONS.search(scope) or re.search(r"\bno:\s*$", before):
        return True
    if _CRASHES.match(after) and re.search(r"\bif\b", scope):
        return True
    if _MARKED_WRONG.search(after) or re.search(rf"^\W*{CROSS}\W*$", before):
        return True
    clause = re.split(r"[,;\u2014]|\b(?:because|since|but|so|and|as|which|while)\b", after)[0]
    return bool(_AFTERWARDS.search(clause))


def _is_denied(before: str, after: str) -> bool:
    """Whether another language denies a name anywhere in its clause, as it often does after it."""
    clause = before[_last_end(_CLAUSE, before) :] + " \n " + _CLAUSE.split(after, maxsplit=1)[0]
    return bool(DENIAL.search(clause))


def _last_end(pattern: re.Pattern[str], text: str, but: str = "") -> int:
    ends = [
        match.end()
        for match in pattern.finditer(text)
        if not (but and re.fullmatch(but, match.group()))
    ]
    return max(ends, default=0)


def _reaches(marker: re.Pattern[str], before: str) -> bool:
    """Whether a marker governs what follows the text: no reason or contrast comes in between."""
    ends = [match.end() for match in marker.finditer(before)]
    if not ends:
        return False
    between = before[ends[-1] :]
    return not re.search(
        r"\b(?:because|since|although|though|while|whereas|after|before|if|unless|as|than|when)\b",
        between,
    )

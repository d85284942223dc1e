"""Finds the one option that plain English prose states.

Every option in a text is a single character here (`OPTION`), which keeps the patterns short. Prose states an option
if each of its sentences is either a statement ("I would X", "The safest action is X because ...", "X") or an
observation: a sentence about the road and what is on it, which says nothing of anybody's choice.
"""

import re

from oodscen.judging._parsing.marking import BASE, OPTION, number
from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError


def stated_option(plain: str) -> int | None:
    """Return the number of the option that folded prose states; `None` if it states none.

    Raises:
        UnusableError: If it states two.
    """
    whole = re.fullmatch(rf"({OPTION})[\s.!;]*", plain)
    if whole:
        return number(whole[1])
    options = set[int]()
    users = len(_ROAD_USERS.findall(plain))
    for sentence in _sentences(plain):
        option = _stated_in(sentence, users)
        if option is not None:
            options.add(option)
        elif not _OPENS.match(sentence) or not _is_observation(sentence):
            return None
    if len(options) > 1:
        raise UnusableError(TWO_ANSWERS)
    return options.pop() if options else None


def _sentences(plain: str) -> list[str]:
    """Return the sentences; the words before ", so I would" are a sentence too."""
    plain = re.sub(r"[:,]\n", lambda match: f"{match[0][0]} ", plain)
    plain = re.sub(rf"({OPTION})(?:[\s(:,=.\u2013-]{{1,3}}\1)+\)?", r"\1", plain)
    plain = _SO_THEN.sub(".\n", _READY.sub("", plain))
    return [part.strip() for part in re.split(r"(?<=[.!?;])\s+|\n+", plain) if part.strip()]


_READY = re.compile(
    rf",? and (?:be (?:ready|prepared)|prepare) to {OPTION}(?: if (?:needed|necessary))?"
)
_SO_THEN = re.compile(rf",? (?:so|hence|thus|therefore),? (?=(?:i|we|the|my) |i'|let's |{OPTION})")

_EGO = (
    r"(?:i|we|(?:the )?ego(?: vehicle| car)?|(?:my|our) (?:car|vehicle)"
    r"|the (?:self driving|autonomous) (?:car|vehicle)|the (?P<user>car|vehicle|driver))"
)
_WILL = (
    r"(?: (?:would|will|should|must|shall|needs? to|ha(?:ve|s) to|am going to)|'d|'ll|'m going to)"
)
_ADVERB = r"(?: (?:definitely|probably|now|therefore|simply|just|immediately))?"
_CHOOSE = (
    r"(?:choose|pick|select|go with|opt for|recommend|suggest|advise|take|do|perform|execute|initiate"
    r"|make|say|answer)"
)
_THE = r"(?: to| the| an?)?(?: (?:action|option|number|answer))?(?: of| to| is)? ?:? ?"
_GOOD = (
    r"(?:best|safest|wisest|right|correct|appropriate|recommended|chosen|selected|final|safer"
    r"|most (?:appropriate|sensible|prudent))"
)
_THING = (
    r"(?:answer|ans|action|choice|option|decision|response|verdict|course of action|thing to do|thing"
    r"|maneuver|recommendation|conclusion|selection|description)"
)
_HERE = r"(?: (?:here|now|in this (?:case|situation|scenario)|for (?:the ego(?: vehicle)?|us|me)))?"
_GIVES = r" ?(?:(?:is|would be|should be|will be|:|=|->|\u2192|\u2014|\u2013|-) ?)+"
_SO = (
    r"(?:(?:so|therefore|thus|hence|overall|finally|in conclusion|yes|ok|okay|sure|in this (?:case|situation|scenario)"
    r"|(?:given|based on) (?:the|this|these) (?:situation|images?|frames?|descriptions?)"
    r"|to avoid a (?:collision|crash))[.,:]? ?){0,3}"
)
_SINCE = (
    r"(?:(?:given that|given(?= the )|since|because(?: of)?|as(?= the | there | it )|due to)"
    r" (?P<since>[^,:]{1,200})[,:] )?"
)
_I_THINK = r"(?:i (?:think|believe|recommend|suggest)(?: that)? )?"
_FORMS = (
    rf"{_EGO}{_WILL}{_ADVERB}(?: {_CHOOSE})?{_THE}(?P<it>{OPTION})",
    rf"you (?:should|must|need to){_THE}(?P<it>{OPTION})",
    rf"(?:i|we){_ADVERB} (?:{_CHOOSE}{_THE})?(?P<it>{OPTION})",
    rf"(?:let's |just )?{_CHOOSE}{_THE}(?P<it>{OPTION})",
    rf"(?:let's |let us |(?:i'm )?going with |just |it is{_THE})(?P<it>{BASE})",
    rf"(?:\u2022 ?|- )?(?:the |my )?(?:{_GOOD} )*(?:{_THING}|{_GOOD}){_HERE}{_GIVES}{_THE}(?P<it>{OPTION})",
    rf"(?P<it>{OPTION}) (?:is|would be|seems) (?:the |my )?(?:only )?{_GOOD}(?: {_THING})?{_HERE}",
    rf"(?:[-\u2022] |\()?(?:option )?(?P<it>{BASE})\)?",
)
_NOW = r"(?:,? (?:now|here|immediately|at once|right away|gently|safely|carefully))*"
_TAIL = (
    rf"(?: (?:action|maneuver|option))?{_NOW}(?: in (?:the|my|our|its) (?:ego )?lane)?"
    r"(?: (?P<place>(?:behind|before|in front of) [^,;]{1,60}))?"
    r"(?:[,;]? ?(?P<reason>(?:because|since|as (?=the |there |it |this )|due to|given|in order to|so that"
    r"|to (?:avoid|let|prevent|give|allow|ensure|reduce|wait|yield|keep|maintain))\b.+?))?[\s.!;]*"
)
_STATEMENTS = tuple(re.compile(_SO + _SINCE + _SO + _I_THINK + form + _TAIL) for form in _FORMS)
_ROAD_USERS = re.compile(
    r"\b(?:(?:car|vehicle|driver|truck|pickup|suv|van|tram|streetcar|trolley|train|trailer|caravan|tractor"
    r"|ambulance|taxi|cab|limousine|convoy|excavator|digger|loader|forklift|(?:fire )?engine"
    r"|motorcycle|motorbike|scooter|moped|bicycle|bike|rickshaw|cyclist|biker|rider|he|she)s?"
    r"|lorry|lorries|(?:mini)?bus(?:s?es)?|coach(?:es)?)\b"
    r"(?<!ego vehicle)(?<!ego car)"
)
"""Matches words for those who may be meant by "the vehicle"."""
_LONGEST_SENTENCE = 400
"""The longest sentence that can state an option, in characters."""


def _stated_in(sentence: str, users: int) -> int | None:
    """Return the option that a sentence states; `None` if it states none.

    "The vehicle" is the ego only if it is the only road user that the text mentions.
    """
    if len(sentence) > _LONGEST_SENTENCE or not re.search(OPTION, sentence):
        return None
    for statement in _STATEMENTS:
        match = statement.fullmatch(sentence)
        if match is None or (users != 1 and match.groupdict().get("user")):
            continue
        parts = (match[name] for name in ("since", "place", "reason") if match[name])
        if all(_is_observation(part) or _IS_BEST.fullmatch(part) for part in parts):
            return number(match["it"])
    return None


_IS_BEST = re.compile(
    rf"(?:because|since|as) (?:it|this|that) is (?:the )?{_GOOD}(?: {_THING})?{_HERE}"
)
_VERB = (
    r"(?:is|are|has|have|stands?|lies|blocks?|cross(?:es)?|walks?|runs?|moves?|drives?|comes?|stays?|keeps?"
    r"|appears?|seems?|approach(?:es)?|enters?|fills?|covers?|clos(?:es|ed)|turns?|obstructs?|occup(?:y|ies)|may|might|could)"
)
_OPENS = re.compile(
    r"(?:[-\u2022] )?(?:(?:first|second|also|moreover|now),? )?(?:(?:in )?frame \d(?: shows|:)"
    r"|(?:the |this )?(?:image|frame|scene)s? shows?|there(?: is| are|'s)"
    r"|(?:i|we) (?:can )?see|it is (?:dark|night|foggy|raining|snowing|day)"
    rf"|(?:an?|the|my|our|two|three|several|some|many|both) (?:[^\s,;:]+ ){{1,8}}?{_VERB}"
    r"|(?:visibility|traffic|fog|rain|snow|debris|pedestrians|people|children|cars|vehicles) (?:is|are))\b"
)
"""Matches the beginning of a sentence that may be an observation."""
CRASH = r"(?:collision|accident|crash|impact)s?"
_SCENE = re.compile(
    r"\b(?:road|lane|street|junction|intersection|crossing|crosswalk|highway|motorway|tunnel|bridge|shoulder|kerb|curb"
    r"|pavement|sidewalk|verge|car|vehicle|truck|lorry|van|bus|motorcycle|cyclist|bicycle|traffic|pedestrian|person"
    r"|people|crowd|child|children|man|woman|animal|cow|deer|dog|horse|moose|sheep|obstacle|object|debris|box|tree"
    r"|rock|ahead|fog|rain|snow|ice|dark|night|foggy|raining|snowing|visibility|hazard|room|distance|weather|light|in the way"
    rf"|in (?:my|our|its) (?:way|path)|{CRASH})(?:s|es)?\b"
)
"""Matches words for what is on a road; an observation has one."""
_ALLOWED = re.compile(
    r"\b(?:(?:ahead|in front) of (?:me|us)|(?:my|our|its) (?:own )?(?:lane|path|way|side|car|vehicle)"
    r"|(?:i|we) (?:can )?see|that has \w+ed|so that (?=an? |no |the |there )"
    r"|(?:it|that|which|who|they)(?: is| are|'s)"
    r" (?:\w+ing|in|on|ahead|near|close|too (?:close|near)|dark|night|foggy)"
    r"|(?:the )?ego(?:'s)?(?: vehicle| car)?(?:'s)?"
    r" (?:lane|is (?:in|on|at|approaching|driving|moving|travell?ing|following))"
    r"|(?:to|towards?|behind|(?:ahead|in front) of|hit|approaching) (?:the )?ego(?: vehicle| car)?"
    rf"|(?:avoid|prevent|reduce)(?:ing)? (?:(?!no |not )\w+ ){{0,4}}{CRASH}"
    rf"|(?:risk of|there (?:is|has been)) (?:an? )?(?:\w+ )?{CRASH})\b"
)
"""Matches phrases with words of `_NO_OBSERVATION` that judge no choice."""
_NO_OBSERVATION = re.compile(
    rf"{OPTION}|[?\u2026:\"]|\b(?:i|me|my|mine|we|us|our|you|your|he|she|it|its|they|that|this|these|those"
    r"|which|what|who|whoever|ego|\w+'[sd]|\w+'ll|if|unless|when|until|once|but|yet|however|though|although"
    r"|while|except|instead|rather|otherwise|then|so|had|were|would|should|must|shall|ought|cannot|does|did"
    r"|wish\w*|hope\w*|want\w*|says?|said|tells?|told|reads?|claim\w*|ask\w*|thinks?|answers?|choices?"
    r"|options?|actions?|decisions?|above|below|opposite|wrong (?!way\b)|an?other"
    r"|an? (?:lie|flaw|mistake|joke)|the lie|lied|jok\w+|kidding|kill\w*|dies?|dying|dead\w*|death\w*|fatal\w*"
    r"|lethal|suicid\w*|murder\w*|harm\w*|worst|worse|better|best|safer|safest|wiser|prefer\w*|stupid|nonsense"
    r"|imagin\w+|suppos\w+|example|fiction\w*|hypothetical\w*|pretend\w*|dream\w*|universe|forbid\w*"
    rf"|illegal|prohibit\w*|false|untrue|not true|{CRASH})\b"
)
"""Matches options, questions, and words of a condition, a report or a judgement."""


def _is_observation(words: str) -> bool:
    words = _ALLOWED.sub(" ", words) if _SCENE.search(words) else ""
    return bool(words) and not _NO_OBSERVATION.search(words)

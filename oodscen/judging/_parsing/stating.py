"""Finds the one option that plain English prose states, and reasons that are against an option.

Every option in a text is a single character here (`OPTION`), which keeps the patterns short. Prose states an option
if each of its sentences is either a statement ("I would X", "The safest action is X because ...", "X") or an
observation: a sentence about the road and what is on it, which says nothing of anybody's choice.
"""

import re

from oodscen.judging._parsing.unusable import TWO_ANSWERS, UnusableError

FIRST, GERUNDS = 0xE000, 0x800
"""The character of the first option, and the offset of an option named as a gerund ("stopping", not "stop"), of which
the first is a multiple."""
OPTION = f"[{chr(FIRST)}-{chr(FIRST + 2 * GERUNDS - 1)}]"
_BASE = f"[{chr(FIRST)}-{chr(FIRST + GERUNDS - 1)}]"
_GERUND = f"(?!{_BASE}){OPTION}"


def stated_option(plain: str) -> int | None:
    """Return the number of the option that folded prose states; `None` if it states none.

    Raises:
        UnusableError: If it states two.
    """
    whole = re.fullmatch(rf"({OPTION})[\s.!]*", plain)
    options = {number(whole[1])} if whole else set()
    users = len(_ROAD_USERS.findall(plain))
    for sentence in () if whole else _sentences(plain):
        found = _stated_in(sentence, users)
        if found is not None:
            options.add(found)
        elif not _OPENS.match(sentence) or not _is_observation(sentence):
            return None
    if len(options) > 1:
        raise UnusableError(TWO_ANSWERS)
    return options.pop() if options else None


def number(option: str) -> int:
    """Return the number of the option that a character stands for."""
    return ord(option) % GERUNDS


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

# ------------------------------------------------------------------ statements

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
    r"|(?:given|based on) (?:the|this|these) (?:situation|images?|frames?|descriptions?)|to avoid a (?:collision|crash))[.,:]? ?){0,3}"
)
_SINCE = r"(?:(?:given that|given(?= the )|since|because(?: of)?|as(?= the | there | it )|due to) (?P<since>[^,:]{1,200})[,:] )?"
_I_THINK = r"(?:i (?:think|believe|recommend|suggest)(?: that)? )?"
_FORMS = (
    rf"{_EGO}{_WILL}{_ADVERB}(?: {_CHOOSE})?{_THE}(?P<it>{OPTION})",
    rf"you (?:should|must|need to){_THE}(?P<it>{OPTION})",
    rf"(?:i|we){_ADVERB} (?:{_CHOOSE}{_THE})?(?P<it>{OPTION})",
    rf"(?:let's |just )?{_CHOOSE}{_THE}(?P<it>{OPTION})",
    rf"(?:let's |let us |(?:i'm )?going with |just |it is{_THE})(?P<it>{_BASE})",
    rf"(?:\u2022 ?|- )?(?:the |my )?(?:{_GOOD} )*(?:{_THING}|{_GOOD}){_HERE}{_GIVES}{_THE}(?P<it>{OPTION})",
    rf"(?P<it>{OPTION}) (?:is|would be|seems) (?:the |my )?(?:only )?{_GOOD}(?: {_THING})?{_HERE}",
    rf"(?:[-\u2022] |\()?(?:option )?(?P<it>{_BASE})\)?",
)
_NOW = r"(?:,? (?:now|here|immediately|at once|right away|gently|safely|carefully))*"
_TAIL = (
    rf"(?: (?:action|maneuver|option))?{_NOW}(?: in (?:the|my|our|its) (?:ego )?lane)?(?: (?P<place>(?:behind|before|in front of) [^,;]{{1,60}}))?"
    r"(?:[,;]? ?(?P<reason>(?:because|since|as (?=the |there |it |this )|due to|given|in order to|so that"
    r"|to (?:avoid|let|prevent|give|allow|ensure|reduce|wait|yield|keep|maintain))\b.+?))?[\s.!]*"
)
_STATEMENTS = tuple(re.compile(_SO + _SINCE + _SO + _I_THINK + form + _TAIL) for form in _FORMS)
_ROAD_USERS = re.compile(
    r"\b(?:car|vehicle|driver|truck|lorry|bus|van|motorcycle|bicycle|cyclist|he|she)s?\b(?<!ego vehicle)(?<!ego car)"
)
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
        if (
            match
            and (users == 1 or not match.groupdict().get("user"))
            and all(
                _is_observation(match[part]) or _IS_BEST.fullmatch(match[part])
                for part in ("since", "place", "reason")
                if match[part]
            )
        ):
            return number(match["it"])
    return None


# ------------------------------------------------------------------ observations

_IS_BEST = re.compile(
    rf"(?:because|since|as) (?:it|this|that) is (?:the )?{_GOOD}(?: {_THING})?{_HERE}"
)
_VERB = (
    r"(?:is|are|has|have|stands?|lies|blocks?|cross(?:es)?|walks?|runs?|moves?|drives?|comes?|stays?|keeps?|appears?|seems?"
    r"|approach(?:es)?|enters?|fills?|covers?|clos(?:es|ed)|turns?|obstructs?|occup(?:y|ies)|may|might|could)"
)
_OPENS = re.compile(
    r"(?:[-\u2022] )?(?:(?:first|second|also|moreover|now),? )?(?:(?:in )?frame \d(?: shows|:)|(?:the |this )?(?:image|frame|scene)s? shows?|there(?: is| are|'s)"
    r"|(?:i|we) (?:can )?see|it is (?:dark|night|foggy|raining|snowing|day)"
    rf"|(?:an?|the|my|our|two|three|several|some|many|both) (?:[^\s,;:]+ ){{1,8}}?{_VERB}"
    r"|(?:visibility|traffic|fog|rain|snow|debris|pedestrians|people|children|cars|vehicles) (?:is|are))\b"
)
"""Matches the beginning of a sentence that may be an observation."""
_CRASH = r"(?:collision|accident|crash|impact)s?"
_SCENE = re.compile(
    r"\b(?:road|lane|street|junction|intersection|crossing|crosswalk|highway|motorway|tunnel|bridge|shoulder|kerb|curb"
    r"|pavement|sidewalk|verge|car|vehicle|truck|lorry|van|bus|motorcycle|cyclist|bicycle|traffic|pedestrian|person"
    r"|people|crowd|child|children|man|woman|animal|cow|deer|dog|horse|moose|sheep|obstacle|object|debris|box|tree"
    r"|rock|ahead|fog|rain|snow|ice|visibility|hazard|room|distance|weather|light|in the way|in (?:my|our|its) (?:way|path)"
    rf"|{_CRASH})(?:s|es)?\b"
)
"""Matches words for what is on a road; an observation has one."""
_ALLOWED = re.compile(
    r"\b(?:(?:ahead|in front) of (?:me|us)|(?:my|our|its) (?:own )?(?:lane|path|way|side|car|vehicle)|(?:i|we) (?:can )?see"
    r"|(?:it|that|which|who|they)(?: is| are|'s) (?:\w+ing|in|on|ahead|near|close|too (?:close|near)|dark|night)|that has \w+ed"
    r"|(?:the )?ego(?:'s)?(?: vehicle| car)?(?:'s)? (?:lane|is (?:in|on|at|approaching|driving|moving|travell?ing|following))"
    r"|(?:to|towards?|behind|(?:ahead|in front) of|hit|approaching) (?:the )?ego(?: vehicle| car)?"
    rf"|(?:avoid|prevent|reduce)(?:ing)? (?:(?!no |not )\w+ ){{0,4}}{_CRASH}|(?:risk of|there (?:is|has been)) (?:an? )?(?:\w+ )?{_CRASH})\b"
)
"""Matches phrases with words of `_NO_OBSERVATION` that judge no choice."""
_NO_OBSERVATION = re.compile(
    rf"{OPTION}|[?\u2026:\"]|\b(?:i|me|my|mine|we|us|our|you|your|he|she|it|its|they|that|this|these|those|which|what|who|whoever|ego"
    r"|\w+'[sd]|\w+'ll|if|unless|when|until|once|but|yet|however|though|although|while|except|instead|rather|otherwise|then|so|had|were"
    r"|would|should|must|shall|ought|cannot|does|did|wish\w*|hope\w*|want\w*|says?|said|tells?|told|reads?|claim\w*|ask\w*|thinks?"
    r"|answers?|choices?|options?|actions?|decisions?|above|below|opposite|wrong (?!way\b)|an?other|an? (?:lie|flaw|mistake|joke)|the lie|lied|jok\w+"
    r"|kidding|kill\w*|dies?|dying|dead\w*|death\w*|fatal\w*|lethal|suicid\w*|murder\w*|harm\w*|worst|stupid|nonsense|imagin\w+|suppos\w+"
    rf"|example|fiction\w*|hypothetical\w*|pretend\w*|dream\w*|universe|forbid\w*|illegal|prohibit\w*|false|untrue|not true|{_CRASH})\b"
)
"""Matches options, questions, and words of a condition, a report or a judgement."""


def _is_observation(words: str) -> bool:
    words = _ALLOWED.sub(" ", words) if _SCENE.search(words) else ""
    return bool(words) and not _NO_OBSERVATION.search(words)


# ------------------------------------------------------------------ reasons


def is_against(plain: str, option: int | None = None) -> bool:
    """Return whether folded reasons deny or condemn an option, or disown the answer."""
    return bool(_CONDEMNED.fullmatch(plain)) or any(
        _DISOWNS.search(sentence)
        or any(map(_is_denied, _CLAUSE.finditer(_kinds(sentence, option))))
        for sentence in re.split(r"(?<=[.!?;])\s+|\n+", plain)
    )


def _kinds(sentence: str, option: int | None) -> str:
    """Return the kind of every word of a sentence, with `O` for the option; nothing for a question."""
    return "".join(
        "O" if word["P"] and number(word["P"]) == option else str(word.lastgroup)
        for word in (() if sentence.endswith("?") else _WORD.finditer(sentence))
    )


def _is_denied(clause: re.Match[str]) -> bool:
    """Return whether denials and bad words are odd in number, and nothing outweighs them."""
    edge, condition, before, after = clause.groups()
    rest = clause.string[clause.end() :]
    count = len(re.findall("b+|[nmu]", f"{before}O{after}"))
    is_open = (condition or before[:1] == "m") and not re.search("[bg]", after)
    is_admitted = "b" in before + after and (edge == "a" or "h" in rest) and "P" not in rest
    return count % 2 == 1 and not is_open and not is_admitted and rest[:1] not in ("i", "u", "t")


_BAD = (
    r"(?:an? |the )?(?:(?:\w+ly|very|too|so) )?(?:dangerous|unsafe|forbidden|illegal|prohibited|wrong|incorrect|bad|worst|worse|fatal"
    r"|deadly|lethal|suicid\w+|impossible|reckless|out of the question|ruled out|terrible|stupid|mistake|no option|unnecessary|needless|pointless|false|lie|decoy|joke)"
)
_KINDS = {
    "P": OPTION,
    "c": "[,:]",
    "b": rf"(?:far |much )?too \w+|{_BAD}|risk(?:y|ier)|risks?(?: an?)?(?! (?:of|in)\b)|un(?:wise|acceptable)|in(?:sufficient|adequate|appropriate|advisable)|useless"
    r"|irresponsible|negligent|foolish|excessive|overkill|hazardous|catastrophic|disastrous|problem|last thing|be avoided|puts? (?:\w+ ){1,3}at risk"
    r"|(?:poses?|creates?) (?:an? )?(?!no )(?:\w+ )?(?:danger|threat|risk|hazard)|makes? (?:things|it|matters|the situation) (?:worse|more dangerous)"
    r"|(?:make|let)s? (?:(?!not )\w+ ){1,4}(?:hit|strike|ram)|(?:kill|endanger|harm|hurt|injure|hit|strike|ram|collide|die)s?"
    rf"|(?:rear end )?{_CRASH}|crashes|pile up",
    "m": rf"not(?= {_GERUND})",
    "n": r"not(?! (?:only|just|merely|simply)\b)|\w+n't|cannot|never|hardly|no longer|neither|nobody|no one|nothing(?! but\b)|refuse|decline|reject|rule out|forbid"
    r"|avoid(?:s|ing)?|prevents?|against|unable|unlikely|opposite of|than|less|least|doubt|(?:under|by|in|on) no (?:circumstances?|means|case|account)"
    r"|no (?:\w+ )?(?:reason|need|room|time|space|point|sense|use|way|chance|possibility|distance|lane|shoulder|help)(?! but\b)|no(?= (?:problem|mistake|risk)\b)"
    r"|(?:(?:any|every)thing|everyone|all|(?:any|every|all) (?:other )?\w+) (?:but|except(?: for)?|other than)",
    "i": "if|when|where|until",
    "u": "unless|without",
    "h": "but|yet|however",
    "a": "although|though|while",
    "e": r"[;.!()\u2013\u2014-]|and|so|because|since|as|rather|which|(?:means|shows) that|(?:make|render)s?",
    "t": "abruptly|suddenly|sharply|harshly|hard|completely|fully",
    "r": "n?or",
    "g": "safe(?:r|st)?|best|better|good|right|correct|possible|feasible|viable|necessary|needed|required|recommended|advisable|allowed|permitted|able|wise"
    "|sensible|prudent|appropriate|acceptable|suitable|justified|warranted|reasonable|practical|enough|sufficient|suffice|work|help",
    "k": rf"it(?:'s|(?= (?:is|was|seems|looks|isn't|wasn't|(?:\w+ not|\w+) be)\b))(?!(?: is|) not {_GERUND}| isn't {_GERUND})|(?:that|it)(?= (?:it is )?{_BAD})"
    r"|(?:i|we)(?:'\w+)?|you|one|us|me|(?:the )?ego(?: vehicle| car)?|(?:my|our) (?:car|vehicle)|everyone|everybody|no(?:t|thing|ne)?|(?:think|believe)(?: that)?"
    r"|would|will|should|must|shall|can|could|may|might|is|are|am|be|was|were|do|does|has|have|had|needs?|ought|want|like|intend|recommend|choose|pick|select|take"
    r"|answer|say|advise|suggest|going|causes?|means?|seems?|looks?|(?:lead|result)s? (?:to|in)|then|there|here|now|also|only|just|simply|either|any|very|quite|almost"
    r"|therefore|hence|thus|even|please|serious|severe|grave|big|huge|downright|to|an?|the|my|for|of|in|this|that|lane|situation|case|conditions|action|option|choice"
    r"|idea|room|time|space|distance|\w+ly",
    "x": r"[\w']+|\S",
}
"""The words of every kind: bad ones, denials (`m`, `n`, and `u`, also a condition), conditions, concessions (`h`, `a`), edges of a
clause, manners (`t`), good ones, others that are known, and unknown ones."""
_WORD = re.compile(
    "|".join(rf"(?P<{kind}>(?:{words})(?!(?<=\w)[\w']))" for kind, words in _KINDS.items())
)
_GAP = "(?:[knu]|r[OPx])*"
_CLAUSE = re.compile(
    "(?:^|(?<=([ecah])))(?=([iu])?)((?:[kgbnmiu]|[OP]r|nc[kx]{1,6}c)*)O(?(2)c?)"
    f"(c{_GAP}(?=e|$)|(?:{_GAP}[bg])*(?:{_GAP}(?=[ecah]|$))?)"
)
"""Matches an option and the known words before and after it; the comma of "if we stop, we crash" ends no clause."""
_CONDEMNED = re.compile(
    r"\W*(?:(?:(?:this|that|it) is )?(?:wrong|incorrect|false|a mistake|not (?:recommended|advisable|right|correct|true))|the opposite)\W*"
)
_IS = r"(?:is|was|are|(?:would|will|could|can|may|might) be|seems|looks)"
_NAMED = r"(?:answer|choice|action|option|decision|idea)"
_DISOWNS = re.compile(
    r"\A\W*(?:placeholder|example|n/?a|dummy|test|todo|tbd|no|not|nope|never|wrong|false)\W*\Z"
    r"|\A\W*(?:the |my )?answer (?:is )?(?:withheld|omitted|redacted)\b"
    r"|\b(?:this|it) is (?:only|just|merely) (?:an? )?(?:example|placeholder|test|template|dummy)\b"
    r"|\b(?:opposite of (?:what|my|this|the (?:answer|choice|action|option|decision))|just kidding|joking|i (?:lied|lie|am lying)"
    rf"|(?:this|the|my|that) {_NAMED}(?: below| field)? {_IS} (?:not (?:my|the)|{_BAD})"
    rf"|(?<!but )(?:this|that|it|what follows|the (?:above|below|following)) (?:would be {_BAD}(?! (?:not )?to\b| for\b)|{_IS} (?:not (?:my|what (?:i|we) (?:would|should))"
    rf"|{_BAD} {_NAMED}|an? (?:lie|mistake|decoy|joke)(?! (?:not )?to\b)))"
    r"|as an? (?:ai )?language model|i (?:cannot|can't|won't|will not|refuse to|decline to) (?:help|assist|comply|answer)"
    r"|(?:do not|don't|never) (?:do|use|take|choose|follow|trust) (?:this|that|it)|(?:ignore|disregard) (?:this|that|the (?:answer|action)))\b"
)
"""Matches a sentence that disowns the answer beside it, and placeholders for reasons."""

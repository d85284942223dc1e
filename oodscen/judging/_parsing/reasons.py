"""Finds reasons that are against the option that they stand beside, or that disown an answer."""

import re

from oodscen.judging._parsing.marking import GERUND, OPTION, number
from oodscen.judging._parsing.stating import CRASH


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
    r"(?:an? |the )?(?:(?:(?!hardly)\w+ly|very|too|so|most) )?(?:dangerous|unsafe|forbidden|illegal|prohibited|wrong|incorrect|bad|worst|worse|fatal"
    r"|deadly|lethal|suicid\w+|impossible|reckless|out of the question|ruled out|terrible|stupid|mistake|no option|unnecessary|needless|pointless|false|lie|decoy|joke)"
)
_KINDS = {
    "P": OPTION,
    "c": "[,:]",
    "b": rf"(?:far |much )?too \w+|{_BAD}|risk(?:y|ier)|risks?(?: an?)?(?! (?:of|in)\b)|un(?:wise|acceptable)|in(?:sufficient|adequate|appropriate|advisable)|useless"
    r"|irresponsible|negligent|foolish|excessive|over(?:kill|reaction)|hazardous|catastrophic|disastrous|problem|last thing|be avoided|puts? (?:\w+ ){1,3}at risk"
    r"|(?:poses?|creates?) (?:an? |the )?(?!(?:no|little|less|least|low(?:er|est)?|small(?:er|est)?|minimal|minor|negligible) )(?:\w+ )?"
    r"(?:danger|threat|risk|hazard)|makes? (?:things|it|matters|the situation) (?:worse|more dangerous)"
    r"|(?:make|let)s? (?:(?!not )\w+ ){1,4}(?:hit|strike|ram)|(?:kill|endanger|harm|hurt|injure|hit|strike|ram|collide|die)s?"
    rf"|(?:rear end )?{CRASH}|crashes|pile up",
    "m": rf"not(?= {GERUND})",
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
    "k": rf"it(?:'s|(?= (?:is|was|seems|looks|isn't|wasn't|(?:\w+ not|\w+) be)\b))(?!(?: is|) not {GERUND}| isn't {GERUND})|(?:that|it)(?= (?:it is )?{_BAD})"
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
    "(?:^|(?<=([ecah])))(?=([iu])?)((?:[kgbnmiu]|[OP]r|nc[kx]{1,6}c){0,99})O(?(2)c?)"
    f"(c{_GAP}(?=e|$)|(?:{_GAP}[bg])*(?:{_GAP}(?=[ecah]|$))?)"
)
"""Matches an option and the known words before and after it; the comma of "if we stop, we crash" ends no clause.

The limit on the words before it keeps the time linear in those of an answer."""
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

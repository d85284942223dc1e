"""Whether words call a scene out of the ordinary: yes or no, or what they say of it."""

import re
from typing import Literal

from oodscen.judging.languages import ANSWER, IS, NO_WORD, UNUSUAL, USUAL, YES_WORD
from oodscen.judging.meaning import CONCLUSION, CORRECTIONS
from oodscen.judging.patterns import compiled, either, few

NEITHER = "neither yes nor no"


def verdict_in(plain: str) -> tuple[bool | None, str]:
    """Say whether a normalised text finds a scene unusual, after its last correction, and how."""
    for place in [m.end() for m in CORRECTIONS.finditer(plain)][:-20:-1]:
        later, how = uncorrected_verdict(plain[place:].strip(" .,;:!"))
        if later is not None:
            return later, f"corrected, {how}"
    return uncorrected_verdict(plain)


def says_usual(plain: str) -> bool:
    """Whether a normalised text says that nothing is out of the ordinary."""
    return verdict_in(plain)[0] is False


def uncorrected_verdict(plain: str) -> tuple[bool | None, str]:
    """Say the same of a text that takes nothing back."""
    marks = [m[1] for m in _LABELLED.finditer(plain)]
    if marks:
        return truth(marks[-1]), "given"
    asserted = UNASSERTED.sub(" ", plain)
    first = FIRST_WORD.match(asserted)
    if first and not _begins_a_sentence_on_nothing(first, asserted):
        return truth(first[1]), "yes or no"
    last = re.search(r"(?:^|\n)\W*(yes|no|true|false)\W*$", asserted)
    if last:
        return truth(last[1]), "yes or no"
    if _UNDECIDED.search(asserted):
        return None, "undecided"
    concluded = [m.end() for m in CONCLUSION.finditer(asserted)]
    if concluded and (closing := worded(asserted[concluded[-1] :])) in (True, False):
        return bool(closing), "concluded"
    return _weighed(asserted)


def truth(value: object) -> bool | None:
    """Return what a value or a word says of being out of the ordinary, if anything."""
    if isinstance(value, bool):
        return value
    if isinstance(value, (int, float)):
        return bool(value) if value in (0, 1) else None
    word = value.strip(" .!'\"").casefold() if isinstance(value, str) else ""
    if re.fullmatch(rf"yes|true|yeah|yep|si|1|ood|unusual|{YES_WORD}", word):
        return True
    if re.fullmatch(rf"no|false|nope|none|nothing|0|normal|ordinary|{NO_WORD}", word):
        return False
    return None


def _begins_a_sentence_on_nothing(first: re.Match[str], plain: str) -> bool:
    """Whether a first word is the subject of a sentence: "nothing looks normal here"."""
    return first[1] in ("nothing", "none") and bool(re.match(r"\s*\w", plain[first.end() :]))


def _weighed(plain: str) -> tuple[bool | None, str]:
    """Say what the clauses of a text come to; an exception counts: "normal, but for a deer"."""
    said = [one for clause in _BUT.split(plain) if (one := worded(clause)) is not None]
    if not said:
        return None, NEITHER
    if len(set(said)) == 1 and said[0] != "both":
        if said[0] is False and _excepts_something(plain):
            return True, "but"
        return said[0] is True, "worded"
    if _OPEN.search(plain) or said[-1] is not True:
        return None, "both yes and no"
    return True, "but"


def _excepts_something(plain: str) -> bool:
    """Whether a sentence that calls a scene ordinary goes on with what is not."""
    for sentence in re.split(r"[.!?\n]", plain):
        ordinary, *excepted = _EXCEPT.split(sentence, maxsplit=1)
        if excepted and worded(ordinary) is False and names_something(excepted[0]):
            return True
    return False


def names_something(sentence: str) -> bool:
    """Whether a sentence says more than that something is out of the ordinary, or how surely."""
    return bool(re.search(r"[^\W\d]{3}", _VERDICT_WORDS.sub(" ", sentence)))


def worded(plain: str) -> bool | Literal["both"] | None:
    """Say whether a clause calls something out of the ordinary, or says both."""
    rest, odd = _NOT_ORDINARY.subn(" ", plain)
    rest, usual = _NOTHING_ODD.subn(" ", rest)
    says_yes = bool(odd or _SOMETHING_ODD.search(rest))
    if usual and says_yes:
        return "both"
    return says_yes if usual or says_yes else None


_NOT_OF_A_NOUN = (
    r"(?= *(?:$|[^\w\s])"
    r"| (?:nothing|it|this|that|there|the|these|i|we|everything|all|not|no)\b)"
)
"""Follows a "no" that answers, other than that of "no markings are visible"."""

_YES_OR_NO = rf"yes|true|false|none|nothing|{YES_WORD}|(?:no|{NO_WORD}){_NOT_OF_A_NOUN}"
_CALLED = (
    r"(?:(?:an?|perfectly|quite|completely) )?"
    r"(?:ordinary|normal|usual|unusual|abnormal|anomalous|ood)"
    r"(?![^.\n]*\b(?:but|except|apart|although)\b)"
)

_LABELLED = compiled(
    either(
        r"\b(?:(?:is ?)?ood|out of distribution|unusual|anomal(?:y|ous))",
        r"\b(?:answer|verdict|boxed|final)",
        rf"(?<![a-z]){ANSWER}",
    )
    + rf" *\?? *(?::|=|\u2014|\{{|\bis\b|\s{IS}\b) *({_YES_OR_NO}|{_CALLED})\b"
    # a choice of both, or a sentence: "answer: yes or no", "final: no vehicles"
    r"(?! *(?:or\b|/|\||and no\b"
    r"|(?:vehicles?|cars?|traffic|lanes?|pedestrians?|idea|way)\b))"
)
"""A yes or no that is marked as the answer: "unusual: yes"."""

FIRST_WORD = compiled(
    rf"\W*({_YES_OR_NO}|nope|yeah|yep)(?:\b|(?=\W|$))"
    r"(?! (?:matter|wonder|doubt|idea|way|one|and no|or no"
    r"|vehicles?|cars?|traffic|pedestrians?|lanes?)\b)"
)
"""A yes or no that begins a text."""

UNASSERTED = compiled(
    r"[^.!?\n]*\?",
    r"\b(?:whether|if) [^.;,\n]*",
    r"\b(?:probability|confidence|likelihood|chance) (?:that|of)\b[^.;,\n]*",
    # sentences of the question
    r"\babout half of such[^.\n]*",
    r"\bexactly one is right",
)
"""What says neither yes nor no: questions, what hangs on a condition, the words of the question."""

_UNDECIDED = compiled(
    r"\b"
    + either(
        r"not sure (?:if|whether)|unsure|unclear|uncertain|undecided",
        r"hard to (?:say|tell)|or not|yes and no",
        r"(?:can't|cannot|can not) (?:tell|say|judge)"
        r"(?= (?:if|whether|from)\b| *(?:[.!,]|$))",
    )
    + r"\b"
)
_OPEN = compiled(
    r"\b"
    + either(
        r"might|may|could|maybe|perhaps|either",
        r"not sure|unsure|unclear|uncertain|hard to (?:say|tell)|yes and no",
    )
    + r"\b"
)
_BUT = compiled(r"\b(?:but|however|except|although|yet|though|while|apart from|aber)\b")

_EXCEPT = compiled(r"\b(?:except|apart from|aside from|but for(?! now| the moment))\b")

_ORDINARY = r"(?:normal|ordinary|typical|routine|usual|in distribution|unremarkable)"
_ODD = either(
    r"unusual|unexpected|odd|strange|weird|bizarre|peculiar",
    r"anomal\w+|abnormal\w*",
    r"ood|out of (?:the ordinary|distribution)",
)
_NO = r"(?:\b(?:no|not|without|cannot|never|neither)|\w+n't)"

_NOT_ORDINARY = compiled(
    r"\b(?:not|n't|nothing|never|hardly|far from|anything but|isn't|aren't|doesn't|don't) "
    rf"(?:(?!only\b|of\b)\w+ ){{0,3}}?{_ORDINARY}\b",
    rf"\b(?:n't|nothing|not) (?:anything )?(?:that )?(?:i|one|you) {few(3)}{_ORDINARY}\b",
    rf"n't anything that {few(4)}{_ORDINARY}\b",
)
"""Calls a scene odd by denying that it is ordinary: "nothing that one would call normal"."""

_NOTHING_ODD = compiled(
    # a heading or a short sentence: "An ordinary scene."
    rf"(?:^|[.!\n])[^\w\n]*(?:an? )?(?:\w+ )?{_ORDINARY}"
    r"(?: (?:drive|driving|scene|scenario|traffic|situation|day|road|conditions))*"
    r" *(?:[.!,(\n]|$)",
    r"(?:\b(?:no|not|nothing|without)\b|\w+n't)[^.\n]{0,40}"
    r"\b(?:surpris\w+|stands? out|standing out|of concern)\b",
    rf"\b(?:nothing|none) (?:(?!whether\b|but\b|{_ORDINARY})\w+ ){{0,5}}?"
    rf"(?:{_ODD}|out of place|wrong|remarkable|special|noteworthy|notable)",
    rf"\b(?:hardly|barely|scarcely) (?:anything|something|at all )?{few(1)}{_ODD}",
    rf"{_NO} (?:(?!whether\b|if\b|only\b|just\b|tell\b|say\b|sure\b|certain\b|because\b)\w+ )"
    rf"{{0,5}}?(?:{_ODD}|hazards?)",
    # "looks normal", though not "an ordinary road, but"
    r"(?<!not\s)(?<!n't\s)"
    r"(?:completely|entirely|perfectly|quite|all|looks?|seems?|appears?|is|are|be|an?|just) "
    rf"(?!not\b)(?:\w+ )?{_ORDINARY}(?! *(?:for|,? *but|,? *except|hazard))",
    r"\beverything (?:\w+ ){0,2}(?:fine|normal|ordinary|in order)",
    r"\bin distribution|\bbusiness as usual",
    USUAL,
)
"""Calls a scene ordinary."""

_SOMETHING_ODD = compiled(
    rf"\b(?:{_ODD}|unexpectedly|rare|hazardous|something (?:is|looks|seems) (?:off|wrong|amiss))\b",
    UNUSUAL,
)
"""Calls a scene odd, where nothing denies it."""

_VERDICT_WORDS = compiled(
    _ODD,
    _ORDINARY,
    r"\b"
    + either(
        r"yes|no|true|not|definitely|certainly|clearly|really|absolutely|very|quite|highly|fairly",
        r"i|i'm|i'd|am|is|are|was|be|say|call|would|so",
        r"it|its|it's|this|that|that's|there|there's|here|me|the|an?|of|in|for|to",
        r"something|thing|scene|situation",
        r"confidence|confident|sure|certain|high|medium|low",
    )
    + r"\b",
)
"""What a verdict is made of."""

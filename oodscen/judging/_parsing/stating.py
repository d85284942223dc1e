"""Finds the one option that plain English prose states as its answer, if it clearly states one.

Every option in the text is a single character here (`OPTION`), which keeps the patterns short. A sentence counts
only if all of it has one of a few forms: "I would X", "the safest action is X because ...", "Answer: X", "X".
Denials, conditions, questions, reports and statements about others match none of them.
"""

import re

from oodscen.judging._parsing.surroundings import DOUBTS, FEW, points_back
from oodscen.judging._parsing.text import TWO_ANSWERS, UnusableError

FIRST, GERUNDS = 0xE000, 0x800
"""The character of the first option, and the offset of an option named as a gerund ("stopping", not "stop")."""
OPTION = f"[{chr(FIRST)}-{chr(FIRST + 2 * GERUNDS - 1)}]"
_BASE = f"[{chr(FIRST)}-{chr(FIRST + GERUNDS - 1)}]"


def stated(plain: str) -> int | None:
    """Return the number of the option that folded prose states; `None` if it states none.

    Raises:
        UnusableError: If it states two, or one and then something against it.
    """
    if _UNREAL.search(plain):
        return None
    sentences = _sentences(plain)
    stating = {
        index: found for index in range(len(sentences)) if (found := _stated_in(sentences, index))
    }
    options = {_number(found) for found in stating.values()}
    if len(options) > 1:
        raise UnusableError(TWO_ANSWERS)
    if options & denied(plain):
        raise UnusableError("it is stated and denied")
    for sentence in sentences[max(stating) + 1 :] if stating else ():
        others = {_number(one) for one in re.findall(OPTION, sentence)} - options
        is_short = len(sentence.split()) < FEW
        if (
            others
            or _AGAINST.search(sentence)
            or _NO.match(sentence)
            or _UNSAYS.match(sentence)
            or points_back(sentence)
            or (is_short and DOUBTS.search(sentence))
        ):
            raise UnusableError("something else is said after the answer")
    return options.pop() if options else None


def options_in(plain: str) -> set[int]:
    """Return the numbers of the options that folded prose names, in whatever way."""
    return {_number(option) for option in re.findall(OPTION, plain)}


def denied(plain: str) -> set[int]:
    """Return the numbers of the options that folded prose rules out without a condition."""
    return {
        _number(found[1] or found[2])
        for sentence in _sentences(plain)
        if not _CONDITIONAL.search(sentence)
        for found in _RULED_OUT.finditer(sentence)
        if not (found[1] and _OTHERS.search(sentence[: found.end()]))
    }


def _number(option: str) -> int:
    return (ord(option) - FIRST) % GERUNDS


def _sentences(plain: str) -> list[str]:
    """Return the sentences with their end marks; text under the heading "reasons" is dropped."""
    plain = _HEADING.sub(r"\1: ", _REASONS.sub("", plain))
    plain = _READY.sub("", plain.replace(":\n", ": "))
    plain = re.sub(rf"({OPTION})(?:[\s(:,=.\u2013-]{{1,3}}\1)+\)?", r"\1", plain)
    sentences: list[str] = []
    for part in re.findall(r"[^.;!?\n]*(?:[.;!?](?!\s|$)[^.;!?\n]*)*(?:[.;!?]+|\n|$)", plain):
        so = _SO_THEN.search(part)
        if so and not _AGAINST.search(part[: so.start()]):
            sentences += [f"{part[: so.start()].strip()}.", part[so.end() :].strip()]
        elif part.strip():
            sentences.append(part.strip())
    return sentences


_ANSWER = r"(?:\u2022 ?)?(?:the |my )?(?:final |chosen |best )?(?:answer|action|choice|decision)"
_HEADING = re.compile(rf"^({_ANSWER}) ?:?\n+", re.MULTILINE)
_REASONS = re.compile(
    r"^(?:\u2022 ?)?(?:reason(?:s|ing)?|analysis|thoughts?|explanation|justification)"
    rf" ?:(?:[^\n]*\n?(?!{_ANSWER}\b))*",
    re.MULTILINE,
)
_READY = re.compile(rf",?(?: and)? (?:be (?:ready|prepared)|prepare) to {OPTION}(?: if needed)?")
_SO_THEN = re.compile(rf",? (?:so|hence|thus|therefore) (?=(?:i|we|the|my) |i'|let's |{OPTION})")

# ------------------------------------------------------------------ a sentence that states an answer

_EGO = (
    r"(?:i|we|you|(?:the )?ego(?: vehicle| car)?|(?:my|our) (?:car|vehicle)"
    r"|the (?:self driving|autonomous) (?:car|vehicle)|the (?P<other>car|vehicle|driver))"
)
_WILL = (
    r"(?: (?:would|will|should|must|shall|needs? to|ha(?:ve|s) to|am going to)|'d|'ll|'m going to)"
)
_ADVERB = r"(?: (?:definitely|probably|now|therefore|simply|just|immediately|rather))?"
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
_HERE = r"(?: (?:here|now|in this (?:case|situation)|for (?:the ego(?: vehicle)?|us|me)))?"
_IS = r" ?(?:(?:is|would be|should be|will be|remains|:|=|->|\u2192|\u2014|\u2013|-) ?)+"
_SO = r"(?:(?:so|therefore|thus|hence|overall|finally|now|conclusion|in conclusion|yes|ok)[,:]? ?)*"
_SINCE = r"(?:(?:given that|since|because|as the|due to|to avoid)[^,:]{0,200}[,:] )?"
_I_THINK = r"(?:i (?:think|believe|recommend|suggest)(?: that)? )?"
_FORMS = tuple(
    re.compile(f"{_SO}{_SINCE}{_SO}{_I_THINK}{form}")
    for form in (
        rf"{_EGO}{_WILL}{_ADVERB}(?: {_CHOOSE})?{_THE}(?P<it>{OPTION})",
        rf"(?:i|we){_ADVERB} (?:{_CHOOSE}{_THE})?(?P<it>{OPTION})",
        rf"(?:let's |let us |(?:i'm )?going with |(?:it|that|this)(?: is|'s){_THE})(?P<it>{_BASE})",
        rf"(?:let's )?{_CHOOSE}{_THE}(?P<it>{OPTION})",
        rf"(?:\u2022 ?)?(?:the |my )?(?:{_GOOD} )*(?:{_THING}|{_GOOD}){_HERE}{_IS}{_THE}(?P<it>{OPTION})",
        rf"(?P<it>{OPTION}) (?:is|would be|seems) (?:the |my )?(?:only )?{_GOOD}(?: {_THING})?{_HERE}",
        rf"[\s\u2022('.:-]{{0,8}}(?:assistant ?: ?)?(?:just |option )?(?P<bare>(?P<it>{_BASE}))",
        rf"(?P<bare>(?P<it>{OPTION})[\s.!)]*$)",
    )
)
_GOES_ON = re.compile(
    r"(?:,? (?:now|here|immediately|at once|right away|gently|safely|carefully|for now|action|maneuver))*[\s)]*"
    r"(?:[\s.;!)]*$"
    r"|(?P<place>,? (?:in (?:the|my|its|our) lane|in front of|behind|before|until|within)\b)"
    r"|[,;]? ?\(?(?:because|since|as (?=the |there |it |this |we |i )|due to|so that|in order to|which"
    r"|to (?:avoid|let|prevent|give|allow|ensure|reduce|wait|yield)|given|and (?:wait|let|yield|stay))\b)"
)
"""Matches the rest of a sentence if it adds only a place or a reason to an option."""
_AGAINST = re.compile(
    r"\b(?:but|however|though|although|unless|if|instead|otherwise|wait|actually|would have|when|once|opposite"
    r"|wrong|worst|worse|incorrect|mistake\w*|jok(?:e|ing)|kidding|example|theory|supposed|had|were|provided|as long as"
    r"|bad|false|except|scratch|strike|correction|on second thou?ght|take (?:that|it) back|chang\w+ my mind"
    r"|reconsider\w*|second (?:best|safest)|riskiest|disregard|ignore|i (?:lied|misspoke|meant)"
    r"|not (?:my|the|an?) (?:answer|choice|option)|(?:not|n't) (?:do|choose|pick) (?:that|this|it|so))\b|\bno[,:]|\?"
)
"""Matches words that retract the statement of a sentence or make it conditional."""
_NO = re.compile(r"\W*(?:or|not|no|nope|hmm+|oops|sorry|only|never ?mind)\b")
_CONDITIONAL = re.compile(r"\b(?:if|unless|otherwise|when|where)\b")
_RULED_OUT = re.compile(
    r"(?:\b(?:not|never|cannot|refuse|decline|unable|wrong|unsafe)|n't)"
    rf" (?:(?:to|a|an|be|do|choose|pick|select|take|answer|say|simply|just) )*({OPTION})"
    rf"|({OPTION})(?: here| now)? (?:(?:is|was|would be|seems)(?:n't| not| never)"
    r"|(?:is|would be) (?:wrong|unsafe|impossible|out of the question|the wrong|ruled out)"
    r"|not\b|never\b|(?:i|we) (?:will|would|can|must|should|do|shall) ?not\b)"
)
"""Matches an option that is ruled out."""
_OTHERS = re.compile(
    r"\b(?:it|he|she|they|others?|(?:the|a|an) (?!ego\b|self\b|autonomous\b)\w+)(?: \w+){0,2}"
    r" (?:must|should|will|would|can(?:not)?|could|do(?:es)?|did|may|might)(?:n't)?\b"
)
"""Matches road users other than the ego as the subject."""
_UNSAYS = re.compile(
    r"(?:(?:but|yet|still|and|alas),? )?(?:i|we)\b[^,;]*\b(?:not|never|no|nothing|anything)\b|(?:i|we)\b[^,;]*n't\b"
    r"|(?:but|yet|still|alas)\b|.*\b(?:psych|forget (?:it|that|this)|lied|(?:a|all) lies?|reverse)\b"
)
"""Matches a sentence that unsays the one before it."""
_FINITE = re.compile(rf"\b(?:is|are|was|would|could|might|may|will|can|has|have|then)\b|{OPTION}")
_REJECTS = re.compile(
    r"\b(?:wrong|worst|avoid|reject\w*|ruled? out|never|unsafe|bad|impossible|none|(?:not|n't) know"
    r"|e\.g|example|instance|other (?:car|vehicle|driver)|instead of)\b"
)
_UNREAL = re.compile(
    r"\b(?:suppos(?:e|ing)|imagine|pretend(?:ing)?|hypothetical(?:ly)?|sarcas\w+|role ?play"
    r"|\w+ (?:says|said|shouts?|shouted|yells?|yelled|asks|asked|told)|(?:they|people|some|others|rules) say"
    r"|opposite (?!(?:lane|direction|side|traffic|vehicle|car)\b))\b"
)
"""Matches words that make a text hypothetical or a report of what others say."""
_LONGEST_SENTENCE = 600
"""The longest sentence that can state an option, in characters."""


def _stated_in(sentences: list[str], index: int) -> str:
    """Return the option that a sentence states; empty if it states none."""
    sentence = sentences[index]
    if len(sentence) > _LONGEST_SENTENCE:
        return ""
    for form in _FORMS:
        found = form.match(sentence)
        if not found or not _ends_well(sentence, found):
            continue
        given = found.groupdict()
        if given.get("other") and _count(given["other"], sentences) > 1:
            continue
        if given.get("bare") and index and not _leads_to_an_answer(sentences[index - 1]):
            continue
        return found["it"]
    return ""


def _ends_well(sentence: str, found: re.Match[str]) -> bool:
    """Return whether only a place or a reason follows the option and nothing in the sentence contradicts it."""
    end = _GOES_ON.match(sentence, found.end())
    if not end or _AGAINST.search(sentence):
        return False
    rest = sentence[end.end() :]
    if end["place"] and (len(rest.split()) > 8 or _FINITE.search(rest)):
        return False
    return {_number(one) for one in re.findall(OPTION, rest)} <= {_number(found["it"])}


def _count(noun: str, sentences: list[str]) -> int:
    """Return the number of road users a text may mention; if there are two, "the car" may be the other one."""
    others = rf"\b(?:{noun}|truck|lorry|bus|van|motorcycle|bicycle|cyclist|he|she)s?\b"
    return sum(len(re.findall(others, one)) for one in sentences)


def _leads_to_an_answer(before: str) -> bool:
    """Return whether a bare option can answer after this sentence: not after a question, heading or list."""
    return bool(re.search(r"[^\d\s][.!;]$", before)) and not _REJECTS.search(before)

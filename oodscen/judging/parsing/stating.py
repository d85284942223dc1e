"""Which single option a text of plain English states as its answer, if it plainly states one.

The options that a text names are single characters here (`OPTION`), so that a sentence is a short pattern. A sentence
counts only where all of it has one of a few forms: "I would X", "the safest action is X because ...", "Answer: X", "X".
Whatever is denied, conditional, asked, reported or said of others has none of them.
"""

import re

FIRST, FIRST_GERUND, LAST = 0xE000, 0xE800, 0xEFFF
"""Characters that stand for options: by base form ("stop"), and by gerund ("stopping"), `FIRST_GERUND - FIRST` higher."""

OPTION = f"[{chr(FIRST)}-{chr(LAST)}]"
_IMPERATIVE = f"[{chr(FIRST)}-{chr(FIRST_GERUND - 1)}]"
_LONGEST_SENTENCE = 600
"""Longer sentences state nothing, in characters."""


class AmbiguousError(ValueError):
    """A text states two options, or takes one back."""


def stated(plain: str) -> int | None:
    """Return the number of the option that folded prose states, `None` where it states none.

    Raises:
        AmbiguousError: When it states two, or one and then something against it.
    """
    sentences = _sentences(plain)
    if _UNREAL.search(plain):
        return None
    committed = [
        (index, found) for index in range(len(sentences)) if (found := _committed(sentences, index))
    ]
    options = {found for _, found in committed}
    if len(options) > 1:
        raise AmbiguousError("two answers")
    if not committed:
        return None
    option = options.pop()
    for sentence in sentences[committed[-1][0] + 1 :]:
        if _CORRECTION.search(sentence) or _names_others(sentence, option):
            raise AmbiguousError("something else is said after the answer")
    return number(option)


def number(option: str) -> int:
    """Return which option a character stands for."""
    return (ord(option) - FIRST) % (FIRST_GERUND - FIRST)


def _sentences(plain: str) -> list[str]:
    """Return the sentences, each with the mark that ends it; reasons under a heading of their own are dropped."""
    plain = _REASONS.sub("", plain)
    plain = _HEADING.sub(r"\1: ", plain)
    plain = re.sub(r":\n", ": ", plain)
    plain = _SURE.sub("", _READY.sub("", plain))
    plain = re.sub(rf"({OPTION})(?:[\s(:,=.\u2013-]{{1,3}}\1)+\)?", r"\1", plain)
    parts = [
        part.strip()
        for part in re.findall(r"[^.;!?\n]*(?:[.;!?](?!\s|$)[^.;!?\n]*)*(?:[.;!?]+|\n|$)", plain)
    ]
    sentences: list[str] = []
    for part in filter(None, parts):
        turn = _SO_THEN.search(part)
        if turn and not _CONDITION.search(part[: turn.start()]):
            sentences += [f"{part[: turn.start()]}.", part[turn.end() :]]
        else:
            sentences.append(part)
    return sentences


_REASONS = re.compile(
    r"^(?:\u2022 ?)?(?:reason(?:s|ing)?|analysis|thoughts?|thinking|explanation|justification|rationale|observations?|why)"
    r" ?:(?:[^\n]*\n?(?!(?:\u2022 ?)?(?:the |my )?(?:final )?(?:answer|action|choice|decision)\b))*",
    re.MULTILINE,
)
_HEADING = re.compile(
    r"^((?:the |my )?(?:final |chosen |best )?(?:answer|action|choice|decision)) ?:?\n+",
    re.MULTILINE,
)
_READY = re.compile(
    rf"(?:,? and|,)? (?:be (?:ready|prepared)|prepare) to {OPTION}(?: if needed| if necessary)?"
)
_SURE = re.compile(
    r",? ?\(?(?:confidence|certainty)(?: (?:is|of))?[ :=]{0,3}\d[\d.]{0,5} ?(?:%|/ ?10{1,2})?\)?"
)
_CONDITION = re.compile(r"\b(?:if|unless|when|were|had)\b")
_SO_THEN = re.compile(rf",? (?:so|hence|thus|therefore) (?=(?:i|we|the|my|let's) |i'|{OPTION})")

# ------------------------------------------------------------------ a sentence that states an answer

_EGO = (
    r"(?:i|we|you|(?:the )?ego(?: vehicle| car)?|(?:my|our) (?:car|vehicle)|the (?:self driving|autonomous) (?:car|vehicle)"
    r"|the (?P<other>car|vehicle|driver))"
)
_WILL = r"(?:(?: would| will| should| must| shall| needs? to| ha(?:ve|s) to| am going to)|'d|'ll|'m going to)"
_ADVERB = r"(?: (?:definitely|probably|then|now|therefore|simply|just|immediately|rather|still|personally|strongly|best))?"
_CHOOSE = (
    r"(?:choose|pick|select|go with|opt for|opt to|recommend|suggest|advise|decide to|decide on|vote for|take|do|perform"
    r"|execute|initiate|make|say|answer|prefer)"
)
_CALLED = r"(?: to| the| an?)?(?: (?:action|option|number|answer))?(?: of| to| is)? ?:? ?"
_GOOD = (
    r"(?:best|safest|wisest|right|correct|appropriate|recommended|chosen|selected|proper|optimal|final|safer|sensible"
    r"|most (?:appropriate|sensible|prudent|reasonable|suitable))"
)
_THING = (
    r"(?:answer|ans|action|choice|option|decision|response|verdict|move|course of action|thing to do|thing|maneuver|manoeuvre|pick"
    r"|recommendation|conclusion|selection|description|match|reaction|output|result)"
)
_HERE = r"(?: (?:here|now|in this (?:case|situation|scene|scenario)|for (?:the ego(?: vehicle| car)?|us|me)|(?:i|we) (?:choose|select|take)|to take))?"
_SO = (
    r"(?:(?:so|therefore|thus|hence|then|accordingly|consequently|overall|in (?:conclusion|summary|short|the end)|ultimately|finally|conclusion"
    r"|now|here|for now|in this (?:case|situation)|as a result|yes|ok|okay|sure)[,:]? ?)*"
)
_GIVEN = (
    r"(?:(?:given (?:that|the (?!choice|chance|opportunity|option))|since|because|as the|due to|considering|based on|to avoid|to be safe)"
    r"[^,:]{0,200}[,:] )?"
)
_I_THINK = r"(?:i (?:think|believe|feel|guess|recommend|suggest|would say|conclude)(?: that)? )?"
_GOES_ON = re.compile(
    r"(?:,? (?:now|here|immediately|at once|right away|right now|instead|gently|gradually|smoothly|safely|carefully|completely"
    r"|for now|please|promptly|in time|action|maneuver|manoeuvre))*[\s)]*"
    rf"(?:(?P<place>,? (?:in (?:the|my|its|our|this) (?:current )?lane|in front of|behind|before|until|within|around)\b)"
    rf"|(?P<contrast>,? ?\(?(?:not|rather than|instead of|over|than) (?=(?:to |an? |the )?{OPTION}))"
    r"|(?P<reason>[,;]? ?\(?(?:because|since|as (?=the |there|it |this |that |we |i |my |our )|due to|so that|in order to|which|this"
    r"|to (?:avoid|let|prevent|give|allow|ensure|reduce|minimi[sz]e|maintain|wait|yield|stay)|given|and (?:wait|let|yield|stay|remain))\b)"
    r"|[\s.;!)]*$)"
)
_FORMS = tuple(
    re.compile(rf"{_SO}{_GIVEN}{_SO}{form}")
    for form in (
        rf"{_I_THINK}{_EGO}{_WILL}{_ADVERB}(?: {_CHOOSE})?{_CALLED}(?P<it>{OPTION})",
        rf"{_I_THINK}(?:i|we){_ADVERB} (?:{_CHOOSE}{_CALLED})?(?P<it>{OPTION})",
        rf"(?:let's |let us )?{_CHOOSE}{_CALLED}(?P<it>{OPTION})",
        rf"(?:let's |let us |(?:i'm |i am )?going with |choosing |{_I_THINK}(?:it|that|this)(?: is|'s){_CALLED})(?P<it>{_IMPERATIVE})",
        rf"(?:\u2022 ?)?{_I_THINK}(?:the |my )?(?:only )?(?:{_GOOD} )*(?:{_THING}|{_GOOD}){_HERE}"
        rf" ?(?:is|would be|will be|should be|must be|remains|to (?:take|choose) is|:|=|->|=>|\u2192|\u2014|\u2013|-)+"
        rf" ?:?{_CALLED}(?P<it>{OPTION})",
        rf"{_I_THINK}it (?:is|would be|'s) (?:best|safest|wisest|better|necessary|advisable|prudent|wise|safer) to (?P<it>{OPTION})",
        rf"{_I_THINK}(?P<it>{OPTION}) (?:is|would be|seems|looks|remains) (?:clearly )?(?:the |my )?(?:only )?{_GOOD}(?: {_THING})?{_HERE}",
    )
)
_BARE = re.compile(rf"{_SO}(?:assistant ?: ?)?(?:just |option )?(?P<it>{_IMPERATIVE})")
_BARE_ALONE = re.compile(rf"[\s\u2022('.:-]{{0,8}}(?P<it>{OPTION})[\s.!)]*")


def _committed(sentences: list[str], index: int) -> str:
    """Return the option that a sentence states, empty where it states none."""
    sentence = sentences[index]
    if len(sentence) > _LONGEST_SENTENCE or sentence.endswith("?"):
        return ""
    for form in _FORMS:
        found = form.match(sentence)
        if found and _ends_well(sentence, found) and not _is_another(found, sentences):
            return _base(found["it"])
    found = _BARE.match(sentence) or _BARE_ALONE.fullmatch(sentence)
    if (
        found
        and _ends_well(sentence, found)
        and (not index or _leads_to_an_answer(sentences[index - 1]))
    ):
        return _base(found["it"])
    return ""


def _base(option: str) -> str:
    return chr(FIRST + number(option))


def _ends_well(sentence: str, found: re.Match[str]) -> bool:
    """Whether what follows an option in its sentence adds reasons or a place, and takes nothing back."""
    end = _GOES_ON.match(sentence, found.end())
    lead = sentence[: found.start("it")]
    if not end or _CONDITION.search(lead) or _TURN.search(lead):
        return False
    rest = sentence[end.end() :]
    if end["contrast"]:
        return not _TURN.search(rest) and not _names_others(
            sentence[found.end() :], _base(found["it"])
        )
    if end["place"]:
        return len(rest.split()) <= 8 and not _TURN.search(rest) and not _VERB.search(rest)
    return not _TURN.search(rest) and not _names_others(rest, _base(found["it"]))


_TURN = re.compile(
    r"\b(?:but|however|though|although|unless|if|instead|otherwise|wait|actually|said|says|would have|when|once|opposite|wrong"
    r"|worst|mistake|joke|joking|example|theory|supposed|had|were|as long as|provided|example|bad)\b|\bno[,:]|\?"
)
_VERB = re.compile(
    rf"\b(?:is|are|was|would|could|might|may|will|can|has|have|seems|looks|means|risks|leads|causes|then)\b|{OPTION}"
)


def _is_another(found: re.Match[str], sentences: list[str]) -> bool:
    """Whether "the car" may be another than one's own: the text speaks of a car elsewhere, too."""
    noun = found.groupdict().get("other")
    return bool(noun) and sum(len(re.findall(rf"\b{noun}s?\b", one)) for one in sentences) > 1


def _leads_to_an_answer(before: str) -> bool:
    """Whether an option alone may answer after this sentence: it is no question, heading or list."""
    return bool(re.search(r"[^\d\s][.!;]$", before)) and not _REJECTS.search(before)


_REJECTS = re.compile(
    r"\b(?:wrong|worst|avoid|reject\w*|ruled? out|never|unsafe|bad|impossible|none|(?:not|n't) know|other (?:car|vehicle|driver)|instead of)\b"
)

# ------------------------------------------------------------------ against an answer

_CORRECTION = re.compile(
    r"^\W*(?:or|not|no|nope|but|however|wait|actually|hmm+|oops|sorry|scratch|strike|correction|instead|on second thou?ght|edit|unless"
    r"|only if|although|though|except|just kidding|psych|never ?mind)\b"
    r"|\b(?:wrong|incorrect|mistake\w*|take (?:that|it) back|chang\w+ my mind|reconsider\w*|kidding|joking|sarcas\w+"
    r"|though|however|second (?:best|safest)|riskiest|not (?:my|the|an?) (?:answer|choice|final|option)|i (?:lied|misspoke|meant)|disregard|ignore (?:that|this|the above)"
    r"|(?:wouldn't|would not|won't|will not|don't|do not|shouldn't|should not) (?:do|choose|pick) (?:that|this|it|so))\b"
)
_UNREAL = re.compile(
    r"\b(?:suppos(?:e|ing)|imagine|pretend(?:ing)?|hypothetical(?:ly)?|kidding|joking|sarcas\w+|role ?play"
    r"|(?:he|she|they|sign|officer|police|driver|instructor|book|rule|manual|passenger|\w+) (?:says|said|shouts?|shouted|yells?|yelled|asks|asked|told)"
    r"|(?:they|people|some|others|rules|experts) say"
    r"|opposite (?!(?:lane|direction|side|traffic|vehicle|car)\b))\b"
)
"""Makes a text one about what is not, or about what others say."""


def _names_others(text: str, option: str) -> bool:
    """Whether a text names an option other than this one, and does not dismiss it."""
    for found in re.finditer(OPTION, text):
        around = (
            text[max(0, found.start() - 30) : found.start()],
            text[found.end() : found.end() + 60],
        )
        if _base(found.group()) != option and not (
            _DISMISSED_BEFORE.search(around[0]) or _DISMISSED.match(around[1])
        ):
            return True
    return False


_DISMISSED_BEFORE = re.compile(
    r"\b(?:than|over|instead of|not|cannot|can't|too late to|no (?:time|room|need) to|avoid|neither|nor|without) (?:to |a |an |the )?$"
)
_DISMISSED = re.compile(
    rf"(?: or {OPTION})*(?:(?! and | but |better|best|safe|prefer|right|{OPTION})[^.;!?\n]){{0,40}}?\b(?:not|too|un\w+|collide|collision|hit|crash|risk\w*|danger\w*|insufficient|blocked"
    r"|impossible|late|cannot|fails?|second|worse|excessive)\b|(?:is|are|was|would|could|should|does|do)n't\b"
)

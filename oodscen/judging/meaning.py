"""How a text means an option that it names: rejects, weighs, concludes, chooses or gives it."""

import re
from dataclasses import dataclass

from oodscen.judging.languages import ANSWER, CONDITION, DENIAL, IS
from oodscen.judging.patterns import compiled, either, few
from oodscen.judging.wording import Mention

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
    reply = _REPLY.match(text, mention.end)
    if reply:
        return Meant(mention, 2 if reply["is_yes"] else -2)
    return Meant(mention, _level(*_sentence_around(text, mention)))


_REPLY = compiled(r"\? *(?:(?P<is_yes>yes|yep|yeah)|no|nope)\b(?! (?:one|other|matter)\b)")
"""Answers a question of its own: "stop? Yes"."""


def _sentence_around(text: str, mention: Mention) -> tuple[str, str, bool]:
    """Return what stands before and after a mention in its sentence, and whether that asks."""
    near = max(0, mention.start - WINDOW)
    ends = re.finditer(r"[.;!?](?:\s|$)|\n", text[near : mention.start])
    start = near + max((match.end() for match in ends), default=0)
    rest = text[mention.end : mention.end + WINDOW]
    stop = re.search(r"[.;!?\n]", rest)
    after = rest[: stop.start()] if stop else rest
    return text[start : mention.start], after, bool(stop and stop.group() == "?")


def _level(before: str, after: str, is_question: bool) -> int:
    """Return the level of what stands between two parts of a sentence; the first rule counts."""
    if _is_rejected(before, after) or _is_denied(before, after):
        return -2
    scope = before[_last_end(_SCOPE_ENDS, before, but=r"because|since|:") :]
    if (
        is_question
        or (_OR_ELSE.search(before) and _IF.search(after))
        or _LATER_CHOICE.search(before)
        or _EARLIER.search(scope)
    ):
        return -1
    if _TICKED.search(before) or _reaches(FINAL, before):
        return 3
    if _CONDITIONED.search(scope) or CONDITION.search(before):
        return -1
    if _reaches(CHOICE, before):
        return 2
    if _HEDGED_BEFORE.search(scope) or _HEDGED_AFTER.search(after):
        return -1
    if PRAISE.search(after):
        return 2
    return 1 if CONCLUSION.search(before) else 0


def _last_end(pattern: re.Pattern[str], text: str, but: str = "") -> int:
    """Return where the last match ends, apart from those whose whole text is like `but`."""
    ends = [
        match.end()
        for match in pattern.finditer(text)
        if not (but and re.fullmatch(but, match.group()))
    ]
    return max(ends, default=0)


# ------------------------------------------------------------------ rejected


def _is_rejected(before: str, after: str) -> bool:
    scope = before[_last_end(_SCOPE_ENDS, before) :]
    if _is_negated(scope, after):
        return True
    if _NEGATED_CLOSELY.search(scope) or re.search(r"\bno:\s*$", before):
        return True
    if _WOULD_CRASH.match(after) and re.search(r"\bif\b", scope):
        return True
    if _MARKED_WRONG.search(after) or _CROSSED.search(before):
        return True
    return bool(_FAULTED.search(_CLAUSE_ENDS.split(after)[0]))


def _is_negated(scope: str, after: str) -> bool:
    """Whether a negation governs a name; a comma ends it, unless it goes on: "not a, b or c"."""
    negations = list(_NEGATIONS.finditer(scope))
    if not negations:
        return False
    between = scope[negations[-1].end() :]
    in_list = re.search(r"\b(?:or|nor)\s+(?:\w+\s+){0,2}$", between)
    return "," not in between or bool(in_list or re.match(r"\s*,?\s*(?:or|nor)\b", after))


_NEGATIONS = compiled(
    r"\b"
    + either(
        r"not|n't|dont|cannot|cant|wont|isnt|doesnt|shouldnt",
        r"never|neither|nor|no|hardly",
        r"nicht|kein\w*|statt|anstatt|ohne",
        r"sans|pas|au lieu de",
        r"sin|en lugar de",
        r"instead of|rather than|(?:as )?opposed to|anything but",
        r"rul(?:e|es|ed|ing) out",
        r"reject(?:s|ed|ing)?",
        r"exclud(?:e|ed|ing)",
        r"discard(?:ed|ing)?",
        r"dismiss(?:ed|ing)?",
        r"(?:unsafe|dangerous|risky|impossible|unnecessary|unwise|mistake|wrong|reckless|foolish"
        r"|fatal) to",
        r"too (?:late|dangerous|risky|close|fast) to",
        r"(?:worst|bad) (?:choice|option|idea|action) (?:is|would be)",
        r"less \w+ than|better than|safer than|over just",
    )
    + r"\b",
    r"(?<=[a-z])n't\b",
)
"""Rejects what follows it, as far as its clause goes."""

_NEGATED_CLOSELY = compiled(
    r"\b(?:avoid(?:ing)?|without|instead of|except|against|unlike|than|no more) (?:\w+ )?$",
    r"\bover $",
)
"""Rejects what follows it at once, or after one word: "avoid a" stop."""

_SCOPE_ENDS = compiled(
    r"[.;!?\n\u2014]",
    r"\b(?<!anything\s)but\b",
    r"\b(?:however|so|therefore|thus|hence|then|because|since|sondern)\b",
    r"\binstead\b(?! of)",
    r"\brather\b(?! than)",
    r"\b(?:and|i) (?:(?:will|would) )?(?:choose|pick|select|go|take|opt)\b",
    r":(?!\S)",
)
"""Ends what a negation or a hedge before it is about."""

_WOULD_CRASH = compiled(
    r" *,? *(?:we|i|it|the \w+) (?:may|might|could|would|will|'d|'ll) (?:\w+ )?"
    r"(?:collide|hit|crash)"
)

CROSS = r"[\u274c\u274e\u2716\u2717\u2718\u00d7\U0001f6ab]"
_CROSSED = compiled(rf"^\W*{CROSS}\W*$")

_NOT_GOOD = (
    r"not (?:safe|possible|available|advisable|needed|necessary|enough|ideal|good|recommended"
    r"|an?\b)"
)
_MARKED_WRONG = compiled(
    rf"^ *(?:[(:\u2014-] *)?(?:no\b|{CROSS})",
    r"^ *[(:\u2014-] *(?:\w+ly )?"
    + either(
        _NOT_GOOD,
        r"unsafe|dangerous|too|impossible|risky|wrong",
        r"unnecessar\w+|insufficient|excessive|overkill",
    )
    + r"\b",
)
"""A verdict in a list of options: "stop: no", "stop (too late)"."""

_CLAUSE_ENDS = compiled(r"[,;\u2014]|\b(?:because|since|but|so|and|as|which|while)\b")

_FAULTED = compiled(
    rf"^ *{few(3)}"
    + either(
        rf"(?:is|are|would be|will be|seems|looks|was|'s) {few(2)}"
        + either(
            _NOT_GOOD,
            r"unsafe|dangerous|risky|riskier|impossible|unavailable|blocked",
            r"unnecessary|insufficient|inadequate|excessive|overkill",
            r"worse|wrong|out of|a bad|the worst|a mistake",
            r"ruled|rejected|no (?:good|option|longer)",
            r"too\b",
        ),
        r"(?:is|are|would|wo|ca|do|does|could|should|can) *(?:n't|not\b)",
        r"cannot|never works",
        r"would (?:\w+ )?"
        r"(?:hit|collide|cause|risk|fail|lead|end|result|put|be (?:too|un|dangerous|risky|hit))",
        r"(?:fails?|risks?|leads? to a (?:crash|collision))\b",
        r"\?",
    )
)
"""Finds fault with the name that it follows: "is too late", "would cause a collision"."""


def _is_denied(before: str, after: str) -> bool:
    """Whether another language denies a name anywhere in its clause, as it often does after it."""
    clause = before[_last_end(_CLAUSE, before) :] + " \n " + _CLAUSE.split(after, maxsplit=1)[0]
    return bool(DENIAL.search(clause))


_CLAUSE = re.compile(r"[.;!?,:\n\u2014]")

# ------------------------------------------------------------------ only considered

_OR_ELSE = compiled(r"\bor (?:\w+ )?$")
_IF = compiled(r"^ *(?:if|when|in case|should|as needed|only if)\b")
"""After "or stop" it makes a second thought of it: "slow down, or stop if needed"."""

_LATER_CHOICE = compiled(
    r"\b"
    + either(
        r"(?:second|2nd|third|3rd)(?! (?:frame|image|picture|photo|lane|vehicle|car))",
        r"alternative|alternatively|backup|back up|fallback|runner up|next best",
    )
    + r"\b[^.;!?\n]*$"
)
_EARLIER = compiled(
    r"\b(?:initially|at first|originally|(?:would|'d) have (?:said|chosen|picked))\b[^.;!?\n]*$"
)
_CONDITIONED = compiled(
    r"\b(?:if|unless|in case)\b[^,]*,[^,]*$",
    r"\b(?:otherwise|else|if not)\b[^.;!?\n]*$",
)
_HEDGED_BEFORE = compiled(
    r"\b"
    + either(
        r"could|might|may|maybe|perhaps|possibly|possible|consider(?:ed|ing)?",
        r"if|unless|whether|otherwise|although|though|while",
        r"options?(?: are| include|:)|between|either|alternativ\w+|second best",
        r"at first(?: glance| sight)?|initially|first (?:idea|thought|instinct|impulse)",
        r"in principle|usually",
        # somebody else does it: "the pedestrians ahead may stop"
        r"ahead|pedestrians?|they|he|she",
        r"(?:prepared?|ready|readiness|able) to|ready for",
    )
    + r"\b[^.;!?\n,]*$"
)
_HEDGED_AFTER = compiled(
    r"^ *"
    + either(
        r"could|might|may",
        r"is (?:an|one|another) option",
        r"(?:is|would be|seems) (?:also )?(?:possible|feasible|tempting|acceptable|an option)",
        r"(?:is|would be|comes|seems) (?:a |the |my )?(?:close )?(?:second|next|runner)",
    )
    + r"\b"
)

# ------------------------------------------------------------------ concluded, chosen, given

TICK = r"[\u2705\u2611\u2713\u2714]"
_TICKED = compiled(rf"^\W*{TICK}\W*$")

FINAL = compiled(
    either(
        r"final(?:ly)? (?:answer|choice|decision|action|verdict|selection|output|recommendation)",
        r"\b(?:answer|ans|verdict|final|action|choice|decision|selection|boxed)",
        r"\b(?:recommendation|conclusion|output|result)",
        r"\b(?:chosen|selected)(?: action)?",
        rf"(?<![a-z]){ANSWER}",
        r"< *(?:answer|action|choice|final)\b[^a-z]*",
    )
    + rf" *(?:is|{IS}|was|would be|=+|:+|\u2014|->|\u2192|\{{|\(|\)|\]|\s)+"
    + r" *(?:(?:to|option|action) )?"
)
"""Gives what follows it as the answer: "the final answer is", "action:", "<answer>"."""

CHOICE = compiled(
    r"\b"
    + either(
        r"i (?:\w+ )?"
        + either(
            r"choose|pick|select|vote|opt|go|decide|take|prefer|say",
            r"recommend|suggest|advise",
            r"will|would|shall|should|must|need|want",
        ),
        r"i'(?:d|ll|m)\b|i am going to|let'?s",
        r"(?:it|one|we|you|the (?:ego|car|vehicle|driver|ego vehicle|ego car|self driving car)) "
        r"(?:should|must|will|needs? to|has to|have to|ought to|would (?:best|better))",
        r"(?<!second\s)"
        + either(
            r"best|safest|wisest|most (?:sensible|appropriate|prudent|reasonable)",
            r"safer|better|right|correct|only|proper|optimal|appropriate|recommended",
        )
        + rf" {few(3)}(?:is|would be|seems|:)",
        r"(?:best|safest|wisest|better|advisable|prudent|necessary|required|safer) to",
        r"(?:going|go|went) (?:with|for)|opt(?:ing)? for",
        r"my (?:pick|vote|preference|suggestion|advice)",
        r"recommended *:",
        r"choosing|choose|select|pick",
    )
    + r"\b"
)
"""Chooses what follows it: "I would", "the car should", "the safest option is"."""

PRAISE = compiled(
    rf"^ *{few(6)}(?:is|are|would be|seems|looks|remains|it is) {few(2)}"
    + either(
        r"best|safest|safer|better|right|correct|wisest|preferable|appropriate|advisable",
        r"answer|choice|my \w+",
        r"required|needed|necessary|the (?:only|way)",
    )
    + r"\b",
    r"^ *[.,!]? *(?:it is|that'?s (?:my|the) (?:answer|choice|final))",
)
"""Chooses what it follows: stop "is the safest choice"."""

CONCLUSION = compiled(
    r"\b"
    + either(
        r"therefore|thus|hence|so|consequently|accordingly|ultimately|overall",
        r"in (?:conclusion|summary|short|sum|the end|total)",
        r"that leaves|leaving|only \w+ remains",
    )
    + r"\b"
)


def _reaches(marker: re.Pattern[str], before: str) -> bool:
    """Whether a marker governs what follows the text: no reason or contrast comes in between."""
    ends = [match.end() for match in marker.finditer(before)]
    return bool(ends) and not _SUBORDINATE.search(before[ends[-1] :])


_SUBORDINATE = re.compile(
    r"\b(?:because|since|although|though|while|whereas|after|before|if|unless|as|than|when)\b"
)

# ------------------------------------------------------------------ taken back

CORRECTIONS = compiled(
    r"(?:^|[\s.,;!?\u2014(])"
    + either(
        r"(?:wait|actually|nope|correction)\b",
        r"no,|no\.\.+|hmm,? no|sorry,|oops|edit:",
        r"scratch that|strike that|i take (?:that|it) back",
        r"on second thou?ghts?|let me (?:reconsider|rethink|correct)|hold on",
        r"i (?:was wrong|misspoke|meant|mean)\b",
        r"changed? my mind|my mistake|revis(?:ed|ing|ion)\b",
    )
)
"""Takes back what was said before it."""

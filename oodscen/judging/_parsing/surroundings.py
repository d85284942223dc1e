"""Decides from the words around a JSON object whether the object is given as the answer.

The rule is strict, because a wrong reading is worse than asking again. What leads to the object may be
reasoning that has ended, or a phrase of a few known words ("Here is my answer:"). What follows may add reasons
or a courtesy. Denials, quotes, examples, conditions, comments and second thoughts on either side count against
the object.
"""

import re

from oodscen.judging._parsing.text import folded, tidied

FEW = 5
"""The length, in words, up to which a remark beside an answer is taken to be about the answer."""


def leads_to_an_answer(before: str, earlier: str = "") -> bool:
    """Return whether the text before an object presents the object as the answer, or is about something else.

    Args:
        before: The text between the object before it, or the start, and the object.
        earlier: The text before that, without its objects.
    """
    before = _COMMENTS.sub(" ", _FENCE_OPENS.sub("", before))
    if _is_commented_out(earlier + before) or _ODD_MARKS.search(before.rpartition("\n")[2]):
        return False
    *others, last = ["", *(part for part in _PARAGRAPHS.split(before) if part.strip(_QUOTES))]
    sentence = _SENTENCES.split(folded(tidied(_OPENERS.sub("", last))))[-1]
    sentence = _CORRECTS.sub("", sentence)
    has_ended = _ENDS.search(sentence) and not _ABBREVIATED.search(sentence)
    is_apart = before.rstrip(" \t`*\"'([").endswith("\n") and not _OPEN.search(sentence)
    if has_ended or is_apart:
        return not _speaks_against(sentence)
    title = folded(tidied(others[-1])) if others else ""
    if not _ENDS.search(title) and _speaks_against(_SENTENCES.split(title)[-1]):
        return False
    sentence = _ASKED_FORM.sub(" ", sentence)
    clause = _CLAUSES.split(_OPEN.sub("", sentence))[-1]
    return not DOUBTS.search(sentence) and set(re.findall(r"\w+", clause)) <= _LEADS


def runs_on(after: str) -> bool:
    """Return whether the text after an object goes on with its sentence, other than with a reason."""
    return _RUNS_ON.match(_CLOSERS.sub("", after)) is not None


def split_reasons(after: str) -> tuple[str, str]:
    """Return the tidied text after an object, and the reasons in it, which come under a heading of their own."""
    tidy = tidied(_COURTESY.sub(" ", _CLOSERS.sub("", after)))
    heading = _EXPLAINED.search(tidy)
    return (tidy[: heading.start()], tidy[heading.end() :]) if heading else (tidy, "")


def takes_back(told: str) -> bool:
    """Return whether tidied text after an object denies the object, or may: short remarks and pointers do."""
    plain = folded(told)
    if DOUBTS.search(plain) or RETRACTED.search(plain) or _DENYING_MARKS.search(plain):
        return True
    sentences = [one for one in _SENTENCES.split(plain) if re.search(r"\w", one)]
    return "?" in plain or any(
        points_back(one) or (len(one.split()) <= FEW and not _REASON.match(one))
        for one in sentences
    )


def points_back(sentence: str) -> bool:
    """Return whether a folded sentence speaks of an answer before it without praise."""
    return bool(_POINTS.match(sentence) and not _PRAISES.match(sentence))


def is_doubtful(note: str) -> bool:
    """Return whether a note beside an answer denies it: a short one, or one that speaks of the answer."""
    return any(_speaks_against(one) for one in _SENTENCES.split(folded(tidied(note))))


def _speaks_against(sentence: str) -> bool:
    """Return whether a sentence that has ended denies or quotes an answer beside it."""
    is_about_it = _ABOUT_IT.search(sentence) or len(sentence.split()) <= FEW
    return bool(is_about_it and (DOUBTS.search(sentence) or sentence.endswith("?")))


def _is_commented_out(before: str) -> bool:
    """Return whether a comment, a struck-out passage or an element of another kind is still open."""
    if before.count("~~") % 2 or any(
        before.rfind(opens) > before.rfind(closes)
        for opens, closes in (("<!--", "-->"), ("/*", "*/"))
    ):
        return True
    still_open: list[str] = []
    for ends, name in _TAGS.findall(before.casefold()):
        if not ends:
            still_open.append(name)
        elif name in still_open:
            still_open.remove(name)
    return any(re.sub(r"[\W_]", "", name) not in _ELEMENTS for name in still_open)


# ------------------------------------------------------------------ words

DOUBTS = re.compile(
    r"\b(?:not|no|nor|neither|never|none|nobody|nothing|cannot|\w+n't|without|except|but|anything|avoid\w*"
    r"|refus\w+|reject\w*|den(?:y|ies|ied)|wrong|incorrect|bad|worse|worst|unsafe|dangerous|opposite|contrary"
    r"|false|invalid|untrue|unwise|rather|instead of|mistake\w*|error|ignore|disregard|discard\w*|fail(?:s|ed)"
    r"|if|unless|whether|or|either|were|suppos\w+|imagin\w+|pretend\w*|hypothe\w+|could|might|perhaps|maybe"
    r"|sa(?:id|ys)|tells?|told|asks?|asked|wrote|writes|written|claim\w*|quot\w+|according|repl(?:ied|ies)"
    r"|answer(?:s|ed)|suggest(?:s|ed)|thinks?|thought|believes?|copied|fake|jok\w+|kidding|sarcas\w+|ironic\w*"
    r"|e\.g|eg|i\.e|example\w*|instance|such as|like|template|schema|format|placeholder|sample|drafts?"
    r"|others?|another|somebody|someone|else|old|previous\w*|former\w*|earlier|first idea)\b"
)
"""Matches denials, conditions, reports, quotes and examples in folded prose."""

RETRACTED = re.compile(
    r"(?:^|[.,;:!?\n(\u2014`-])\s*(?:oh,? )?(?:wait|actually|no|nope|hmm+|correct(?:ion|ed)|edit|sorry|oops|but"
    r"|however|instead|finally|final (?:answer|decision)|on (?:second thou?ght|reflection)|scratch|strike|not"
    r"|revis\w+|better)\b|\b(?:wrong|incorrect|mistake\w*|take (?:that|it) back|chang\w+ my (?:mind|answer)"
    r"|disregard|disagree|(?:do not|don't) do (?:this|that)|ignore (?:that|this)|reconsider\w*|just kidding|joking"
    r"|opposite of|forget (?:it|that|this)|i lied|(?:a|all) lies?|the reverse|reverse that)\b",
    re.IGNORECASE,
)
"""Matches words that retract the text before them, or announce the real answer."""

_LEADS = frozenset(
    """
    1 2 a action ai am an analysis and answer appropriate as assessment assistant based below best by certainly
    change choice choose chose chosen code complete conclusion correct corrected course d decision description
    detection ego explanation final finally following for frame frames give given go hence here i image images in is
    json judgement judgment justification let ll m make me my now object of ok okay on one option our output overall
    pick please present provide question reasoning recommend recommended reply requested response result return s
    safest scene select selected selection should single so structured submit sure take that the therefore this three
    thus to valid vehicle verdict will with would your
    """.split()
)
"""The words of which a phrase that leads straight to an object may consist ("So my final answer is:")."""

_ELEMENTS = frozenset(
    """
    action answer arguments br choice code decision finalanswer function functioncall json object output p parameter
    pre response result tool toolcall
    """.split()
)
"""Elements that may hold an answer; an object in any other, such as `<example>`, is not the answer."""

_ASKED_FORM = re.compile(
    r"\b(?:in|as|using|following) (?:(?:the|a|an|your|this|valid|requested|required|specified|json|correct) )+"
    r"(?:format|form|schema|structure)\b"
)
_ABOUT_IT = re.compile(
    r"\b(?:following|below|next|answers?|response|reply|json|object|output|example|format|template|say|pick|choose"
    r"|select|this|these)\b"
)
_POINTS = re.compile(
    r"\W*(?:this|that|these|it|its|the (?:above|answer|object|response|json|previous)|above|he|she|they)\b"
)
_PRAISES = re.compile(
    r"\W*(?:this|that|it|the answer)(?: (?:action|choice|option|answer|response|maneuver|approach))?"
    r" (?:is the (?:safest|best|right|correct|most)|is (?:safest|best)|avoids|allows|ensures|gives|keeps"
    r"|minimi[sz]es|prevents|lets|maintains|leaves|reduces|provides|will|would|should)\b"
)
_CORRECTS = re.compile(
    r"^(?:(?:no|wait|actually|now|correction|revised|on (?:second thou?ght|reflection))\b[,:. ]*)+"
)
_EXPLAINED = re.compile(
    r"(?:^|\n)\W*(?:reasons?|reasoning|explanation|justification|rationale|analysis) ?:",
    re.IGNORECASE,
)
_COURTESY = re.compile(
    r"\b(?:(?:please )?let me know|i hope|hope|please (?:let|feel)|feel free|is there anything else)\b"
    r"[^.!?\n]{0,120}[.!?]?",
    re.IGNORECASE,
)

# ------------------------------------------------------------------ punctuation

_QUOTES = " \t\n`*\"'()[]"
_PARAGRAPHS = re.compile(r"\n\s*\n")
_SENTENCES = re.compile(r"(?<=[.!?;\u2026])\s+|\n+")
_CLAUSES = re.compile(r"[,;:.\u2014]\s*|\b(?:so|therefore|thus|hence)\b\s*")
_ENDS = re.compile(r"[.!?\u2026]$")
_ABBREVIATED = re.compile(r"\b(?:e\.?g|i\.e|cf|viz|ex|vs)\.$")
_OPEN = re.compile(r"[\s:,=>(\u2192\u2014\u2013-]+$")
_FENCE_OPENS = re.compile(r"(?:(?:```|~~~)[ \t]*\w{0,15}\s*)+$")
_OPENERS = re.compile(r"(?:[\s`*\"'(\[$]|\\boxed\{|<\w{1,20}>)+$")
_CLOSERS = re.compile(
    r"\A(?:[\s\x00-\x1f\u200b-\u200f\ufeff`*\"')\]}$.!;,]|~~~|</\w{1,20}>|<\|\w{1,20}\|>)*"
)
_COMMENTS = re.compile(r"<!--.*?-->|/\*.*?\*/", re.DOTALL)
_TAGS = re.compile(r"<(/?)([a-z][\w-]{0,30})(?:\s[^<>]{0,100})?>")
_NO = "[\u26d4\u274c\u274e\u2716-\u2718\U0001f44e\U0001f6ab]"
_DENYING_MARKS = re.compile(_NO)
_ODD_MARKS = re.compile(rf"^\s*(?:#|--|;|%)|//|--|(?:^|\s)[!~\u00ac]\s*[`\"'(\[]*$|{_NO}")
"""Matches marks that make the rest of their line a comment, or deny it."""
_REASON = re.compile(
    r"(?:because|since|as (?:the|there|it|we|i)|due to|given|to (?:avoid|let|give|allow|ensure|keep))\b"
)
_RUNS_ON = re.compile(
    rf"[^\w\s\u2600-\u27bf\U0001f000-\U0001faff<*_#-]|<[^/|b]|--|#[^#\s]|(?!{_REASON.pattern})[a-z]"
)

"""Parses an answer from its JSON object or labelled lines, else from its prose, and detects refusals.

What counts is listed; what is not listed makes the answer unreadable. An answer may hold one object. Around it
stand reasoning that has ended, a code fence and a phrase such as "Here is my answer:". Beside the requested
members it has reasons, a confidence and harmless comments. Lines such as `Action: stop` are parsed like an object.
"""

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen._arguments import instance_of
from oodscen._words.prose import after_reasoning, fold, is_refusal, tidy
from oodscen._words.text import clean_surrogates
from oodscen.judging._parsing.members import CONFIDENCE, REASON, is_deeper, spelt, unwrap
from oodscen.judging._parsing.reasons import disputes
from oodscen.judging._parsing.unusable import LONGEST, TWO_ANSWERS, UnusableError
from oodscen.llm._json_objects import JsonObject, scan
from oodscen.llm._reading import EMPTY, UNSPOKEN

Value = TypeVar("Value")


@dataclass(frozen=True)
class ParsedAnswer(Generic[Value]):
    """A parsed answer."""

    value: Value | None
    """`None` unless the outcome is `answered`."""
    outcome: Literal["answered", "refused", "unparsed"]
    note: str
    """The source of the value, or the reason for its absence: `JSON`, `prose`, `two answers`."""
    reasons: str = ""
    """The reasons in the members or lines beside the value; all that is said if the value is from a sentence."""


@dataclass(frozen=True)
class Question(Generic[Value]):
    """The way to find the answer to one question."""

    pick: Callable[[Mapping[str, Any]], Value | None]
    """Returns the answer in the requested members; `None` if they are missing. Raises `UnusableError`."""
    prose: Callable[[str], Value | None]
    """Returns the answer in tidied prose; `None` if there is none. Raises `UnusableError`."""
    members: re.Pattern[str]
    """Matches the names of the requested members, as `spelt` spells them."""
    denies: Callable[[str, Value], bool] | None = None
    """Returns whether tidied reasons deny or condemn a value."""
    rivals: Callable[[str, Value], bool] | None = None
    """Returns whether tidied words condemn a value or name another one."""
    has_labels: bool = True
    """Labelled lines are parsed like an object."""

    def answer_in(
        self, value: Mapping[str, Any], comments: Iterable[str] = ()
    ) -> tuple[Value | None, str]:
        """Return the answer in an object, `None` if it lacks the requested members, and the reasons beside it.

        Raises:
            UnusableError: If it is nested too deep, has a member that was not asked for, or reasons or comments
                against its own answer.
        """
        if is_deeper(value, _DEEPEST):
            raise UnusableError(f"the JSON object is nested more than {_DEEPEST} deep")
        held = unwrap(value, self.members)
        answer = self.pick(held.requested)
        if answer is not None:
            if self.denies and self.denies(tidy(held.reasons), answer):
                raise UnusableError("its reasons are against the answer")
            for aside in map(tidy, (*comments, *held.asides)):
                if disputes(aside) or (self.rivals and self.rivals(aside, answer)):
                    raise UnusableError(f"{aside[:80]!r} beside the answer may be against it")
        return answer, held.reasons.strip()


def read(text: str, question: Question[Value]) -> ParsedAnswer[Value]:
    """Parse an answer from its JSON, else from its prose.

    Raises:
        UsageError: If the answer is not a text.
    """
    instance_of("text", text, str)
    if len(text) > LONGEST:
        return ParsedAnswer(
            None, "unparsed", f"it has {len(text):,} characters; {LONGEST:,} at most"
        )
    note = "no answer is named plainly"
    try:
        spoken = spoken_text(text)
        if not spoken.strip():
            note = (UNSPOKEN if text.strip() else EMPTY).message
        only = _only_object(spoken)
        answer = only and only.value
        source = "prose" if answer is None else "JSON"
        if answer is None and question.has_labels:
            answer = _labelled(tidy(spoken), question.members)
        if answer is None:
            value, reasons = question.prose(tidy(spoken)), spoken
        else:
            value, reasons = question.answer_in(answer, only.comments if only else ())
        if value is not None:
            return ParsedAnswer(value, "answered", source, reasons)
    except UnusableError as error:
        note = str(error)
    if is_refusal(text):
        return ParsedAnswer(None, "refused", "a refusal")
    return ParsedAnswer(None, "unparsed", note)


def spoken_text(text: str) -> str:
    """Return the text after the reasoning, unwrapped if all of it is one JSON string."""
    spoken = clean_surrogates(text).strip()
    if spoken.startswith('"'):
        try:
            inner = json.loads(spoken, strict=False)
        except (ValueError, RecursionError):
            inner = None
        spoken = inner if isinstance(inner, str) else spoken
    spoken = after_reasoning(spoken)
    return spoken if '"' in spoken else re.sub("[\u201c\u201d]", '"', spoken)


def _only_object(spoken: str) -> JsonObject | None:
    """Return the object that a text consists of; `None` if it holds none."""
    objects, broken_off = scan(spoken)
    if broken_off is not None:
        raise UnusableError("the answer is cut off before its end")
    if not objects:
        return None
    if len(objects) > 1:
        raise UnusableError(f"it has {len(objects)} JSON objects")
    (only,) = objects
    if only.is_altered:
        raise UnusableError("the JSON object has faults")
    before, after = spoken[: only.start], spoken[only.start + only.width :]
    lead = fold(tidy(_OPENS.sub("", before)))
    end = fold(tidy(_CLOSES.sub("", after)))
    if not (_LEAD.fullmatch(lead) and _COURTESY.fullmatch(end)):
        raise UnusableError("other words stand around the JSON object")
    return only


_DEEPEST = 5
"""Levels of lists and objects in an answer: its object in up to four wrappers."""
_ELEMENTS = r"(?:answer|final_answer|action|choice|response|output|result|json)"
_OPENS = re.compile(
    rf"(?:<{_ELEMENTS}>\s*)?(?:(?:```|~~~)[ \t]*(?:json)?\s*)?[`*]*\Z", re.IGNORECASE
)
_CLOSES = re.compile(rf"\A[`*]*\.?\s*(?:```|~~~)?(?:\s*</{_ELEMENTS}>)?", re.IGNORECASE)
_LEAD = re.compile(
    r"(?:assistant:? ?|#{1,6} )?(?:(?:sure|ok|okay|certainly|of course|yes|so|therefore)(?:[,.!:]|$) ?)?"
    r"(?:(?:based on|given|considering|looking at|after (?:looking at|reviewing|analy[sz]ing)) (?:the|these|all the|your)"
    r" (?:(?:three|provided|given|driving) )*(?:frames|images|pictures|scene|information|instructions), ?)?"
    r"(?:here it is[.:]?"
    r"|i(?: would|'d| will|'ll)? (?:answer|choose|pick|select)(?: that)? ?:?"
    r"|(?:(?:here is|here's|this is) )?(?:(?:the|my|your) )?"
    r"(?:(?:final|best|safest|chosen|requested|recommended|correct|structured|json) )*"
    r"(?:answer|response|choice|selection|decision|action|aspect|description|output|result|json|verdict)(?: object)?"
    r"(?: (?:in|as) (?:(?:the|a|valid|requested|required|specified|json) )*(?:format|json|object))?"
    r"(?: is)? ?[:.]?)?"
)
"""Matches the phrases, in folded prose, that may lead to an object; nothing is one too."""
_COURTESY = re.compile(
    r"(?:(?:i )?hope (?:this|that|it) helps[.!]?"
    r"|(?:please )?let me know if you (?:need|have|want) (?:anything else|(?:any )?(?:more|further questions|questions))[.!]?)?"
)
"""Matches the phrases, in folded prose, that may follow an object."""


def _labelled(prose: str, requested: re.Pattern[str]) -> dict[str, Any] | None:
    """Return tidied prose as an object if its first line, but for a heading, has the label of a member.

    Lines without a label go on with the one before.
    """

    def is_known(label: str) -> bool:
        return any(names.fullmatch(spelt(label)) for names in (requested, REASON, CONFIDENCE))

    members: dict[str, str] = {}
    name = ""
    parted = _NEXT.sub(lambda mark: "\n" if is_known(mark[1]) else mark[0], prose)
    for line in parted.split("\n"):
        label = _LABEL.fullmatch(line)
        if label and is_known(label[1]):
            name = spelt(label[1])
            if name in members:
                raise UnusableError(TWO_ANSWERS)
            members[name] = label[2].strip()
        elif name:
            members[name] = f"{members[name]}\n{line}".strip()
        elif not _HEADING.fullmatch(fold(line)):
            return None
    if not any(requested.fullmatch(name) and not CONFIDENCE.fullmatch(name) for name in members):
        return None
    return {name: words.strip(" .") for name, words in members.items()}


_HEADING = re.compile(r"(?:#{1,6} )?(?:(?:the|my|your) )?(?:final )?(?:answer|response)[:.]?")
_NEXT = re.compile(r"[.,;] (?=(\w+) ?[:=] ?\w)")
"""Matches what stands before the label of another member in the same line."""
_LABEL = re.compile(r"(?:[-\u2022] |#{1,6} )?([\w ]{2,40}?) ?[:=] ?(.*)")

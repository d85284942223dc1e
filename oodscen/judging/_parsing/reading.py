"""Parses an answer from its JSON object or labelled lines, else from its prose, and detects refusals.

What counts is listed; what is not listed makes the answer unreadable. An answer may hold one object. Around it
stand reasoning that has ended, a code fence and a phrase such as "Here is my answer:". Beside the requested
members it has reasons and a confidence. Lines such as `Action: stop` are parsed like an object.
"""

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from oodscen._arguments import instance_of
from oodscen._prose import after_reasoning, fold, is_refusal, tidy
from oodscen._text import clean_surrogates
from oodscen.judging._parsing.unusable import LONGEST, TWO_ANSWERS, UnusableError
from oodscen.llm._json_objects import scan
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
    has_labels: bool = True
    """Labelled lines are parsed like an object."""

    def answer_in(self, value: Mapping[str, Any]) -> Value | None:
        """Return the answer in an object; `None` if it lacks the requested members.

        Raises:
            UnusableError: If it has a member that was not asked for, or reasons against its own answer.
        """
        held, reasons = unwrap(value, self.members)
        found = self.pick(held)
        if found is not None and self.denies and self.denies(tidy(reasons), found):
            raise UnusableError("its reasons are against the answer")
        return found


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
        said = spoken_json(text)
        if not said.strip():
            note = (UNSPOKEN if text.strip() else EMPTY).message
        found = _only_object(said)
        if found is not None:
            value = question.answer_in(found)
            if value is not None:
                return ParsedAnswer(value, "answered", "JSON")
        else:
            prose = tidy(said)
            lines = _labelled(prose, question.members) if question.has_labels else None
            value = question.answer_in(lines) if lines else question.prose(prose)
            if value is not None:
                return ParsedAnswer(value, "answered", "prose")
    except UnusableError as error:
        note = str(error)
    if is_refusal(text):
        return ParsedAnswer(None, "refused", "a refusal")
    return ParsedAnswer(None, "unparsed", note)


# ------------------------------------------------------------------ the object and the words around it


def spoken_json(text: str) -> str:
    """Return the text after the reasoning, unwrapped if all of it is one JSON string."""
    said = clean_surrogates(text).strip()
    if said.startswith('"'):
        try:
            inner = json.loads(said, strict=False)
        except (ValueError, RecursionError):
            inner = None
        said = inner if isinstance(inner, str) else said
    said = after_reasoning(said)
    return said if '"' in said else re.sub("[\u201c\u201d]", '"', said)


def _only_object(said: str) -> dict[str, Any] | None:
    """Return the object that a text consists of; `None` if it holds none."""
    found, broken_off = scan(said)
    if broken_off is not None:
        raise UnusableError("the answer is cut off before its end")
    if not found:
        return None
    if len(found) > 1:
        raise UnusableError(f"it has {len(found)} JSON objects")
    (one,) = found
    if one.is_altered or one.has_comments:
        raise UnusableError("the JSON object has faults")
    before, after = said[: one.start], said[one.start + one.width :]
    lead = fold(tidy(_OPENS.sub("", before)))
    end = fold(tidy(_CLOSES.sub("", after)))
    if not (_LEAD.fullmatch(lead) and _COURTESY.fullmatch(end)):
        raise UnusableError("other words stand around the JSON object")
    return one.value


_ELEMENTS = r"(?:answer|final_answer|action|choice|response|output|result|json)"
_OPENS = re.compile(
    rf"(?:<{_ELEMENTS}>\s*)?(?:(?:```|~~~)[ \t]*(?:json)?\s*)?[`*]*\Z", re.IGNORECASE
)
_CLOSES = re.compile(rf"\A[`*]*\.?\s*(?:```|~~~)?(?:\s*</{_ELEMENTS}>)?", re.IGNORECASE)
_LEAD = re.compile(
    r"(?:assistant:? ?|#{1,6} )?(?:(?:sure|ok|okay|certainly|of course|yes|so|therefore)(?:[,.!:]|$) ?)?(?:here it is[.:]?"
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


def _labelled(prose: str, asked: re.Pattern[str]) -> dict[str, Any] | None:
    """Return tidied prose as an object if its first line has the label of a member; other lines go on with theirs."""
    members: dict[str, str] = {}
    name = ""
    for line in _NEXT.sub("\n", prose).split("\n"):
        label = _LABEL.fullmatch(line)
        if label and any(one.fullmatch(spelt(label[1])) for one in (asked, _REASON, _CONFIDENCE)):
            name = spelt(label[1])
            if name in members:
                raise UnusableError(TWO_ANSWERS)
            members[name] = label[2].strip()
        elif name:
            members[name] = f"{members[name]}\n{line}".strip()
        else:
            return None
    if not any(asked.fullmatch(name) for name in members):
        return None
    return {name: said.strip(" .") for name, said in members.items()}


_NEXT = re.compile(r"[.,;] (?=\w+ ?[:=] ?\w)")
_LABEL = re.compile(r"(?:[-\u2022] |#{1,6} )?([\w ]{2,40}?) ?[:=] ?(.*)")

# ------------------------------------------------------------------ members


def unwrap(
    value: Mapping[str, Any], asked: re.Pattern[str], depth: int = 4
) -> tuple[dict[str, Any], str]:
    """Return the requested members of an object, or of the one that it wraps, and the reasons beside them.

    Raises:
        UnusableError: If it has other members, or one of them twice.
    """
    if getattr(value, "repeated", ()):
        raise UnusableError(TWO_ANSWERS)
    rest: dict[str, Any] = {}
    reasons: list[str] = []
    for name, one in value.items():
        if asked.fullmatch(spelt(name)) or _WRAPPERS.fullmatch(spelt(name)):
            rest[name] = one
        elif _is_reason(name, one):
            reasons += _texts(one)
        elif _REASON.fullmatch(spelt(name)):
            raise UnusableError(f"{name[:40]!r} is no text")
        elif not _is_confidence(name, one):
            raise UnusableError(f"nobody asked for {name[:40]!r}")
    inner = next(iter(rest.values())) if len(rest) == 1 else None
    if isinstance(inner, dict) and depth and all(_WRAPPERS.fullmatch(spelt(name)) for name in rest):
        held, within = unwrap(inner, asked, depth - 1)
        return held, "\n".join([*reasons, within])
    for name in rest:
        if not asked.fullmatch(spelt(name)):
            raise UnusableError(f"nobody asked for {name[:40]!r}")
    return rest, "\n".join(reasons)


_WRAPPERS = re.compile(
    r"(?=.)(?:final|json|data|arguments)?(?:answer|response|result|output|assessment)?"
)
_REASON = re.compile(
    r"(?:stepbystep|chainof)?(?:reason(?:s|ing)?|rationale|thoughts?|thinking|analysis|explanation"
    r"|justification|descriptions?|observations?|why)"
)
"""Matches the members that give reasons, in which other options may be weighed."""
_CONFIDENCE = re.compile(r"confidence|certainty|probability")
_SURE = re.compile(r"(?:\d+(?:\.\d+)? ?%?|(?:very )?(?:high|low)|medium|moderate)", re.IGNORECASE)


def _is_reason(name: str, value: Any) -> bool:
    return bool(_REASON.fullmatch(spelt(name))) and (value in (None, "", []) or bool(_texts(value)))


def _is_confidence(name: str, value: Any) -> bool:
    return bool(
        _CONFIDENCE.fullmatch(spelt(name))
        and (value is None or _SURE.fullmatch(str(value).strip()))
    )


def _texts(value: Any) -> list[str]:
    """Return a text, or the texts of a list of nothing else, as a list; else an empty one."""
    texts = value if isinstance(value, list) else [value]
    return list(texts) if all(isinstance(text, str) for text in texts) else []


def spelt(name: str) -> str:
    """Return the name of a member in a canonical spelling; one with other marks than spaces and hyphens is kept."""
    is_plain = re.fullmatch(r"\s*\w[\w\s-]*", name)
    return re.sub(r"[\s_-]+", "", name).casefold() if is_plain else name


def members(value: Mapping[str, Any], names: re.Pattern[str]) -> list[Any]:
    """Return the values of the members whose names match."""
    return [one for name, one in value.items() if names.fullmatch(spelt(name))]


def is_placeholder(value: object) -> bool:
    """Return whether a value is a placeholder from the question's example, such as `"..."`."""
    return isinstance(value, str) and bool(re.fullmatch(r"\s*(?:\.\.\.|\u2026|<[^<>]*>)\s*", value))


def words_in(value: object, depth: int = 3) -> str:
    """Return the words in a value, whatever its structure."""
    if isinstance(value, str):
        return value.strip()
    inner = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(inner, (list, tuple)) or not depth:
        return ""
    return "; ".join(filter(None, (words_in(one, depth - 1) for one in inner)))


def reasoning_in(text: str) -> str:
    """Return the reasons given with an answer: that member of its JSON, else the whole text."""
    if len(text) > LONGEST:
        return ""
    said = spoken_json(text)
    for one in reversed(scan(said)[0]):
        return "; ".join(
            words_in(one.value[name]) for name in one.value if spelt(name) == "reasoning"
        )
    return said

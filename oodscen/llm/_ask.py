"""Asking a language model one typed question for a typed answer."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeVar, cast

from pydantic import BaseModel, ValidationError

from oodscen._arguments import checked
from oodscen._json import is_object
from oodscen._numbers import whole_number
from oodscen._prose import without_thoughts
from oodscen._redaction import redact_keys
from oodscen._seeding import MAX_SEED
from oodscen._text import whole
from oodscen.data._base import issues_of
from oodscen.data._messages import Message
from oodscen.errors import AnswerError, Issue
from oodscen.llm._check import complete
from oodscen.llm._json_objects import Found, find_objects, is_cut_off
from oodscen.prompts._base import Prompt
from oodscen.protocols import LLM, Request

Answer = TypeVar("Answer", bound=BaseModel)

ATTEMPTS = 3
"""Maximum number of attempts, including the first, before an answer counts as invalid."""

SHOWN_ISSUES = 12
"""Maximum number of faults that are fed back at once."""

MAX_ANSWER = 200_000
"""Longest answer that is read, in characters."""

QUOTED = 8_000
"""Maximum length of an invalid answer that is quoted back to the model, in characters."""

_CUT_OFF = Issue("", "the answer is cut off before its end; answer more briefly")

Check = Callable[[Answer], Sequence[Issue]]
Read = Callable[[str], tuple[Answer | None, list[Issue]]]


@checked
def ask(
    llm: LLM,
    prompt: Prompt[Answer],
    sample: int = 0,
    *,
    check: Check[Answer] | None = None,
    attempts: int = ATTEMPTS,
    read: Read[Answer] | None = None,
) -> Answer:
    """Ask a question, parse and validate the answer, and feed faults back until it is valid.

    Args:
        llm: The model to ask.
        prompt: The typed question.
        sample: Index of the draw, for several independent draws.
        check: Further requirements, beyond those of the prompt itself.
        attempts: Maximum number of calls, at least 1.
        read: Parses the text instead of `read_answer` and the checks; it may raise `AnswerError` if asking
            again would be useless.

    Raises:
        AnswerError: When the last answer is still invalid; the error keeps the raw text and the faults.
        UsageError: When `sample` or `attempts` is not a whole number of this range.
        LLMError: When the model cannot be reached, or its implementation raises anything else.
    """
    whole_number("sample", sample, 0, MAX_SEED)
    whole_number("attempts", attempts, 1)
    checks: list[Check[Answer]] = [prompt.check, *([check] if check else [])]
    kind = cast(type[Answer], prompt.answer)
    question = messages = prompt.messages()
    schema = prompt.answer_schema()
    issues: list[Issue] = []
    raw = ""
    for attempt in range(1, attempts + 1):
        completion = complete(llm, Request(prompt, messages, schema, sample, attempt))
        raw = heard(completion.text)
        if completion.is_cut_off and not is_object(raw.encode()):
            answer, issues = None, [_CUT_OFF]
        else:
            answer, issues = read(raw) if read else read_answer(raw, kind, checks)
        if answer is not None:
            return answer
        messages = (*question, *repair(raw, issues))
    raise AnswerError(llm.name, prompt.purpose, issues, raw, attempts)


def heard(text: str) -> str:
    """Return a model's text as it is read: whole characters, and no credentials."""
    return redact_keys(whole(text))


def speaker(llm: LLM) -> str:
    """Return the name of the model that produced the words; for a replay, the recorded model."""
    return str(getattr(llm, "speaks_for", llm.name))


def read_answer(
    raw: str, kind: type[Answer], checks: Sequence[Check[Answer]] = ()
) -> tuple[Answer | None, list[Issue]]:
    """Find the answer in a model's text.

    Objects in reasoning that has ended (`<think> ... </think>`) are drafts. Among the others, one must be an answer,
    and none may be a different one, since nothing tells which of two is meant.

    Returns:
        The answer and no issues, or `None` and the faults of the object that came closest.
    """
    if len(raw) > MAX_ANSWER:
        return None, [Issue("", f"the answer has {len(raw):,} characters; {MAX_ANSWER:,} at most")]
    said = without_thoughts(raw)
    answers: list[Answer] = []
    values: list[Mapping[str, Any]] = []
    others: list[Mapping[str, Any]] = []
    faulty: list[Issue] = []
    misshapen: list[tuple[int, list[Issue]]] = []
    for candidates in find_objects(said):
        for found in candidates:
            try:
                answer = kind.model_validate(found.value)
            except ValidationError as error:
                misshapen.append((found.width, issues_of(error)))
                continue
            if not found.is_complete and not kind.model_fields.keys() <= found.value.keys():
                continue
            faulty += _faults(found, answer)
            if answer not in answers:
                answers.append(answer)
                values.append(found.value)
            break
        else:
            others.append(candidates[0].value)
    if faulty:
        return None, faulty
    if len(answers) > 1:
        return None, [Issue("", f"it holds {len(answers)} different answers; give one")]
    if answers and _contradicts(values[0], others, kind):
        return None, [Issue("", "a second object beside the answer says otherwise; give one")]
    if answers:
        issues = [issue for check in checks for issue in check(answers[0])]
        return (None, issues) if issues else (answers[0], [])
    if is_cut_off(said):
        return None, [_CUT_OFF]
    if misshapen:
        return None, max(misshapen, key=lambda item: item[0])[1]
    return None, [Issue("", "no JSON object was found in the answer")]


def _contradicts(
    value: Mapping[str, Any], others: Sequence[Mapping[str, Any]], kind: type[BaseModel]
) -> bool:
    """Return whether one of the other objects, such as a correction, gives a member of the answer another value."""
    return any(
        name in kind.model_fields and said != value.get(name)
        for other in others
        for name, said in other.items()
    )


def _faults(found: Found, answer: BaseModel) -> list[Issue]:
    """Return the reasons why an object of the right shape may say something else than what was read."""
    issues = [Issue(name[:80], "is given twice with different values") for name in found.repeated]
    if found.is_altered:
        issues.append(Issue("", "it is not valid JSON; quote every text, and write plain numbers"))
    return issues + [
        Issue(path, "must be a number, not true or false")
        for path in _truths_as_numbers(found.value, answer.model_dump())
    ]


def _truths_as_numbers(given: object, read: object, path: str = "") -> Iterator[str]:
    """Yield the places at which `true` or `false` was read as a number."""
    if isinstance(given, bool):
        if isinstance(read, int | float) and not isinstance(read, bool):
            yield path
    elif isinstance(given, dict) and isinstance(read, dict):
        for name in given.keys() & read.keys():
            yield from _truths_as_numbers(given[name], read[name], f"{path}.{name}".strip("."))
    elif isinstance(given, list) and isinstance(read, list | tuple):
        for index, (one, other) in enumerate(zip(given, read, strict=False)):
            yield from _truths_as_numbers(one, other, f"{path}[{index}]")


def repair(raw: str, issues: Sequence[Issue]) -> tuple[Message, Message]:
    """Return the turns that quote an answer and ask for a better one."""
    faults = "\n".join(f"- {issue}" for issue in issues[:SHOWN_ISSUES])
    rest = len(issues) - SHOWN_ISSUES
    more = f"\n- and {rest} more" if rest > 0 else ""
    said = raw if len(raw) <= QUOTED else f"{raw[:QUOTED]} ..."
    return (
        Message(role="assistant", text=said.strip() or "(nothing)"),
        Message(
            role="user",
            text=f"That answer cannot be used:\n{faults}{more}\n\nMend these faults and answer "
            "again with the complete JSON object and nothing else.",
        ),
    )

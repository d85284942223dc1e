"""Read what a model answered as a person would, also where it is not the JSON that was asked for.

Every reader takes a model's words and says what was answered, and how that was found out. It never
raises, and it never guesses: two different answers, or none, are `unparsed` and not wrong.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from difflib import SequenceMatcher
from typing import Any

from oodscen.judging.detection import Detected, read_aspect, read_description
from oodscen.judging.matching import telling_words
from oodscen.judging.reading import LONGEST, Reading, is_refusal, member, objects, tail, too_long
from oodscen.judging.wording import (
    CORRECTIONS,
    FINAL,
    Meant,
    Mention,
    find_actions,
    longest,
    meaning,
    normalise,
)
from oodscen.verdict import NOTHING

__all__ = [
    "Detected",
    "Reading",
    "contradiction",
    "is_refusal",
    "read_action",
    "read_aspect",
    "read_choice",
    "read_description",
]

Finder = Callable[[str], list[Mention]]


def read_action(text: str, offered: Sequence[str]) -> Reading[str]:
    """Read which of the offered actions was chosen.

    Args:
        text: A model's words.
        offered: Action ids in the order in which they were offered, so that "3" and "C" count.
    """
    return _read(text, offered, lambda part: find_actions(part, offered), _ACTION_KEYS)


def read_choice(text: str, labels: Mapping[str, str]) -> Reading[str]:
    """Read which option of the closed question was chosen.

    Args:
        text: A model's words.
        labels: Text of every option by id, in the order in which they were offered.
    """
    named = {name: normalise(label) for name, label in labels.items()}

    def find(part: str) -> list[Mention]:
        found = []
        for name, label in named.items():
            for words in dict.fromkeys((label, normalise(name))):
                pattern = rf"(?<!\w){re.escape(words)}(?!\w)" if words else r"(?!)"
                found += [Mention(m.start(), m.end(), name) for m in re.finditer(pattern, part)]
        return longest(found)

    reading = _read(text, list(labels), find, _CHOICE_KEYS)
    if reading.outcome != "unparsed" or "two answers" in reading.note:
        return reading
    if NOTHING in labels and (seen := read_aspect(text)).value and not seen.value.is_ood:
        return Reading(NOTHING, "answered", "prose: nothing is unusual")
    return _resembling(tail(text), named) or reading


def contradiction(reasoning: str, action: str, offered: Sequence[str]) -> str:
    """Say where a chain of thought settles on another action than the answer; empty where not."""
    if not reasoning.strip() or len(reasoning) > LONGEST:
        return ""
    plain = normalise(reasoning)
    meant = [meaning(plain, mention) for mention in find_actions(plain, offered)]
    rejected = {one.mention.option for one in meant if one.level == -2}
    settled = _settled(plain, meant, least=1)
    if settled and settled != action:
        return f"the reasoning settles on {settled}, the answer is {action}"
    affirmed = {one.mention.option for one in meant if one.level >= 0}
    if action in rejected and action not in affirmed:
        return f"the reasoning rejects {action}, which is the answer"
    return ""


# ------------------------------------------------------------------ one of several options

_ACTION_KEYS = (
    "action",
    "chosen_action",
    "selected_action",
    "final_action",
    "best_action",
    "action_id",
    "answer",
    "final_answer",
    "choice",
    "decision",
    "selection",
    "selected",
    "chosen",
    "option",
    "id",
    "response",
    "result",
    "output",
    "recommendation",
)
_CHOICE_KEYS = (
    "choice",
    "answer",
    "final_answer",
    "option",
    "number",
    "label",
    *_ACTION_KEYS[:6],
    *_ACTION_KEYS[9:],
)
_LETTER = re.compile(
    r"(?:(?:the\s+)?(?:final\s+)?(?:answer|option|choice|action|number|no\.?|i\s+(?:choose|pick|select)|go\s+with|my\s+(?:answer|choice)\s+is)\s*(?:is|:|=)?\s*)*[(\[{]?\s*(?:option\s+|number\s+|no\.?\s*|nr\.?\s*)?([a-z]|\d{1,3})\s*[)\]}.:!]*\s*"
)
_LABELLED = re.compile(
    r"(?:\b(?:answer|ans|option|choice|number|action|choose|pick|select|go\s+with|boxed|final)\b\s*(?:is|was|would\s+be|:|=|\{|\()*\s*(?:option|number|no\.?|action)?\s*[(\[{]?\s*|^\s*[(\[])(\d{1,3}|[b-z]|a(?=\s*(?:[)\].:!]|$)))(?=\s*(?:[)\]}.:,;!\n]|$|because|since|as\b))",
    re.MULTILINE,
)
_ORDINALS = (
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
    "ninth",
    "tenth",
)
_NUMERALS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_ORDINAL = re.compile(
    rf"\b({'|'.join(_ORDINALS)}|last)\s+(?:option|action|choice|one|answer)\b|\b(?:option|number|choice|action)\s+({'|'.join(_NUMERALS)})\b"
)


def _read(text: str, offered: Sequence[str], find: Finder, keys: Sequence[str]) -> Reading[str]:
    if len(text) > LONGEST:
        return too_long(text)
    for value in objects(text):
        found = _from_object(value, offered, find, keys)
        if found:
            return Reading(found, "answered", "JSON")
    said = tail(text)
    plain = _without_echo(normalise(said), find, len(offered))
    if not plain.strip():
        return Reading(
            None, "unparsed", "nothing but the question" if said.strip() else "no answer"
        )
    reading = _from_prose(plain, offered, find)
    if reading.outcome == "unparsed" and is_refusal(text):
        return Reading(None, "refused", "a refusal")
    return reading


def _from_object(
    value: Mapping[str, Any], offered: Sequence[str], find: Finder, keys: Sequence[str]
) -> str | None:
    for key in keys:
        found = member(value, (key,))
        if found is None:
            continue
        if isinstance(found, (list, tuple)) and len(found) == 1:
            found = found[0]
        if isinstance(found, dict):
            inner = _from_object(found, offered, find, (*keys, "name", "value"))
            if inner:
                return inner
        if isinstance(found, (str, int, float)) and not isinstance(found, bool):
            reading = _from_prose(normalise(str(found)), offered, find)
            if reading.value:
                return reading.value
    weights = {
        name: float(weight)
        for name in offered
        if isinstance(weight := member(value, (name,)), (int, float))
    }
    best = [name for name, weight in weights.items() if weight == max(weights.values())]
    return best[0] if len(weights) > 1 and len(best) == 1 else None


def _from_prose(plain: str, offered: Sequence[str], find: Finder) -> Reading[str]:
    mentions = find(plain)
    whole = plain.strip(" .,;:!?()[]{}'\n")
    letter = _LETTER.fullmatch(plain.strip())
    if letter and not mentions:
        chosen = _numbered(letter[1], offered)
        return _one(chosen, "a bare number or letter")
    if not mentions:
        labelled = {_numbered(m[1], offered) for m in _LABELLED.finditer(plain)}
        labelled |= {_counted(m, offered) for m in _ORDINAL.finditer(plain)}
        labelled.discard(None)
        if len(labelled) == 1:
            return _one(labelled.pop(), "prose: a number or letter")
        if labelled:
            return Reading(None, "unparsed", "two answers by number")
        return _one(_misspelt(whole, offered), "misspelt") if len(whole) <= 30 else _one(None, "")
    meant = [meaning(plain, mention) for mention in mentions]
    settled = _settled(plain, meant)
    if settled:
        return Reading(settled, "answered", f"prose: {_LEVELS[max(m.level for m in meant)]}")
    left = {one.mention.option for one in meant if one.level > -2}
    if not left:
        return Reading(None, "unparsed", "every action it names is rejected")
    return Reading(None, "unparsed", f"two answers: {', '.join(sorted(left))}")


_LEVELS = {3: "given", 2: "chosen", 1: "concluded", 0: "named", -1: "considered", -2: "rejected"}


def _settled(plain: str, meant: Sequence[Meant], least: int = -1) -> str | None:
    """Return the one option that the strongest words are about, after the last correction."""
    meant = [one for one in meant if one.level > -2]
    alone = [one for one in meant if _is_alone_on_its_line(plain, one.mention)]
    if len({one.mention.option for one in alone}) == 1 and not plain[alone[-1].mention.end :].strip(
        " .!)"
    ):
        return alone[-1].mention.option
    corrections = [m.end() for m in CORRECTIONS.finditer(plain)]
    for place in reversed(corrections):
        later = [one for one in meant if one.mention.start >= place]
        if later:
            meant = later
            break
    top = max((one.level for one in meant), default=-2)
    if top < least:
        return None
    strongest = [one for one in meant if one.level == top]
    options = {one.mention.option for one in strongest}
    if len(options) == 1:
        return options.pop()
    if top == 3:
        marks = [m.start() for m in FINAL.finditer(plain)]
        last = max((mark for mark in marks if mark < strongest[-1].mention.start), default=0)
        options = {one.mention.option for one in strongest if one.mention.start > last}
        return options.pop() if len(options) == 1 else None
    return None


def _is_alone_on_its_line(plain: str, mention: Mention) -> bool:
    """Whether a mention fills its line, as answers after the reasons do."""
    start = plain.rfind("\n", 0, mention.start) + 1
    end = plain.find("\n", mention.end)
    rest = plain[start : mention.start] + plain[mention.end : end if end >= 0 else len(plain)]
    return not re.search(r"[^\W\d]", rest)


def _one(chosen: str | None, note: str) -> Reading[str]:
    if chosen is None:
        return Reading(None, "unparsed", "no option is named")
    return Reading(chosen, "answered", note)


def _numbered(mark: str, offered: Sequence[str]) -> str | None:
    index = int(mark) - 1 if mark.isdigit() else ord(mark) - ord("a")
    return offered[index] if 0 <= index < len(offered) else None


def _counted(match: re.Match[str], offered: Sequence[str]) -> str | None:
    if match[1] == "last":
        return offered[-1]
    index = _ORDINALS.index(match[1]) if match[1] else _NUMERALS.index(match[2])
    return offered[index] if index < len(offered) else None


def _misspelt(whole: str, offered: Sequence[str]) -> str | None:
    scores = sorted(
        ((SequenceMatcher(None, whole, normalise(name)).ratio(), name) for name in offered),
        reverse=True,
    )
    is_clear = len(scores) < 2 or scores[0][0] - scores[1][0] > 0.1
    return scores[0][1] if scores and scores[0][0] >= 0.8 and is_clear else None


def _without_echo(plain: str, find: Finder, count: int) -> str:
    """Drop the list of options and the question, where a model repeats them before it answers."""
    lines = plain.split("\n")
    listed = [
        index
        for index, line in enumerate(lines)
        if re.match(r"\s*(?:[-\u2022\u2014+]|\(?(?:\d{1,2}|[a-z])[.):])?\s*", line)
        and _begins(line, find)
    ]
    options = {found.option for index in listed for found in find(lines[index])[:1]}
    is_list = len(options) >= min(4, count) or (len(options) == count and count > 1)
    if is_list:
        run = _longest_run(listed, lines)
        rest = [line for index, line in enumerate(lines) if index not in run]
        lines = [
            line
            for line in rest
            if not re.match(
                r"\s*(?:answer with json|choose the one|choose one|options?:|available actions)",
                line,
            )
        ]
    text = "\n".join(lines)
    text = re.sub(
        r"(?:choose|select|pick)\s+(?:the\s+)?one\s+(?:action|of)[^\n]*?(?::|\n|\.\s|$)", " ", text
    )
    return re.sub(
        r"(?:options?|actions?|choices|available actions?|possible actions?)(?:\s+(?:are|were|available))?\s*:\s*[^\n]*?(?=\n|[.;]\s|$)",
        lambda m: " " if len({f.option for f in find(m.group())}) >= 3 else m.group(),
        text,
    )


def _begins(line: str, find: Finder) -> bool:
    mark = re.match(r"\s*(?:[-\u2022\u2014+]|\(?(?:\d{1,2}|[a-z])[.):])?\s*", line)
    start = mark.end() if mark else 0
    return any(found.start <= start + 1 for found in find(line)[:1])


def _longest_run(listed: Sequence[int], lines: Sequence[str]) -> set[int]:
    """Return the longest stretch of neighbouring lines that list options; blank lines may part them."""
    runs: list[list[int]] = []
    for index in listed:
        if runs and not any(lines[i].strip() for i in range(runs[-1][-1] + 1, index)):
            runs[-1].append(index)
        else:
            runs.append([index])
    longest_run: list[int] = max(runs, key=len, default=[])
    return set(longest_run)


def _resembling(text: str, named: Mapping[str, str]) -> Reading[str] | None:
    """Return the option that shares most of its telling words with a short answer."""
    words = telling_words(text)
    scores = []
    for name, label in named.items():
        own = telling_words(label)
        if own and words:
            scores.append((len(own & words) / len(own | words), name))
    scores.sort(reverse=True)
    if scores and scores[0][0] >= 0.6 and (len(scores) < 2 or scores[1][0] < scores[0][0]):
        return Reading(scores[0][1], "answered", "prose: most words of the label")
    return None

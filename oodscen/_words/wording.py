"""Rules for short texts of models and files: labels of a tree, texts of scenarios, descriptions of made things.

Such a text is shown in pages, charts and terminals, and goes into later prompts. It must therefore be plain
words: no markup, no invisible characters, no look-alike letters, no instructions to a model. Such instructions
cannot be listed in full: patterns stop the common ones in English. Beyond them, prompts mark such texts as data,
answers are checked and pages escape what they show.
"""

import html
import re
import unicodedata
from functools import lru_cache

from oodscen._words.prose import declines_to_write, is_refusal
from oodscen._words.text import BLANK, one_line

_JOINERS = "\u200c\u200d"
"""Characters that shape a word between letters (Persian, Indic scripts)."""

_MARKUP = re.compile(
    r"<[a-z/!?]|javascript\s*:|```|~~~|\{\{|\}\}|\{%|%\}|\$\{|\{\w[^{}]*\}", re.IGNORECASE
)
"""HTML tags, code fences and the braces of templates; `< 10 cm` is not a tag."""

_DETERMINERS = r"(?:(?:all|any|every|everything|of|the|your|my|these|those|this|that|such)\s+)*"
_ORDERS = (
    r"(?:instructions?|prompts?|rules?|messages?|guidelines?|directions?|directives?|commands?"
    r"|context|texts?)"
)
_DROP = r"(?:ignore|disregard|forget|override|bypass|discard|neglect)"
_EARLIER = r"(?:previous|prior|preceding|earlier|above|foregoing|aforementioned)"
_ROLES = r"(?:system|assistant|developer|user|human)"
_BEGINS = r"(?:^|[.;:!?,(]\s*|\b(?:and|then|but|instead)\s+)(?:(?:please|just|now|only|always|simply)\s+)*"
"""Positions at which a clause can begin with an order."""
_ADDRESSED = re.compile(
    "|".join(
        (
            # "ignore all previous instructions", "disregard the rules above"
            rf"\b{_DROP}\s+{_DETERMINERS}{_EARLIER}\s+(?:\w+\s+)?{_ORDERS}\b",
            rf"\b{_DROP}\s+{_DETERMINERS}{_ORDERS}\s+(?:\w+\s+)?(?:above|before|so far|earlier|previously)\b",
            # an order: "Ignore the above and ...", "Disregard your instructions", "forget
            # everything"
            rf"{_BEGINS}{_DROP}\s+{_DETERMINERS}{_EARLIER}(?=\s*(?:$|[^\w\s-]|and\b|or\b|then\b))",
            rf"{_BEGINS}{_DROP}\s+{_DETERMINERS}(?:(?:instructions?|prompts?|guidelines?)\b|rules?\s*(?:$|[.;:!?,]))",
            r"\b(?:ignore|disregard|forget)\s+everything\b",
            r"\b(?:do not|don't|stop|never)\s+(?:follow|obey)(?:ing)?\s+(?:\w+\s+){0,3}"
            r"(?:instructions|prompts?|guidelines)\b",
            # a prescribed answer: "reply with yes", "and answer stop", "say 'covered'", "output {"
            rf"{_BEGINS}(?:answer|reply|respond|output|print|say|write|return)(?:\s*:\s*|\s+)"
            r"(?:(?:only|just|always|never|with|as|that|exactly|back)\s+)*[\"'“‘`]?(?:yes|no|true|false|none|null"
            r"|nothing|stop|safe|unsafe|covered|ood|off topic|ordinary|unusual|normal|ok|okay|json|add|broaden"
            r"|split|keep|remove|keep speed|slow down|emergency brake|change lane|pull over|pwned"
            r"|(?:the|a|one|this) (?:single )?(?:word|answer|text|number|action|label|id|following)s?)\b",
            rf"{_BEGINS}(?:answer|reply|respond|output|print|return)\s*:?\s*[{{\[]",
            rf"{_BEGINS}(?:choose|pick|select|prefer)\s+[\"'“‘`]?(?:yes|no|none|nothing|stop|safe|unsafe|ordinary|unusual|normal"
            r"|keep speed|slow down|emergency brake|change lane|pull over|option \w+)\b",
            r"[.,;:!]\s*(?:answer|reply|respond|say|output) so\b",
            rf"{_BEGINS}(?:answer|reply|respond)\s+(?:with|only|always|never|in|as|to (?:this|every|all|the question))\b",
            r"\b(?:in|as|to)\s+your\s+(?:\w+\s+)?(?:answer|response|reply|output)\b",
            r"\b(?:the|your) (?:correct|right|only|final|expected) (?:answer|response|output|decision)\b",
            r"\bthe (?:correct|expected) action is\b",
            r"\banswer\s*(?:[:=]|(?:is|was|must be|should be|would be|will be)\b)",
            # an option by its letter: "option B", "answer (C)", "choice: d"
            r"\b(?:option|answer|choice)(?:\s+is\b)?[\s:=]+[(\[\"'“‘]*(?-i:[B-Hb-h]|[Aa](?!\s+(?!because|since|and|or|is|as)[a-z]))(?![\w'’-])",
            r"\b(?:choose|pick|select|correct)[\s:]+[(\[\"'“‘]*(?-i:[A-Hb-h])\W*$",
            # a role for the reader: "you are now ...", "you must ...", "act as an assistant"
            r"\byou (?:are (?:now|no longer|(?:an? |the )?(?:ai|assistant|language model|chatbot|judge|grader))"
            r"|must|should|shall|have to|need to|will)\b",
            r"\b(?:act as|pretend (?:to be|that)|behave as)\s+(?:if\s+)?(?:an? |the )?"
            r"(?:ai|assistant|language model|chatbot|judge|grader|you)\b",
            r"\b(?:from now on|as an ai|language model|system prompt|jailbreak|prompt injection)\b",
            r"\b(?:new|updated|real|actual) (?:instructions?|task)\s*:",
            rf"{_BEGINS}(?:reveal|repeat|show|print|leak)\s+(?:\w+\s+){{0,2}}(?:instructions|prompt)\b",
            # a speaker: "System: ...", "Fog. Assistant: ...", "Fog SYSTEM: ..."
            rf"(?:^|[^\w\s-]\s*){_ROLES}\s*:",
            rf"\b(?-i:{_ROLES.upper()})\s*:",
            rf"\b{_ROLES}\s*:\s*(?:you|answer|respond|reply|output|return|say|always|never)\b",
            # markers of chat templates
            r"<\||\|>|\[/?INST\]|<<\s*/?SYS\s*>>|^\s*#+\s*(?:instruction|system|response)",
        )
    ),
    re.IGNORECASE,
)
"""Instructions to a model. Labels about driving such as "Driver ignores a red light" do not match."""

_LOOKALIKES = str.maketrans(
    "аеорсухіјѕԁԛԝһӏԍАВЕКМНОРСТУХІЈЅԚԜαιορνυΑΒΕΖΗΙΚΜΝΟΡΤΥΧ",
    "aeopcyxijsdqwhlgABEKMHOPCTYXIJSQWaiopvuABEZHIKMNOPTYX",
)
"""Cyrillic and Greek letters that look like Latin ones (Unicode's confusables, the plain pairs)."""
_ALPHABETS = frozenset({"LATIN", "CYRILLIC", "GREEK", "COPTIC", "ARMENIAN", "CHEROKEE"})
"""Scripts with look-alike letters; no language mixes them within a word."""
_WORD = re.compile(r"[^\W\d_]+")


@lru_cache(maxsize=16_384)
def wording_fault(text: str) -> str:
    """Return why a visible text of permitted length is not plain words, as a predicate; every edit of a tree asks."""
    if text.isascii() and text.isprintable():
        shown = text
    else:
        if any(unicodedata.category(char) in ("Cc", "Cs", "Zl", "Zp") for char in text):
            return "contains line breaks, control characters or halves of characters"
        if _has_unseen(text):
            return "contains characters that do not show or turn the direction of writing"
        shown = seen(text)
    if _MARKUP.search(shown) or ("&" in shown and html.unescape(shown) != shown):
        return "contains markup or code: plain words are wanted"
    if not text.isascii() and _is_disguised(shown):
        return "mixes alphabets so that words pass for others: use one alphabet per word"
    plain = one_line(shown.translate(_LOOKALIKES))
    if _ADDRESSED.search(plain) or _ADDRESSED.search(re.sub(r"[-_/*~]+", " ", plain)):
        return "speaks to a model: plain words are wanted"
    return ""


def is_left_out(text: str) -> bool:
    """Return whether a text names nothing: punctuation, a word for a missing value, or that nothing is unusual."""
    plain = one_line(seen(text)).casefold()
    named = plain.rstrip(" .,;:!?")
    return named in _PLACEHOLDERS or all(unicodedata.category(char)[0] in "PZ" for char in named)


_PLACEHOLDERS = frozenset(
    {
        # with which models leave a member out
        *("null", "none", "nil", "n/a", "undefined", "nothing", "no"),
        # which readers of tables take for a missing value
        *("na", "nan", "-nan", "#na", "#n/a", "#n/a n/a", "<na>"),
        *("1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan"),
        # which are the option beside the kinds of a closed question, or beside the things to recognise
        *("none of these", "none of the above"),
        *("nothing is out of the ordinary", "nothing out of the ordinary"),
        *("nothing is unusual", "nothing unusual"),
    }
)


def description_fault(text: str) -> str:
    """Return why a model's words are no text of a scenario, as a predicate, or an empty string."""
    if is_refusal(text) or declines_to_write(text):
        return "is a refusal: describe a situation in traffic"
    if _LISTED.match(seen(text)) or _is_enclosed(text.strip()[:1]):
        return "begins with the number or mark of a list: leave that out"
    return wording_fault(one_line(text))


_LISTED = re.compile(
    r"\s*(?:(?:\d{1,3}[.):]|[-*+\u2022]|\(?[A-Za-z][.):]|\(\d{1,3}\)|#\d{1,3}[.):]?)\s"
    r"|(?:text|scenario|description|example|variant|option)(?:\s*#?\d{1,3})?\s*:)",
    re.IGNORECASE,
)


def _is_enclosed(char: str) -> bool:
    """Return whether a character is one in a circle, a square or brackets, as options are marked."""
    return bool(_ENCLOSED.search(unicodedata.name(char, ""))) if char else False


_ENCLOSED = re.compile(r"\b(?:CIRCLED|SQUARED|PARENTHESIZED)\b")


def appearance_fault(text: str) -> str:
    """Return why words do not describe a made thing or movement, as a predicate, or an empty string.

    They stand among the options of questions. So beyond what no text may be, they have none of the characters with
    which Markdown, JSON, tags and formulas are written, no address, and no mark of an option.
    """
    if fault := wording_fault(text) or description_fault(text):
        return fault
    shown = seen(text)
    if match := _MARK.search(shown):
        return f"contains {match[0]!r}: plain words without markup are wanted"
    if enclosed := next(filter(_is_enclosed, text), ""):
        return f"contains {enclosed!r}: plain words without marks of options are wanted"
    if _ADDRESS.search(shown):
        return "contains an address: plain words are wanted"
    if _OPTION.search(shown) or is_left_out(text):
        return "reads like an option of a question: plain words are wanted"
    return ""


_MARK = re.compile(r"[*_`#\[\]{}<>|\\=$@^]|~~")
_ADDRESS = re.compile(
    r"://|\bwww\.|\b[a-z]{2,}:\w|[a-z0-9-]+\.[a-z]{2,}\b|\d(?:\.\d+){2}",
    re.IGNORECASE,
)
"""Schemes, names and numbers of hosts; a full stop is followed by a space, and `1.5 m` is one number."""
_OPTION = re.compile(r"(?<!\w)[A-Za-z]\)")


def _is_disguised(text: str) -> bool:
    """Return whether a word mixes alphabets, or is a look-alike of a Latin word among Latin words."""
    foreign, is_latin = [], False
    for word in _WORD.findall(text):
        names = [unicodedata.name(char, "") for char in word]
        scripts = {name.partition(" ")[0] for name in names} & _ALPHABETS
        is_small = any(name.startswith("LATIN LETTER SMALL CAPITAL") for name in names)
        if is_small or len(scripts) > 1:
            return True
        if scripts == {"LATIN"}:
            is_latin = True
        elif scripts:
            foreign.append(word.translate(_LOOKALIKES))
    return is_latin and bool(foreign) and all(map(str.isascii, foreign))


def _has_unseen(text: str) -> bool:
    """Return whether a text has characters that do not show by themselves.

    Joiners between letters may stand, and one variation selector after each character that shows.
    """
    return any(
        is_unseen(char) and not _shapes(before, char, after)
        for before, char, after in zip(f" {text}", text, f"{text[1:]} ", strict=False)
    )


def _shapes(before: str, char: str, after: str) -> bool:
    """Return whether a character that does not show shapes those around it."""
    if _is_selector(char):
        return not (before.isspace() or is_unseen(before))
    return char in _JOINERS and all(
        unicodedata.category(side)[0] in "LM" for side in before + after
    )


def seen(text: str) -> str:
    """Return the visible characters in their canonical form."""
    if text.isascii():
        return text
    return "".join(char for char in unicodedata.normalize("NFKC", text) if not is_unseen(char))


def is_unseen(char: str) -> bool:
    """Return whether a character shows nothing by itself: joiners, fillers, variation selectors."""
    is_filler = char in BLANK or char == "\u034f"
    return is_filler or unicodedata.category(char) == "Cf" or _is_selector(char)


def _is_selector(char: str) -> bool:
    """Return whether a character is a variation selector, which chooses the form of the one before it."""
    return "\ufe00" <= char <= "\ufe0f" or "\U000e0100" <= char <= "\U000e01ef"

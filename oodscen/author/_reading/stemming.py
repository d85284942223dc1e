"""Stemming: reduces English words so that their usual inflections coincide."""

import re

_STOP = frozenset(
    """a an the and or but of in on at to from into onto over under with without by for as is are was
    were be been being has have had it its this that these those which who whose there here then
    than so such no not nor only just while when where if up down out off about around between
    through along across some any each every all both one two more most very too also can could
    may might will would must do does did he she they them their his her i my we our you your
    ego egos s""".split()
)


def stem(word: str) -> str:
    """Reduce an English word so that its usual inflections coincide."""
    if len(word) > 4 and word.endswith("ies"):
        word = word[:-3] + "y"
    elif len(word) > 4 and word.endswith(("sses", "xes", "ches", "shes")):
        word = word[:-2]
    elif len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us", "is")):
        word = word[:-1]
    for ending in ("ing", "ed", "ly"):
        base = word.removesuffix(ending)
        if base != word and len(base) >= 3 and re.search("[aeiouy]", base):
            word = base
            if len(word) > 3 and word[-1] == word[-2] and word[-1] not in "ls":
                word = word[:-1]
            break
    return word.removesuffix("e") if len(word) > 3 else word


def stems(text: str) -> list[str]:
    """Return the stems of all content words, in order."""
    words = re.findall(r"[a-z]+", text.casefold().replace("'s", "").replace("\u2019s", ""))
    return [stem(word) for word in words if word not in _STOP]

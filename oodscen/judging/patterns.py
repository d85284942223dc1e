"""How the regular expressions of this package are written: as phrases, one idea a line.

They are looked for in text that `oodscen.judging.wording.normalise` returned. In a source a space
stands for any white space, so that a phrase reads as it is said, and is found also where a line
ends in it. Sources are composed as strings and compiled once, by `compiled`.
"""

import re


def either(*sources: str) -> str:
    """Return a source that finds one of several, whichever fits first."""
    return f"(?:{'|'.join(sources)})"


def few(most: int) -> str:
    """Return a source for no word, or so many at most, each with the space after it."""
    return rf"(?:\w+ ){{0,{most}}}?"


def compiled(*sources: str, flags: int = 0) -> re.Pattern[str]:
    """Compile a pattern that finds one of several sources, whichever fits first."""
    return re.compile(_SPACE.sub(_white, "|".join(sources)), flags)


_SPACE = re.compile(r"\\.|\[(?:\\.|[^\]\\])+\]|(?P<space> )(?P<is_optional>(?=[*?]))?")
"""A space outside a character class; what else has to be stepped over."""


def _white(match: re.Match[str]) -> str:
    if not match["space"]:
        return match.group()
    return r"\s" if match["is_optional"] is not None else r"\s+"

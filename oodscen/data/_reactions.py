"""Reaction times of those who drive in the ego's place."""

from collections.abc import Collection

REACTIONS_S = (0.2, 0.5, 0.8)
"""Reaction times of the drivers who try every action, s: from an assistance system's to that of a driver who expects
to brake (Green, "How long does it take to stop? Methodological analysis of driver perception-brake times", 2000)."""
NOMINAL_REACTION_S = REACTIONS_S[1]
"""Reaction time of the driver whose drive is shown, exported and replayed, s."""
LONGEST_REACTION_S = 5.0


def drivers_in_words(reactions_s: Collection[float], *, rehearses: bool) -> str:
    """Return who tried every action.

    Args:
        reactions_s: Their reaction times, s; at least one.
        rehearses: They also drove on a road with less grip and at other speeds.
    """
    words = "drivers who react sooner or later"
    if len(reactions_s) == 1:
        words = f"a driver who reacts after {next(iter(reactions_s)):g} s"
    elsewhere = "on a road with a little less grip and at a slightly different speed"
    also = "" if len(reactions_s) > 1 else "also "
    return f"{words}, {also}{elsewhere}" if rehearses else words

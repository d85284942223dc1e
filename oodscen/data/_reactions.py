"""Reaction times of those who drive in the ego's place."""

REACTIONS_S = (0.2, 0.5, 0.8)
"""Reaction times of the drivers who try every action, s: from an assistance system's to that of a driver who expects
to brake (Green, "How long does it take to stop? Methodological analysis of driver perception-brake times", 2000)."""
NOMINAL_REACTION_S = REACTIONS_S[1]
"""Reaction time of the driver whose drive is shown, exported and replayed, s."""
LONGEST_REACTION_S = 5.0

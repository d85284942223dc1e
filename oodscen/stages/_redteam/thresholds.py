"""The defaults of closed-loop red teaming.

The similarities are centred cosines of MiniLM (`oodscen.stages._redteam.novelty`). Measured on texts of the
built-in author, what they refuse is covered already in nine cases out of ten.
"""

NEAREST_TEXT = 0.62
"""Similarity to an earlier proposal from which on a new one repeats it."""
NEAREST_LABEL = 0.55
"""Similarity to a leaf's label from which on a proposal is of that kind."""
BROADENINGS = 2
"""So often a leaf is broadened before it is split."""
TOKENS = 4_000
"""Room for the tree in a prompt."""

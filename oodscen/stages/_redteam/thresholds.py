"""Defaults of closed-loop red teaming.

The similarities are centred cosines of MiniLM (`oodscen.stages._redteam.near_duplicates`). Measured on texts of the
built-in author, nine out of ten refused proposals are already covered.
"""

NEAREST_TEXT = 0.62
"""Minimum similarity to an earlier proposal at which a new one repeats it."""
NEAREST_LABEL = 0.55
"""Minimum similarity to a leaf's label at which a proposal is of that kind."""
BROADENINGS = 2
"""Number of broadenings of a leaf before it is split."""
TOKENS = 4_000
"""Room for the tree in a prompt, in tokens."""

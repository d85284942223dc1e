"""What closed-loop red teaming is made of.

`Round` is one line of its log, `Novelty` tells how near a proposal is to what exists, `Excerpt` and its
neighbours choose what of a tree is shown, `edits_of` turns a decision into edits, `Limits` says when to
stop, and `saturation` estimates how much is left to be found.
"""

from oodscen.redteaming.changes import edits_of
from oodscen.redteaming.excerpt import Excerpt, excerpt, listed, thin
from oodscen.redteaming.novelty import Nearness, Novelty
from oodscen.redteaming.rounds import Round, RunnerUp
from oodscen.redteaming.saturation import Saturation, SaturationPoint, saturation
from oodscen.redteaming.stopping import Limits, Stop

__all__ = [
    "Excerpt",
    "Limits",
    "Nearness",
    "Novelty",
    "Round",
    "RunnerUp",
    "Saturation",
    "SaturationPoint",
    "Stop",
    "edits_of",
    "excerpt",
    "listed",
    "saturation",
    "thin",
]

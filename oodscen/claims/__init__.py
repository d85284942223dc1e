"""What texts say about scenes, and whether scenes hold to it.

Claims are light and read by prompts; comparing them with scenes needs roads and arrays, so the rest
is loaded when it is asked for.
"""

from typing import TYPE_CHECKING

from oodscen._lazy import lazily
from oodscen.claims.claim import NUMBERS, VALUES, Claim, Mismatch

if TYPE_CHECKING:
    from oodscen.claims.checking import Finding, check_claims, judge_claims
    from oodscen.claims.faithful import Faithfulness, check_faithful, extract_claims
    from oodscen.claims.watching import watch
else:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "Finding": "checking",
            "check_claims": "checking",
            "judge_claims": "checking",
            "Faithfulness": "faithful",
            "check_faithful": "faithful",
            "extract_claims": "faithful",
            "watch": "watching",
        },
    )

__all__ = [
    "NUMBERS",
    "VALUES",
    "Claim",
    "Faithfulness",
    "Finding",
    "Mismatch",
    "check_claims",
    "check_faithful",
    "extract_claims",
    "judge_claims",
    "watch",
]

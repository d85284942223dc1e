"""Splits by path: no kind of situation is in two of them."""

import math
from collections.abc import Mapping
from typing import Literal, get_args

from oodscen._seeding import stream
from oodscen.judging._kinds import merge_kinds

Split = Literal["validation", "test"]
SPLITS: tuple[Split, ...] = get_args(Split)

VALIDATION = 0.2
"""Share of the kinds that go to the validation split, by default."""


def splits(labels: Mapping[str, str], *, share: float = VALIDATION, seed: int) -> dict[str, Split]:
    """Return the split of every leaf by their labels; leaves that frames cannot tell apart are in one split.

    The share of the validation split is rounded up, but at least one kind stays in the test split.
    """
    kinds = merge_kinds(labels)
    count = min(math.ceil(share * len(kinds)), max(len(kinds) - 1, 0))
    order = stream(seed, "publish-splits").permutation(len(kinds))
    drawn = {int(index) for index in order[:count]}
    return {
        leaf: "validation" if index in drawn else "test"
        for index, kind in enumerate(kinds)
        for leaf in kind.leaves
    }

"""Observed actors, by what differs from a car that stands in front of the ego."""

from typing import Any

import numpy as np

from oodscen.claims._observation import ObservedActor
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

ARRAYS = {
    "ahead_m": (30.0,),
    "aside_m": (0.0,),
    "half_width_m": (1.0,),
    "lane": (0.0,),
    "lane_share": (0.0,),
    "along_mps": (0.0,),
    "speed_mps": (0.0,),
    "forward_mps": (0.0,),
    "gap_m": (25.0,),
}
OTHER_LANES = ("left_lane", "right_lane", "oncoming_lane")


def observed(*, index: int = 0, asset: str = "car", **fields: Any) -> ObservedActor:
    """Return an actor of four steps, the first two of which are up to the decision."""
    changes = {name: fields.pop(name) for name in ("tags", "states") if name in fields}
    shown = FLAT_CATALOGUE.asset(asset).model_copy(update=changes)
    arrays = {}
    for name, default in ARRAYS.items():
        values = np.array(fields.pop(name, default), dtype=float)
        arrays[name] = np.concatenate([values, np.full(4 - len(values), values[-1])])
    shares = {name: np.full(4, fields.pop(f"share_of_{name}", 0.0)) for name in OTHER_LANES}
    return ObservedActor(
        index=index, id=f"it-{index}", asset=shown, state=fields.pop("state", ""), is_hazard=True,
        is_carried=fields.pop("is_carried", False), before=slice(0, 2), ego_speed_mps=10.0,
        first_oncoming=2, other_lane_shares=shares, **arrays, **fields,
    )  # fmt: skip

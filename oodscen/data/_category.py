"""The categories of assets."""

from typing import Literal

Category = Literal[
    "vehicle", "cyclist", "pedestrian", "animal", "object", "work_zone", "vegetation", "signal"
]

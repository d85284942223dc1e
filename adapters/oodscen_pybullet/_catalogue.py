"""Loads the adapter's catalogue without starting PyBullet."""

import json
from functools import lru_cache
from importlib.resources import files

from oodscen.data._catalogue import Catalogue
from oodscen.driving._motion.behaviours.table import BEHAVIOURS
from oodscen.driving.maps._shipped import SHIPPED_MAPS


@lru_cache(maxsize=1)
def load_catalogue() -> Catalogue:
    """Return the adapter's assets and weather with the shared behaviours and maps."""
    text = files("oodscen_pybullet").joinpath("catalogue.json").read_text(encoding="utf-8")
    shared = {
        "behaviours": [kind.model_dump(mode="json") for kind in BEHAVIOURS],
        "maps": [road.model_dump(mode="json") for road in SHIPPED_MAPS],
    }
    return Catalogue.parse({**json.loads(text), **shared}, source="oodscen_pybullet/catalogue.json")

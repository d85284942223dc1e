"""Loads the catalogue of CARLA 0.9.16 without CARLA."""

import json
from functools import lru_cache
from importlib.resources import files

from oodscen.data._catalogue import Catalogue
from oodscen.driving._motion.behaviours.table import BEHAVIOURS


@lru_cache(maxsize=1)
def load_catalogue() -> Catalogue:
    """Return CARLA's assets, towns and weather with the shared behaviours.

    The behaviours are those of `oodscen.driving`: an adapter that moves CARLA's actors by their
    poses supports all of them. The towns come without their OpenDRIVE files, so this catalogue can
    prune a tree but not stage scenes.
    """
    text = files("oodscen_carla").joinpath("catalogue.json").read_text(encoding="utf-8")
    behaviours = [kind.model_dump(mode="json") for kind in BEHAVIOURS]
    return Catalogue.parse(
        {**json.loads(text), "behaviours": behaviours}, source="oodscen_carla/catalogue.json"
    )

"""The catalogue of CARLA 0.9.16, read without CARLA."""

import json
from functools import lru_cache
from importlib.resources import files

from oodscen.data._catalogue import Catalogue
from oodscen.driving import BEHAVIOURS


@lru_cache(maxsize=1)
def load_catalogue() -> Catalogue:
    """Join CARLA's assets, towns and weather with the shared behaviours.

    The behaviours are those of `oodscen.driving`: an adapter that moves CARLA's actors by their
    poses has them all. The towns come without their OpenDRIVE files: a tree can be pruned with this
    catalogue, scenes cannot be staged on it.
    """
    text = files("oodscen_carla").joinpath("catalogue.json").read_text(encoding="utf-8")
    behaviours = [kind.model_dump(mode="json") for kind in BEHAVIOURS]
    return Catalogue.parse(
        {**json.loads(text), "behaviours": behaviours}, source="oodscen_carla/catalogue.json"
    )

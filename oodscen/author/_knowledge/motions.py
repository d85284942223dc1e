"""Designs of movements that the author's scenarios need and no catalogue has."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from oodscen.data._motion import ABILITIES, Motion
from oodscen.prompts._scenario.design_motion import DesignedMotion, DesignMotion


@cache
def load_motions() -> Mapping[str, Motion]:
    """Return the author's movements by id."""
    folder = files("oodscen.author._knowledge").joinpath("motions")
    found = {}
    for path in sorted(folder.iterdir(), key=lambda path: path.name):
        if path.name.endswith(".toml"):
            for name, table in tomllib.loads(path.read_text("utf-8")).items():
                found[name] = Motion.parse({"id": name, **table}, source=path.name)
    return found


def design_motion(prompt: DesignMotion) -> DesignedMotion:
    """Return the design of a movement, if the author knows it and the body fits."""
    motion = load_motions().get(prompt.name)
    if motion is None:
        told = f"the author has no movement of the name {prompt.name!r}"
        return DesignedMotion(motion=None, cannot_make=told)
    if prompt.categories and not set(ABILITIES[motion.body].categories) & set(prompt.categories):
        told = f"the author knows {prompt.name!r} for {ABILITIES[motion.body].words} only"
        return DesignedMotion(motion=None, cannot_make=told)
    return DesignedMotion(reasoning="A movement of the author's own.", motion=motion)

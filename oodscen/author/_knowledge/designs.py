"""Designs of things and movements that the author's scenarios need and no catalogue has."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import TypeVar

from oodscen.data._designs.motion import ABILITIES, Motion
from oodscen.data._designs.prop import Prop
from oodscen.prompts._scenario.design_motion import DesignedMotion, DesignMotion
from oodscen.prompts._scenario.design_prop import DesignedProp, DesignProp

Design = TypeVar("Design", Prop, Motion)


@cache
def load_designs() -> Mapping[str, Prop]:
    """Return the author's things by id."""
    return _loaded("designs", Prop)


@cache
def load_motions() -> Mapping[str, Motion]:
    """Return the author's movements by id."""
    return _loaded("motions", Motion)


def _loaded(folder: str, kind: type[Design]) -> dict[str, Design]:
    paths = files("oodscen.author._knowledge").joinpath(folder).iterdir()
    return {
        name: kind.parse({"id": name, **table}, source=path.name)
        for path in sorted(paths, key=lambda path: path.name)
        if path.name.endswith(".toml")
        for name, table in tomllib.loads(path.read_text("utf-8")).items()
    }


def design_prop(prompt: DesignProp) -> DesignedProp:
    """Return the design of a thing, if the author knows it."""
    prop = load_designs().get(prompt.name)
    if prop is None:
        return DesignedProp(prop=None, cannot_make=f"the author has no design of {prompt.name!r}")
    return DesignedProp(
        reasoning="A design of the author's own.",
        prop=prop.model_copy(update={"category": prompt.category}),
    )


def design_motion(prompt: DesignMotion) -> DesignedMotion:
    """Return the design of a movement, if the author knows it and the body fits."""
    motion = load_motions().get(prompt.name)
    if motion is None:
        why = f"the author has no movement of the name {prompt.name!r}"
        return DesignedMotion(motion=None, cannot_make=why)
    if prompt.categories and not set(ABILITIES[motion.body].categories) & set(prompt.categories):
        why = f"the author knows {prompt.name!r} for {ABILITIES[motion.body].words} only"
        return DesignedMotion(motion=None, cannot_make=why)
    return DesignedMotion(reasoning="A movement of the author's own.", motion=motion)

"""Designs of things that the author's scenarios need and no catalogue has."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from oodscen.data._prop import Prop
from oodscen.prompts._scenario.design_prop import DesignedProp, DesignProp


@cache
def load_designs() -> Mapping[str, Prop]:
    """Return the author's designs by id."""
    folder = files("oodscen.author._knowledge").joinpath("designs")
    found = {}
    for path in sorted(folder.iterdir(), key=lambda path: path.name):
        if path.name.endswith(".toml"):
            for name, table in tomllib.loads(path.read_text("utf-8")).items():
                found[name] = Prop.parse({"id": name, **table}, source=path.name)
    return found


def design(prompt: DesignProp) -> DesignedProp:
    """Return the design of a thing, if the author knows it."""
    prop = load_designs().get(prompt.name)
    if prop is None:
        return DesignedProp(prop=None, cannot_make=f"the author has no design of {prompt.name!r}")
    return DesignedProp(
        reasoning="A design of the author's own.",
        prop=prop.model_copy(update={"category": prompt.category}),
    )

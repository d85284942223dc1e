"""Things and motions that a study made to order, by the leaf that they were made for."""

from oodscen._pipeline.context import Context
from oodscen.data._motion import Motion
from oodscen.data._prop import Prop
from oodscen.stages._making.files import ASSETS
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import MOTIONS, made_motions

Made = tuple[tuple[Prop, ...], tuple[Motion, ...]]
"""Things and motions made to order."""


def made_for(run: Context) -> dict[tuple[str, ...], Made]:
    """Return the things and motions that were made for leaves, by the path of the leaf."""
    if not run.store.holds(ASSETS):
        return {}
    lines = [MadeProp.parse(line, source=ASSETS) for line in run.store.lines(ASSETS)]
    props = {one.id: one.prop for one in lines if one.prop is not None}
    motions = made_motions(run.store.lines(MOTIONS)) if run.store.holds(MOTIONS) else {}
    tree = run.study.tree("simulatable")
    paths = tree.paths
    return {
        paths[one.id]: (
            tuple(props[name] for name in one.made if name in props),
            tuple(motions[name] for name in one.made if name in motions),
        )
        for one in run.study.decisions
        if one.keep
        and one.made
        and one.id in paths
        and set(one.made) <= props.keys() | motions.keys()
    }


def described(made: Made) -> tuple[str, ...]:
    """Return things and motions in words, as a writer sees them."""
    return tuple(
        f"{one.id.replace('_', ' ')}: {one.description}" for group in made for one in group
    )

"""Things and motions that a study made to order, by the leaf that they were made for."""

from typing import NamedTuple

from oodscen._pipeline.context import Context
from oodscen._study_files import ASSETS, MOTIONS
from oodscen.data._motion import Motion
from oodscen.data._prop import Prop
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import made_motions


class MadeToOrder(NamedTuple):
    """Things and motions that were made for one leaf."""

    props: tuple[Prop, ...]
    motions: tuple[Motion, ...]

    def described(self) -> tuple[str, ...]:
        """Return all of them in words, as a writer sees them."""
        return tuple(
            f"{one.id.replace('_', ' ')}: {one.description}" for one in self.props + self.motions
        )


def made_for(run: Context) -> dict[tuple[str, ...], MadeToOrder]:
    """Return what was made for the leaves that were kept, by the path of the leaf."""
    if not run.store.holds(ASSETS):
        return {}
    lines = [MadeProp.parse(line, source=ASSETS) for line in run.store.lines(ASSETS)]
    props = {one.id: one.prop for one in lines if one.prop is not None}
    motions = made_motions(run.store.lines(MOTIONS)) if run.store.holds(MOTIONS) else {}
    paths = run.study.tree("simulatable").paths
    return {
        paths[leaf.id]: MadeToOrder(
            tuple(props[name] for name in leaf.made if name in props),
            tuple(motions[name] for name in leaf.made if name in motions),
        )
        for leaf in run.study.decisions
        if leaf.keep
        and leaf.made
        and leaf.id in paths
        and set(leaf.made) <= props.keys() | motions.keys()
    }

"""Things and motions that a study made to order, by the leaf that they were made for."""

from typing import TYPE_CHECKING, NamedTuple

from oodscen._io.study_files import ASSETS, MOTIONS
from oodscen.data._designs.motion import Motion
from oodscen.data._designs.prop import Prop
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import made_motions

if TYPE_CHECKING:
    from oodscen.study._study import Study


class MadeToOrder(NamedTuple):
    """Things and motions that were made for one leaf."""

    props: tuple[Prop, ...]
    motions: tuple[Motion, ...]

    def digests(self) -> tuple[str, ...]:
        """Return the digests of all of them."""
        return tuple(prop.digest() for prop in self.props + self.motions)

    def described(self) -> tuple[str, ...]:
        """Return all of them in words, as a writer sees them."""
        return tuple(
            f"{prop.id.replace('_', ' ')}: {prop.description}" for prop in self.props + self.motions
        )


NOTHING = MadeToOrder((), ())


def made_for(study: "Study") -> dict[tuple[str, ...], MadeToOrder]:
    """Return what was made for the leaves that were kept, by the path of the leaf."""
    store = study.store
    lines = [MadeProp.parse(line, source=ASSETS) for line in store.lines(ASSETS)]
    props = {made.id: made.prop for made in lines if made.prop is not None}
    motions = made_motions(store.lines(MOTIONS))
    if not props and not motions:
        return {}
    paths = study.tree("simulatable").paths
    return {
        paths[leaf.id]: MadeToOrder(
            tuple(props[name] for name in leaf.made if name in props),
            tuple(motions[name] for name in leaf.made if name in motions),
        )
        for leaf in study.decisions
        if leaf.keep
        and leaf.made
        and leaf.id in paths
        and set(leaf.made) <= props.keys() | motions.keys()
    }

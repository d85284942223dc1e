"""The things and movements made to order for a study, and the scenes that show them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from oodscen._io.study_files import picture_of
from oodscen.data._designs.motion import ABILITIES, Motion
from oodscen.data._designs.prop import Prop
from oodscen.data._designs.survey import Survey, all_parts, survey
from oodscen.data._scene import Scene
from oodscen.report import _phrasing as words
from oodscen.report._charts.frames import FramePicture, picture
from oodscen.report._load import Material
from oodscen.stages._making.looking import UNSEEN, PropLook
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import MadeMotion
from oodscen.study._study import Study

_MOST_LINKS = 6
_FRAMES = {
    "start": "straight on from its start",
    "lane": "along the road",
    "other": "with another actor",
    "ego": "with the ego",
}

Row = tuple[str, ...]
Design = TypeVar("Design", Prop, Motion)


@dataclass
class Uses:
    """The scenes that use something, with links to the first few."""

    scenes: list[str] = field(default_factory=list)

    @property
    def linked(self) -> list[str]:
        """Ids of the scenes to link to."""
        return self.scenes[:_MOST_LINKS]

    @property
    def more(self) -> int:
        """Number of scenes without a link."""
        return max(len(self.scenes) - _MOST_LINKS, 0)


@dataclass(frozen=True)
class ThingRow:
    """One thing as the page shows it."""

    prop: Prop
    picture: FramePicture
    facts: tuple[str, ...]
    """Size, mass, touch, support and number of parts."""
    texts: tuple[str, ...]
    measures: Mapping[str, Sequence[str]]
    """Its pixels and its contrasts from near to far; empty if it was not looked at."""
    recognised: str
    faults: tuple[str, ...]
    model: str
    uses: Uses


@dataclass(frozen=True)
class MotionRow:
    """One movement as the page shows it."""

    motion: Motion
    body: str
    frame: str
    model: str
    uses: Uses


def made_to_order(study: Study, material: Material) -> Mapping[str, Any] | None:
    """Return the things and movements made to order, and the details and states that scenes use."""
    things, motions = list(_things(study, material)), list(_motions(material))
    texts = {row.prop: row.texts for row in things}
    unmade: list[MadeProp | MadeMotion] = [*material.assets, *material.motions]
    rows = {
        "things": things,
        "motions": motions,
        "printed": _uses_by_row(material.scenes, partial(_printed, texts)),
        "details": _uses_by_row(material.scenes, _details),
        "states": _uses_by_row(material.scenes, _map_faults),
        "unmade": [
            (words.plain_words(design.id), design.error or design.reason)
            for design in unmade
            if design.error or design.reason
        ],
    }
    if not any(rows.values()):
        return None
    return {**rows, "unseen": sum(row.recognised == UNSEEN for row in things)}


def _things(study: Study, material: Material) -> Iterator[ThingRow]:
    """Yield what was made, then what scenes carry besides."""
    made = {asset.prop: asset for asset in material.assets if asset.prop is not None}
    for prop, uses in _used(made, material.scenes, lambda scene: scene.made):
        made_prop = made.get(prop)
        look = made_prop.look if made_prop else None
        drawn = survey(prop.parts)
        yield ThingRow(
            prop=prop,
            picture=_picture(study, material, prop, uses, is_made=made_prop is not None),
            facts=tuple(_facts(prop, drawn)),
            texts=tuple(dict.fromkeys(drawn.texts.values())),
            measures=_measures(look) if look else {},
            recognised=look.recognised if look else UNSEEN,
            faults=look.faults if look else (),
            model=made_prop.model if made_prop else "",
            uses=uses,
        )


def _picture(
    study: Study, material: Material, prop: Prop, uses: Uses, *, is_made: bool
) -> FramePicture:
    """Return the picture of a thing by itself, or of the first scene that shows it."""
    portrait = picture(study.folder, picture_of(prop.id)) if is_made else FramePicture()
    if portrait.href:
        return portrait
    frames = (
        episode.frames.get("last")
        for episode in material.episodes
        if episode.scene_id in uses.scenes[:1]
    )
    return picture(study.folder, next(frames, None))


def _facts(prop: Prop, drawn: Survey) -> Iterator[str]:
    # The size of a thing of the catalogue is known to its simulator alone.
    if not drawn.assets:
        size = prop.asset()
        yield f"{size.length:g} × {size.width:g} × {size.height:g} m"
    yield f"{prop.mass_kg:g} kg"
    yield prop.touch
    if prop.anchor != "road":
        yield prop.anchor
    yield f"{sum(1 for _ in all_parts(prop.parts))} parts"


def _measures(look: PropLook) -> dict[str, list[str]]:
    by_day = [view for view in look.views if not view.is_night]
    by_night = [view for view in look.views if view.is_night]
    return {
        "pixels": [f"{view.pixels:,}" for view in by_day],
        "contrast by day": [f"{view.contrast:.0f}" for view in by_day],
        "by night": [f"{view.contrast:.0f}" for view in by_night],
    }


def _motions(material: Material) -> Iterator[MotionRow]:
    models = {
        made_motion.motion: made_motion.model
        for made_motion in material.motions
        if made_motion.motion is not None
    }
    for motion, uses in _used(models, material.scenes, lambda scene: scene.motions):
        yield MotionRow(
            motion=motion,
            body=ABILITIES[motion.body].words,
            frame=_FRAMES[motion.frame],
            model=models.get(motion, ""),
            uses=uses,
        )


def _used(
    made: Iterable[Design],
    scenes: Iterable[Scene],
    carried: Callable[[Scene], Iterable[Design]],
) -> Iterator[tuple[Design, Uses]]:
    """Yield every design that was made or that scenes carry, once, with the scenes that carry it."""
    uses = {design: Uses() for design in made}
    for scene in scenes:
        for design in carried(scene):
            uses.setdefault(design, Uses()).scenes.append(scene.id)
    yield from uses.items()


def _uses_by_row(
    scenes: Iterable[Scene], rows: Callable[[Scene], Iterable[Row]]
) -> dict[Row, Uses]:
    """Return the scenes that use each row, in the order in which the rows come first."""
    uses: dict[Row, Uses] = {}
    for scene in scenes:
        for row in dict.fromkeys(rows(scene)):
            uses.setdefault(row, Uses()).scenes.append(scene.id)
    return uses


def _details(scene: Scene) -> Iterator[Row]:
    for actor in scene.actors:
        if actor.details:
            yield words.plain_words(actor.asset), ", ".join(words.details(actor.details))


def _printed(texts: Mapping[Prop, Iterable[str]], scene: Scene) -> Iterator[Row]:
    for actor in scene.actors:
        if actor.details and actor.details.text:
            yield actor.details.text, words.plain_words(actor.asset)
    for prop in scene.made:
        for text in texts[prop]:
            yield text, words.plain_words(prop.id)


def _map_faults(scene: Scene) -> Iterator[Row]:
    if scene.map_state is not None:
        yield words.plain_words(scene.map), ", ".join(words.map_faults(scene.map_state))

"""The making of what a simulator lacks, and the second judgement of the leaves that lacked it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, TypeVar

from oodscen._entry_points import is_asked
from oodscen._io.jpeg import to_jpeg
from oodscen._io.study_files import ASSETS, MOTIONS, picture_of
from oodscen._pipeline.context import Context
from oodscen.data._base import Data
from oodscen.data._catalogue import Catalogue
from oodscen.data._designs.motion import Motion
from oodscen.errors import DataError, Issue
from oodscen.stages._making.looking import ShownProp
from oodscen.stages._making.making import MadeProp, PropMaker
from oodscen.stages._making.motions import MotionMaker, made_motions
from oodscen.stages._making.recognition import PropRecogniser
from oodscen.stages._making.sheet import views_of
from oodscen.stages._making.wanted import judged_again, wanted_motions, wanted_things
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.pruner import Pruner
from oodscen.tree._scenario_tree import ScenarioTree

Wish = TypeVar("Wish")


def pruner(run: Context, catalogue: Catalogue) -> Pruner:
    """Return a pruner that accepts no substitutes: a scene must show what its text names."""
    return Pruner(
        run.llm,
        catalogue,
        substitutes=False,
        threads=run.threads,
        cancel=run.cancel,
        context=run.config.context,
    )


def makes(run: Context) -> bool:
    """Return whether what the simulator lacks is made."""
    if run.config.made is not None:
        return run.config.made
    return is_asked(run.config.llm) and run.simulator.catalogue().draws_props


def with_made(
    run: Context, tree: ScenarioTree, judgements: Sequence[PruneDecision]
) -> list[PruneDecision]:
    """Make what dropped leaves lack, and judge these leaves again.

    `assets.jsonl` and `motions.jsonl` keep what was made.
    """
    catalogue = run.simulator.catalogue()
    recogniser = None
    if run.config.recogniser is not None:
        recogniser = PropRecogniser(run.models.get(run.config.recogniser), catalogue)

    def keep_picture(shown: ShownProp) -> None:
        run.store.write(picture_of(shown.look.id), to_jpeg(views_of(shown)))

    maker = PropMaker(run.llm, run.simulator, keep_picture, recogniser=recogniser)
    wanted = {thing.name: thing for thing in wanted_things(tree, judgements, catalogue)}
    lines = _made_lines(run, ASSETS, judgements, wanted, maker.make)
    things = _drawn_anew(run, maker, [MadeProp.parse(line, source=ASSETS) for line in lines])
    props = {thing.id: thing.prop for thing in things if thing.prop is not None}
    motions = _made_motions(run, tree, judgements)
    _refuse_lost_designs(run, judgements, {*props, *motions})
    if not props and not motions:
        return list(judgements)
    judge = pruner(run, catalogue.with_made(props.values(), motions.values()))
    again = {
        decision.id: decision
        for decision in judged_again(judge, tree, judgements, {*props, *motions})
    }
    return [again.get(judgement.id, judgement) for judgement in judgements]


def _drawn_anew(run: Context, maker: PropMaker, things: list[MadeProp]) -> list[MadeProp]:
    """Draw the things again whose pictures are gone, or whose designs were changed by hand."""
    drawn = [thing if _is_drawn(run, thing) else maker.draw(thing) for thing in things]
    if drawn != things:
        run.store.write_lines(ASSETS, drawn)
    return drawn


def _is_drawn(run: Context, thing: MadeProp) -> bool:
    if thing.prop is None:
        return True
    return run.store.has(picture_of(thing.id)) and thing.drawn in ("", thing.prop.digest())


def _refuse_lost_designs(
    run: Context, judgements: Sequence[PruneDecision], designed: Collection[str]
) -> None:
    """Refuse a leaf that is kept with a thing or movement of which there is no design.

    Raises:
        DataError: If there is one.
    """
    for judgement in judgements:
        lost = [name for name in judgement.made if name not in designed]
        if judgement.keep and lost:
            fault = (
                f"{judgement.id} is shown with {', '.join(lost)}, of which there is no design; remove its line, and "
                "it is judged again"
            )
            source = str(run.store.path("pruned.jsonl"))
            raise DataError("decision", [Issue("", fault)], source=source)


def _made_motions(
    run: Context, tree: ScenarioTree, judgements: Sequence[PruneDecision]
) -> dict[str, Motion]:
    """Make the movements that dropped leaves lack."""
    catalogue = run.simulator.catalogue()
    wanted = {motion.name: motion for motion in wanted_motions(tree, judgements, catalogue)}
    if not wanted and not run.store.holds(MOTIONS):
        return {}
    maker = MotionMaker(run.llm, run.simulator)
    motions = made_motions(_made_lines(run, MOTIONS, judgements, wanted, maker.make))
    for name, motion in motions.items():
        if motion.id != name:
            issue = Issue("motion.id", f"must be {name}")
            raise DataError(Motion.noun, [issue], source=f"{MOTIONS}, {name}")
    return motions


def _made_lines(
    run: Context,
    file: str,
    judgements: Sequence[PruneDecision],
    wanted: Mapping[str, Wish],
    make: Callable[[Wish], Data],
) -> list[dict[str, Any]]:
    """Return the lines of what was made: what is wanted, and what decisions already use."""
    used = {name for judgement in judgements for name in judgement.made}
    # What decisions use keeps its line, also if no wish to make it is left.
    kept = {
        line["id"]: None
        for line in run.store.lines(file)
        if line["id"] in used and line["id"] not in wanted and not run.is_again(line)
    }
    return run.each(
        "make",
        file,
        {**wanted, **kept},
        lambda todo: (make(wish) for wish in todo.values() if wish is not None),
    )

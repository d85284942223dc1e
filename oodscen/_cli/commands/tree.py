"""Commands about trees: show, compare, merge, count, export, replay."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from oodscen._cli.groups import CommandGroup
from oodscen._cli.numbers import FiniteRange
from oodscen._cli.options import grouped_options, json_option, out_option, refuse_idle
from oodscen._cli.output import say, write
from oodscen._cli.paths import FileCommand, PathName
from oodscen._io.study_files import TREES
from oodscen._words.text import one_line
from oodscen.errors import DataError, Issue, UsageError
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit

if TYPE_CHECKING:
    from oodscen.interchange._tags import TagCoverage
    from oodscen.study._study import Study
    from oodscen.tree._coverage import Coverage

_PLACE = PathName(exists=True, path_type=Path)
_which_option = click.option(
    "--which",
    type=click.Choice(TREES),
    default="diverse",
    show_default=True,
    help="Tree to read if a study's folder is given.",
)


_encoder_options = grouped_options(
    click.option(
        "--encoder",
        help="Also match nodes by meaning with this text encoder, e.g. minilm; otherwise by id and label only.",
    ),
    click.option(
        "--threshold",
        type=FiniteRange(-1.0, 1.0),
        help="Minimum centred cosine of labels with the same meaning, for --encoder.",
    ),
)


@click.group(cls=CommandGroup)
def tree() -> None:
    """Inspect and combine scenario trees, from files or studies."""


@tree.command()
@click.argument("place", metavar="TREE", type=_PLACE)
@click.option(
    "--node",
    "node_id",
    help="Print the provenance of this node: who added it, why, and later edits.",
)
@click.option("--ids", is_flag=True, help="Show the ids of nodes.")
@_which_option
@json_option
def show(place: Path, node_id: str | None, ids: bool, which: str, as_json: bool) -> None:
    """Print a tree, or the provenance of one node."""
    if as_json or node_id is not None:
        refuse_idle("with --json" if as_json else "with --node", "ids")
    (scenario_tree,) = _read(which, place)
    if node_id is not None:
        history = scenario_tree.provenance(node_id)
        say(history.model_dump_json(indent=2) if as_json else str(history))
    else:
        say(scenario_tree.to_json() if as_json else scenario_tree.outline(ids=ids))


@tree.command()
@click.argument("one", type=_PLACE)
@click.argument("other", type=_PLACE)
@_encoder_options
@click.option("--mermaid", is_flag=True, help="Print a Mermaid chart of the changes.")
@click.option("--exit-code", is_flag=True, help="Exit with 1 if the trees differ.")
@_which_option
@json_option
def diff(
    one: Path,
    other: Path,
    encoder: str | None,
    threshold: float | None,
    mermaid: bool,
    exit_code: bool,
    which: str,
    as_json: bool,
) -> None:
    """Print the nodes that OTHER adds to, removes from, renames and moves in the tree ONE."""
    from oodscen.tree._comparison import diff as compare

    if as_json:
        refuse_idle("with --json", "mermaid")
    tree_diff = compare(*_read(which, one, other), **_matching(encoder, threshold))
    if as_json:
        say(tree_diff.model_dump_json(indent=2))
    else:
        say(tree_diff.to_mermaid() if mermaid else str(tree_diff))
    if exit_code and not tree_diff.is_empty:
        click.get_current_context().exit(1)


@tree.command(cls=FileCommand)
@click.argument("one", type=_PLACE)
@click.argument("other", type=_PLACE)
@_encoder_options
@click.option("--name", help="Name of OTHER in the log.  [default: merge-1, merge-2 ...]")
@_which_option
@out_option
def merge(
    one: Path,
    other: Path,
    encoder: str | None,
    threshold: float | None,
    name: str | None,
    which: str,
    out: Path | None,
) -> None:
    """Merge the nodes that only the tree OTHER has into the tree ONE."""
    from oodscen.tree._merge import merge as merge_trees

    merged = merge_trees(*_read(which, one, other), name=name, **_matching(encoder, threshold))
    write(out, merged.to_json())


@tree.command()
@click.argument("folder", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--which",
    type=click.Choice(TREES),
    default="simulatable",
    show_default=True,
    help="Tree to count.",
)
@click.option(
    "--exit-code", is_flag=True, help="Exit with 1 if a leaf, or a tag, has gaps, or there is none."
)
@click.option(
    "--odd",
    is_flag=True,
    help="Count the scenes per tag of the operational design domain (ISO 34503, ISO 34504) instead.",
)
@json_option
def coverage(folder: Path, which: str, exit_code: bool, odd: bool, as_json: bool) -> None:
    """Count the texts, scenes, episodes and outcomes per node of the study FOLDER, and list the gaps."""
    from oodscen.study._study import Study
    from oodscen.tree._coverage import study_coverage

    study = Study.open(folder)
    counts: Coverage | TagCoverage
    counts = _tag_coverage(study, which) if odd else study_coverage(study, which)
    say(counts.model_dump_json(indent=2) if as_json else str(counts))
    if exit_code and counts.has_gaps:
        click.get_current_context().exit(1)


def _tag_coverage(study: "Study", which: str) -> "TagCoverage":
    """Count the tags of the scenes whose texts belong to a tree of the study."""
    from oodscen import make_simulator
    from oodscen.interchange._tags import count_tags

    leaves = {node.id for node in study.tree(which).nodes}
    texts = {text.id for text in study.scenarios if text.leaf in leaves}
    scenes = [scene for scene in study.scenes if scene.scenario_id in texts]
    return count_tags(scenes, make_simulator(study.config.simulator).catalogue())


@tree.command(cls=FileCommand)
@click.argument("place", metavar="TREE", type=_PLACE)
@click.option(
    "--format",
    "form",
    type=click.Choice(("mermaid", "dot", "json", "nested", "html")),
    default="mermaid",
    show_default=True,
    help="Output format; json is the flat list with the edit log, nested the tree as nested objects.",
)
@_which_option
@out_option
def export(place: Path, form: str, which: str, out: Path | None) -> None:
    """Export a tree for another tool."""
    (scenario_tree,) = _read(which, place)
    writers = {
        "mermaid": ScenarioTree.to_mermaid,
        "dot": ScenarioTree.to_dot,
        "json": ScenarioTree.to_json,
        "nested": ScenarioTree.to_nested_json,
        "html": ScenarioTree.to_page,
    }
    write(out, writers[form](scenario_tree))


@tree.command(cls=FileCommand)
@click.argument("place", metavar="TREE", type=_PLACE)
@click.option("--edit", type=click.IntRange(min=0), help="Stop after this many edits.")
@click.option(
    "--round", "round_", type=click.IntRange(min=0), help="Stop after this red-team round."
)
@click.option("--stage", help="Stop after the last edit of this stage: grow, redteam, prune ...")
@click.option("--undo", type=int, multiple=True, help="Undo this edit afterwards; repeatable.")
@_which_option
@json_option
@out_option
def replay(
    place: Path,
    edit: int | None,
    round_: int | None,
    stage: str | None,
    undo: tuple[int, ...],
    which: str,
    as_json: bool,
    out: Path | None,
) -> None:
    """Print the edit log of a tree up to a given point, or with --out write the tree at that point."""
    from oodscen.tree._history import replay as replayed

    if out is not None:
        refuse_idle("with --out, which writes a tree", "as_json")
    (scenario_tree,) = _read(which, place)
    if (edit, round_, stage) != (None, None, None):
        earlier = scenario_tree.at(edit=edit, round=round_, stage=stage)
        if round_ is not None:
            _tell_late_round(round_, scenario_tree)
        scenario_tree = earlier
    for index in undo:
        scenario_tree = _undone(scenario_tree, index)
    if out is not None:
        write(out, scenario_tree.to_json())
        return
    for index, (step, after) in enumerate(replayed(scenario_tree)):
        if as_json:
            row = {"index": index, "nodes": len(after), **step.model_dump(exclude_defaults=True)}
            say(json.dumps(row, ensure_ascii=False))
        else:
            say(_edit_line(index, step, len(after)))


def _tell_late_round(number: int, scenario_tree: ScenarioTree) -> None:
    """Say that no edit is of a round or a later one: the round may have been played without an edit."""
    rounds = (edit.round for edit in scenario_tree.edits if edit.round is not None)
    last = max(rounds, default=0)
    if number > last:
        say(f"no edit is of round {number} or a later one: the last is of round {last}", err=True)


def _undone(scenario_tree: ScenarioTree, index: int) -> ScenarioTree:
    """Return the tree without an edit.

    Raises:
        UsageError: If no node would be left.
    """
    undone = scenario_tree.undo(index)
    if len(scenario_tree) and not len(undone):
        raise UsageError(
            f"edit {index} added the root: without it no node of the tree would be left, so it is not undone"
        )
    return undone


def _edit_line(index: int, edit: TreeEdit, node_count: int) -> str:
    """Return the line about an edit, with the number of nodes after it."""
    label = f": {edit.label}" if edit.label else ""
    parent = f" below {edit.parent}" if edit.parent else ""
    origin = [edit.stage] if edit.stage else []
    if edit.round is not None:
        origin.append(f"round {edit.round}")
    source = one_line(", ".join(origin))
    line = f"{index:6}  {node_count:6} nodes  {edit.op:8}{edit.node}{parent}{label}"
    return f"{line}  ({source})" if source else line


def _read(which: str, *places: Path) -> list[ScenarioTree]:
    """Read a tree from each file or study's folder.

    Raises:
        UsageError: If a tree of a study is chosen, and there is no study.
    """
    if not any(place.is_dir() for place in places):
        refuse_idle("on a file, which holds one tree", "which")
    return [_read_one(place, which) for place in places]


def _read_one(place: Path, which: str) -> ScenarioTree:
    if place.is_dir():
        from oodscen.study._study import Study

        study = Study.open(place)
        if not study.store.has(f"tree.{which}.json"):
            issue = Issue("", f"the study holds no {which} tree yet")
            raise DataError(ScenarioTree.noun, [issue], source=str(place))
        return study.tree(which)
    return ScenarioTree.load(place)


def _matching(encoder: str | None, threshold: float | None) -> dict[str, Any]:
    """Return the arguments by which nodes are matched by meaning."""
    from oodscen._registry import make_encoder
    from oodscen.tree._matching import THRESHOLD

    if encoder is None:
        refuse_idle("without --encoder", "threshold")
    return {
        "encoder": None if encoder is None else make_encoder(encoder),
        "threshold": THRESHOLD if threshold is None else threshold,
    }

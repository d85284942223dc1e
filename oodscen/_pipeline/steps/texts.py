"""The stages that write texts: for the simulatable tree, and the text sets of the diverse tree."""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from typing import Any

from oodscen._entry_points import is_builtin
from oodscen._parallel.threads import as_finished
from oodscen._pipeline.context import Context, failed
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError, Issue, LLMError, UsageError
from oodscen.metrics._detection.guard import is_calibrated
from oodscen.metrics._metrics import Metrics
from oodscen.stages._describe import Describer, text_id
from oodscen.stages._spread import spread, spread_subset
from oodscen.study._config import StudyConfig
from oodscen.study._made import made_for
from oodscen.study._store import Store
from oodscen.tree._scenario_tree import ScenarioTree

Line = dict[str, Any]

SHORT_PATHS = "short_paths.jsonl"
"""File with a line per path whose kind bears fewer texts than were asked for."""


def describe(run: Context, tree: ScenarioTree) -> list[Scenario]:
    """Write the texts along the paths of the simulatable tree."""
    paths = tree.paths
    if run.config.max_paths is not None:
        leaves = list(paths)
        count = min(run.config.max_paths, len(leaves))
        chosen = [leaves[index * len(leaves) // count] for index in range(count)]
        paths = {leaf: paths[leaf] for leaf in chosen}
    counts = dict.fromkeys(paths, run.config.per_path)
    return _describe(run, "describe", "scenarios.jsonl", paths, counts, sample=0, is_shown=True)


def refuse_added(store: Store, per_path: int) -> None:
    """Refuse texts that were added by hand, which the study would write over.

    Raises:
        DataError: If `scenarios.jsonl` has a text that is none of its path's own.
    """
    free: dict[str, set[str]] = {}
    for number, line in store.numbered("scenarios.jsonl"):
        leaf, name = line.get("leaf", ""), line["id"]
        if "error" in line:
            continue
        if leaf not in free:
            free[leaf] = {text_id(leaf, count) for count in range(1, per_path + 1)}
        if name not in free[leaf]:
            path = (
                f"the path {leaf!r} has {per_path} texts in this study"
                if leaf
                else "it has no leaf"
            )
            fault = (
                f"{name!r} is one too many: {path}; remove the line, and stage the text by itself with "
                "`oodscen augment`"
            )
            source = f"{store.path('scenarios.jsonl')}, line {number}"
            raise DataError(Scenario.noun, [Issue("", fault)], source=source)
        free[leaf].remove(name)


def describe_sets(run: Context, tree: ScenarioTree) -> dict[int, list[Scenario]]:
    """Write the text sets of the diverse tree; smaller sets are spread subsets of the largest."""
    if not run.config.sets or not tree.paths:
        return {}
    largest = max(run.config.sets)
    counts = spread(tree.paths, largest)
    paths = {leaf: path for leaf, path in tree.paths.items() if counts[leaf]}
    file = f"texts.diverse.{largest}.jsonl"
    texts = _describe(run, "describe sets", file, paths, counts, sample=1, is_shown=False)
    sets = {size: spread_subset(texts, size) for size in sorted(run.config.sets)}
    for size, chosen in sets.items():
        if size != largest:
            run.store.write_lines(f"texts.diverse.{size}.jsonl", chosen)
    return sets


def _describe(
    run: Context,
    stage: str,
    file: str,
    paths: Mapping[str, tuple[str, ...]],
    counts: Mapping[str, int],
    *,
    sample: int,
    is_shown: bool,
) -> list[Scenario]:
    """Write texts path by path; a path is done once all its lines are written.

    Texts that are to be shown are written with the simulator's catalogue in view.
    """
    describer = _describer(run, sample, is_shown=is_shown)
    done = _done(run, file, paths, counts)

    def work(leaf: str) -> list[Line]:
        try:
            scenarios = describer.path(leaf, paths[leaf], counts[leaf])
        except (LLMError, UsageError) as error:
            return [failed(leaf, error, leaf=leaf, path=paths[leaf])]
        return [scenario.model_dump(mode="json") for scenario in scenarios]

    todo = [leaf for leaf in paths if leaf not in done]
    if todo:
        run.store.write_lines(file, (row for rows in done.values() for row in rows))
        _list_short_paths(run.store, file, done, counts)
    run.progress(stage, len(done), len(paths))
    for leaf, rows in as_finished(work, todo, threads=run.threads, cancel=run.cancel):
        for line in _short_paths(file, {leaf: rows}, counts):
            run.store.append(SHORT_PATHS, line)
        for row in rows:
            run.store.append(file, row)
        done[leaf] = rows
        run.progress(stage, len(done), len(paths))
    ordered = _distinct(describer, [row for leaf in paths for row in done[leaf]])
    if run.options.retry and describer.options.twins:
        ordered = [_twinned(describer, row) for row in ordered]
    run.store.write_lines(file, ordered)
    _list_short_paths(run.store, file, {leaf: done[leaf] for leaf in paths}, counts)
    return [Scenario.parse(row) for row in ordered if "error" not in row]


def _done(
    run: Context, file: str, paths: Mapping[str, tuple[str, ...]], counts: Mapping[str, int]
) -> dict[str, list[Line]]:
    """Return the lines of a file by path, for the paths whose lines are all written."""
    lines: dict[str, list[Line]] = {}
    for line in run.store.lines(file):
        if not run.is_again(line):
            lines.setdefault(line.get("leaf", ""), []).append(line)
    accepted = {leaf: {count} for leaf, count in counts.items()}
    for line in run.store.lines(SHORT_PATHS):
        if line["file"] == file and line["leaf"] in paths:
            accepted[line["leaf"]].add(line["texts"])
    return {
        leaf: rows
        for leaf, rows in lines.items()
        if leaf in paths and _is_whole(rows, paths[leaf], accepted[leaf])
    }


def _list_short_paths(
    store: Store, file: str, done: Mapping[str, Sequence[Line]], counts: Mapping[str, int]
) -> None:
    """Write the lines about the short paths of a file, in the paths' order; those of other files stay."""
    before = list(store.lines(SHORT_PATHS))
    lines = [line for line in before if line["file"] != file] + _short_paths(file, done, counts)
    lines.sort(key=lambda line: line["file"])
    if lines != before:
        store.write_lines(SHORT_PATHS, lines)


def _short_paths(
    file: str, done: Mapping[str, Sequence[Line]], counts: Mapping[str, int]
) -> list[Line]:
    """Return a line for every path with fewer texts than were asked for, unless it failed."""
    return [
        {"file": file, "leaf": leaf, "texts": len(rows)}
        for leaf, rows in done.items()
        if len(rows) < counts[leaf] and "error" not in rows[0]
    ]


def _describer(run: Context, sample: int, *, is_shown: bool) -> Describer:
    config = run.config
    is_selective = config.candidates > 1
    metrics = None
    if is_selective or is_calibrated(run.encoder.name):
        metrics = Metrics(run.encoder, run.baseline, seed=config.seed)
    catalogue, made = None, {}
    if is_shown:
        catalogue = run.simulator.catalogue()
        made = {path: designs.described() for path, designs in made_for(run.study).items()}
    return Describer(
        run.llm,
        run.encoder,
        style=config.style,
        candidates=config.candidates,
        band=config.band if is_selective else None,
        metrics=metrics,
        twins=has_twins(config),
        sample=sample,
        catalogue=catalogue,
        made=made,
    )


def _distinct(describer: Describer, rows: list[Line]) -> list[Line]:
    """Reword texts that repeat a text of an earlier path."""
    scenarios = [Scenario.parse(row) for row in rows if "error" not in row]
    try:
        reworded = {
            scenario.id: scenario.model_dump(mode="json")
            for scenario in describer.reworded(scenarios)
        }
    except LLMError:
        return rows
    return [reworded.get(row["id"], row) for row in rows]


def _twinned(describer: Describer, row: Line) -> Line:
    """Return the line of a text with its ordinary twin, which may have failed before."""
    if not _lacks_twin(row):
        return row
    with suppress(LLMError):
        return describer.twinned(Scenario.parse(row)).model_dump(mode="json")
    return row


def _lacks_twin(row: Mapping[str, Any]) -> bool:
    return row.get("status") != "failed" and row.get("ordinary") is None


def has_twins(config: StudyConfig) -> bool:
    """Return whether the texts of a study get ordinary twins."""
    return is_builtin(config.llm) if config.twins is None else config.twins


def text_files(config: StudyConfig) -> list[str]:
    """Return the files of texts that a model writes; smaller sets are drawn from the largest."""
    largest = sorted(config.sets)[-1:]
    return ["scenarios.jsonl", *(f"texts.diverse.{size}.jsonl" for size in largest)]


def without_twin(store: Store, config: StudyConfig) -> list[str]:
    """Return the ids of texts that have no ordinary twin."""
    lines = (line for file in text_files(config) for line in store.lines(file))
    return [line["id"] for line in lines if _lacks_twin(line)]


def _is_whole(
    rows: Sequence[Mapping[str, Any]], path: tuple[str, ...], counts: Collection[int]
) -> bool:
    """Return whether the lines of a path are complete and about this path, or record its failure.

    Args:
        rows: The lines of the path.
        path: The labels of the path.
        counts: Accepted numbers of lines: as many as were asked for, or as the kind bears.
    """
    if any(tuple(row.get("path", ())) != path for row in rows):
        return False
    return len(rows) in counts or any(row.get("status") == "failed" for row in rows)

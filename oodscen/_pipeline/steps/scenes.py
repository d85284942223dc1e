"""The stages that make scenes and episodes: augment, simulate."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

from oodscen._concurrency import as_finished
from oodscen._pipeline.context import Context, failed
from oodscen._pipeline.sweep import Job, SweepResult, sweep
from oodscen.data._base import digest
from oodscen.data._claim import Claim
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._twins import scene_of, twin_id
from oodscen.errors import LLMError, StudyError
from oodscen.stages._augment import Augmenter

SCENES = "scenes.jsonl"
"""One line per scenario: the scene as it was run."""
STAGED = "staged.jsonl"
"""One line per scenario: the scene as it was staged (`scene`); once it ran, how it was re-staged (`how`, empty where
it was not), the scene that was run instead (`run`), and what was tried in vain and why (`tried`)."""
RESTAGED = "restaged.jsonl"
"""Of the scenes that told no actions apart: how each was re-staged, the scene that was run, and what was tried."""

Line = dict[str, Any]


def augment(run: Context, scenarios: Sequence[Scenario]) -> list[Scene]:
    """Read what every text says, and stage it so that the scene holds to that.

    Raises:
        StudyError: When `scenes.jsonl` holds a scene that belongs to no text, or two of one.
        DataError: When what it holds is no scene.
    """
    augmenter = Augmenter(run.llm, run.simulator.catalogue(), context=run.config.context)
    by_id = {scenario.id: scenario for scenario in scenarios}
    written = _written(run, by_id)
    told = _claims(run, augmenter, scenarios)

    def made_from(name: str) -> str:
        scenario, claims = by_id[name], told[name]
        said = () if isinstance(claims, LLMError) else claims
        return digest([scenario.text, scenario.path, [one.model_dump(mode="json") for one in said]])

    def work(scenario: Scenario) -> Line:
        claims = told[scenario.id]
        if isinstance(claims, LLMError):
            return failed(scenario.id, claims, scenario_id=scenario.id)
        try:
            scene = augmenter.run(scenario, claims)
        except LLMError as error:
            return failed(scenario.id, error, scenario_id=scenario.id)
        return {"id": scenario.id, "scene": scene.model_dump(mode="json")}

    # What was made of a text that is another now must go first: later it would look changed by hand.
    outdated = {line["id"] for line in run.store.lines(STAGED)}
    outdated -= run.fitting(STAGED, by_id, made_from).keys()
    if not outdated.isdisjoint(written):
        written = {name: line for name, line in written.items() if name not in outdated}
        run.store.write_lines(SCENES, written.values())
    rows = _asked(run, "augment", STAGED, scenarios, work, made_from)
    _write_scenes(run, rows, written)
    return [Scene.parse(row["scene"]) for row in rows if "scene" in row]


def _written(run: Context, texts: Collection[str]) -> dict[str, Line]:
    """Return the scenes in `scenes.jsonl` by id, where they may have been changed by hand."""
    path = run.store.path(SCENES)
    staged = {line["id"] for line in run.store.lines(STAGED)}
    found: dict[str, Line] = {}
    for number, line in enumerate(run.store.lines(SCENES), start=1):
        if line.get("status") == "failed":
            continue
        scene = Scene.parse(line, source=f"{path}, line {number}")
        if scene.id in found:
            raise StudyError(
                f"{path}, line {number}: there are two scenes {scene.id!r}; remove one"
            )
        if scene.id not in texts and scene.id not in staged:
            raise StudyError(
                f"{path}, line {number}: there is no text {scene.id!r} in this study; remove the line, and "
                "run the scene by itself with `oodscen simulate`"
            )
        found[scene.id] = scene.model_dump(mode="json")
    return found


def _write_scenes(run: Context, rows: Sequence[Line], written: Mapping[str, Line]) -> None:
    """Write `scenes.jsonl`: what is in it already, else the scene that was run, or the failure."""
    lines = []
    for row in rows:
        line = written.get(row["id"]) or _ran(row)
        lines.append(line or {key: row[key] for key in row if key != "made_from"})
    run.store.write_lines(SCENES, lines)


def _ran(row: Line) -> Line | None:
    """Return the scene that was run, or will be; `None` where there is none."""
    return row.get("run") or row.get("scene")


def _claims(
    run: Context, augmenter: Augmenter, scenarios: Sequence[Scenario]
) -> dict[str, tuple[Claim, ...] | LLMError]:
    """Return what every text says, by its id; where nobody could read it, the error.

    A scene that lacks its claims can be made at another time exactly when they can be read then.
    """
    texts = {scenario.id: scenario.text for scenario in scenarios}

    def work(scenario: Scenario) -> Line:
        try:
            claims = augmenter.read(scenario)
        except LLMError as error:
            return failed(scenario.id, error)
        return {"id": scenario.id, "claims": [claim.model_dump(mode="json") for claim in claims]}

    rows = _asked(run, "claims", "claims.jsonl", scenarios, work, lambda name: digest(texts[name]))
    return {
        row["id"]: LLMError(
            f"what the text says could not be read: {row['error']}",
            retryable=row.get("retryable", False),
        )
        if row.get("status") == "failed"
        else tuple(Claim.parse(claim) for claim in row["claims"])
        for row in rows
    }


def _asked(
    run: Context,
    stage: str,
    file: str,
    scenarios: Sequence[Scenario],
    work: Callable[[Scenario], Line],
    made_from: Callable[[str], str],
) -> list[Line]:
    """Ask a model about every scenario, as many at once as it may be asked; return the lines."""
    return run.each(
        stage,
        file,
        {scenario.id: scenario for scenario in scenarios},
        lambda todo: (
            row
            for _, row in as_finished(work, todo.values(), threads=run.threads, cancel=run.cancel)
        ),
        made_from=made_from,
    )


def simulate(run: Context) -> tuple[list[Scene], list[Episode]]:
    """Run every scene and its ordinary twin in worker processes; only this process writes.

    Scenes in which all or none of the actions are safe say nothing about a choice: they are
    re-staged where that helps. `restaged.jsonl` says which and how, and what was tried in vain;
    `scenes.jsonl` then holds what was run. A scene that was changed there by hand takes the place of what was
    staged, and is run.

    Returns:
        The scenes as they were run, and the episodes of scenes and twins.
    """
    rows = {line["id"]: line for line in run.store.lines(STAGED)}
    episodes = _simulated(run, rows)
    if changed := _changed(run, rows):
        rows |= changed
        run.store.write_lines(STAGED, rows.values())
        episodes = _simulated(run, rows)
    run.store.write_lines(STAGED, rows.values())
    told = [rows[name] for name in sorted(rows) if rows[name].get("how") or rows[name].get("tried")]
    run.store.write_lines(RESTAGED, map(_restaging, told))
    _write_scenes(run, list(rows.values()), {})
    return [Scene.parse(line) for line in map(_ran, rows.values()) if line], episodes


def _simulated(run: Context, rows: dict[str, Line]) -> list[Episode]:
    """Run the scenes that have no episodes, each with its twin; note in the rows what was run."""
    job = Job(run.config.simulator, run.config.seed, run.extras, twins=True, restages=True)
    given = {name: Scene.parse(row["scene"]) for name, row in rows.items() if "scene" in row}
    made_from = {name: Scene.parse(_ran(rows[name])).digest() for name in given}

    def work(todo: Mapping[str, str]) -> Iterator[Episode]:
        wanted = [given[name] for name in dict.fromkeys(todo.values())]
        for result in sweep(job, wanted, workers=run.workers, executor=run.executor):
            name = result.episode.id
            if name in given:
                rows[name] = _run_row(rows[name], result)
                made_from[name] = (result.restaged or given[name]).digest()
                run.store.append(STAGED, rows[name])
            result.save(run.store)
            yield result.episode

    found = run.each(
        "simulate",
        "episodes.jsonl",
        {item: name for name in given for item in (name, twin_id(name))},
        work,
        made_from=lambda item: made_from[scene_of(item)],
        is_whole=lambda line: "how" in rows[scene_of(line["id"])] and _has_files(run, line),
    )
    return [Episode.parse(row) for row in found]


def _run_row(row: Line, result: SweepResult) -> Line:
    """Return a line of `staged.jsonl` with what running the scene came to."""
    told: Line = {
        "how": result.episode.restaged,
        "tried": [attempt._asdict() for attempt in result.tried],
    }
    if result.restaged:
        told["run"] = result.restaged.model_dump(mode="json")
    return {**{key: row[key] for key in ("id", "made_from", "scene")}, **told}


def _restaging(row: Line) -> Line:
    line = {key: row[key] for key in ("id", "how", "tried")}
    return {**line, "scene": row["run"]} if "run" in row else line


def _changed(run: Context, rows: Mapping[str, Line]) -> dict[str, Line]:
    """Return the rows of scenes that were changed by hand: neither staged like that nor run."""
    return {
        name: {"id": name, "made_from": rows[name]["made_from"], "scene": line}
        for name, line in _written(run, rows).items()
        if line not in (rows[name].get("scene"), _ran(rows[name]))
    }


def simulate_whole(run: Context, scenes: Sequence[Scene]) -> list[Episode]:
    """Run every scene as the paper did: frames of the whole trace, collisions only, no twins.

    Args:
        run: The study.
        scenes: As they were run for the episodes.
    """
    job = Job(run.config.simulator, run.config.seed, protocol="paper")
    items = {scene.id: scene for scene in scenes}

    def work(todo: Mapping[str, Scene]) -> Iterator[Episode]:
        for result in sweep(job, list(todo.values()), workers=run.workers, executor=run.executor):
            result.save(run.store)
            yield result.episode

    rows = run.each(
        "simulate",
        "episodes.paper.jsonl",
        items,
        work,
        made_from=lambda name: items[name].digest(),
        is_whole=lambda line: _has_files(run, line),
    )
    return [Episode.parse(row) for row in rows]


def _has_files(run: Context, line: Mapping[str, Any]) -> bool:
    return all(run.has(file) for file in (*line["frames"].values(), *line["files"]))

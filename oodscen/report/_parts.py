"""Data of the parts of the page that have templates of their own, in `templates/parts`."""

from collections.abc import Mapping
from typing import Any

from oodscen._words.decimals import fine_percent
from oodscen.data._sighting import TO_NAME
from oodscen.report._charts.rounds import saturation_chart
from oodscen.report._charts.scores import intervals
from oodscen.report._load import Material
from oodscen.stages._prune.restoration import restoration, restoration_rows
from oodscen.stages._redteam.saturation import saturation
from oodscen.statistics._intervals import Interval
from oodscen.study._study import Study
from oodscen.tree._coverage import LACKS, coverage

_MOST_ADDITIONS = 15
_MOST_SCENES = 200

Variables = Mapping[str, Any]


def shortcuts(study: Study, material: Material) -> Variables | None:
    """Return the audit of shortcuts with its picture; without an audit, nothing."""
    if material.audit is None:
        return None
    rows = [
        (row.name, value, *_bounds(row.balanced_accuracy.interval, value))
        for row in material.audit.rows
        if (value := row.balanced_accuracy.value) is not None and row.needs != "outcomes"
    ]
    return {
        "audit": material.audit,
        "is_current": material.audit.best_calls(material.episodes) is not None,
        "chart": intervals(rows),
    }


def _bounds(interval: Interval | None, value: float) -> tuple[float, float]:
    """Return the ends of an interval; the value twice if there is none."""
    return (interval.low, interval.high) if interval else (value, value)


def driving(study: Study, material: Material) -> Variables | None:
    """Return the results of `oodscen drive`, one row per driver for scenes and one for twins."""
    if not material.drives:
        return None
    board = material.drive_board
    return {
        "rows": board.rows,
        "remarks": board.remarks(),
        "pairs": [(row.driver, row.paired) for row in board.rows if row.paired and row.paired.n],
    }


def undecided(study: Study, material: Material) -> Variables | None:
    """Return the scenes in which every action, or none, is safe, with what was tried."""
    episodes = [
        episode
        for episode in material.episodes
        if episode.status == "ok"
        and not episode.is_ordinary
        and episode.actions
        and not episode.is_decidable
    ]
    if not episodes:
        return None
    lines_by_id = {str(line.get("id")): line for line in material.restagings}
    return {
        "count": len(episodes),
        "restaged": sum(
            bool(episode.restaged) and not episode.restaged.startswith(TO_NAME)
            for episode in material.episodes
        ),
        "rows": [
            {
                "id": episode.scene_id,
                "all_safe": bool(episode.safe_set),
                "tried": _tried(lines_by_id.get(episode.scene_id, {})),
            }
            for episode in episodes[:_MOST_SCENES]
        ],
    }


def _tried(line: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """Return the attempted fixes by the reason why they failed, the most frequent reason first."""
    by_why: dict[str, list[str]] = {}
    fixes = line.get("tried")
    for fix in fixes if isinstance(fixes, list) else ():
        if isinstance(fix, Mapping):
            by_why.setdefault(str(fix.get("why", "")), []).append(str(fix.get("how", "")))
    return sorted(by_why.items(), key=lambda item: -len(item[1]))


def saturated(study: Study, material: Material) -> Variables | None:
    """Return the new kinds found by the rounds of red teaming, and an estimate of those left."""
    estimates = saturation(material.rounds)
    chart = saturation_chart(estimates)
    if chart is None:
        return None
    return {"chart": chart, "estimates": estimates, "is_closed": study.config.closed_loop}


def restored(study: Study, material: Material) -> Variables | None:
    """Return the additions to the catalogue that restore pruned paths on their own, the most first."""
    ranking = restoration(material.decisions)
    labels = {
        decision.id: decision.path[-1] if decision.path else decision.id
        for decision in material.decisions
    }
    rows = restoration_rows(ranking, labels, limit=_MOST_ADDITIONS)
    dropped = {decision.id for decision in material.decisions if not decision.keep}
    paths = material.metrics.paths if material.metrics is not None else None
    exposure = paths.of(dropped) if paths is not None else None
    return {"ranking": ranking, "rows": rows, "exposure": exposure} if rows else None


def covered(study: Study, material: Material) -> Variables | None:
    """Return counts per class and family of the simulatable tree, and the holes by leaf."""
    tree = material.trees.get("simulatable")
    if tree is None or not material.scenarios:
        return None
    paths = material.metrics.paths if material.metrics is not None else None
    report = coverage(
        tree,
        texts=material.scenarios,
        scenes=material.scenes,
        episodes=material.episodes,
        per_km=paths.per_km() if paths is not None else None,
    )
    holes = [
        (words, [row.label for row in report.holes if row.lacks == lack])
        for lack, words in LACKS.items()
    ]
    return {
        "rows": [row for row in report.rows if row.kind != "leaf"],
        "holes": [(words, labels) for words, labels in holes if labels],
        "exposed_holes": None
        if report.exposed_holes is None
        else fine_percent(report.exposed_holes),
    }

"""The stage that measures the texts."""

from collections.abc import Mapping, Sequence
from typing import Any

from oodscen import _paper as paper
from oodscen._pipeline.context import Context
from oodscen.baselines import load_baseline
from oodscen.data._base import canonical_json, digest
from oodscen.data._scenario import Scenario
from oodscen.metrics import Metrics
from oodscen.metrics._pictured import picture_data


def measure(
    run: Context, scenarios: list[Scenario], sets: Mapping[int, list[Scenario]]
) -> list[Scenario]:
    """Compute the metrics and return the scenarios inside the OOD-ness band."""
    groups = {**{str(size): chosen for size, chosen in sets.items()}, "simulatable": scenarios}
    made_from = digest(
        {name: [[one.leaf, one.text] for one in chosen] for name, chosen in groups.items()}
    )
    if not run.has("metrics.json") or run.study.metrics.get("made_from") != made_from:
        run.progress("metrics", 0, 1)
        content = {**_metrics(run, groups), "made_from": made_from}
        run.store.write("metrics.json", canonical_json(content) + "\n")
    run.progress("metrics", 1, 1)
    if run.config.band is None or not scenarios:
        return scenarios
    low, high = run.config.band
    values = run.study.metrics["sets"]["simulatable"]["oodness"]["per_text"]
    return [s for s, value in zip(scenarios, values, strict=True) if low <= value <= high]


def _metrics(run: Context, groups: Mapping[str, Sequence[Scenario]]) -> dict[str, Any]:
    baseline = load_baseline(run.config.baseline) if run.config.baseline else None
    metrics = Metrics(run.encoder, baseline, seed=run.config.seed)
    size = min(paper.BATCH, max(1, len(metrics.baseline) // 2))
    return {
        "encoder": metrics.encoder.name,
        "baseline": {
            "name": metrics.baseline.name,
            "N": len(metrics.baseline),
            "digest": metrics.baseline.digest(),
        },
        "sets": {
            name: metrics.report(
                [scenario.text for scenario in chosen],
                groups=[scenario.leaf for scenario in chosen],
            ).model_dump(mode="json")
            for name, chosen in groups.items()
            if chosen
        },
        "baseline_batch": metrics.baseline_batch(size).model_dump(mode="json"),
        "baseline_diversity": metrics.baseline_diversity().model_dump(mode="json"),
        "pictures": picture_data(
            metrics, {name: chosen for name, chosen in groups.items() if chosen}
        ),
    }

"""The stage that measures the texts."""

from collections.abc import Mapping, Sequence

from oodscen._pipeline.context import Context
from oodscen.data._base import digest
from oodscen.data._scenario import Scenario
from oodscen.errors import LLMError
from oodscen.llm._ask import speaker
from oodscen.metrics._measurements import Measurements, measurements
from oodscen.metrics._metrics import Metrics
from oodscen.metrics._rarity.estimates import TextRarity, gather_rarity
from oodscen.study._study import Study


def measure(
    run: Context, scenarios: list[Scenario], sets: Mapping[int, list[Scenario]]
) -> list[Scenario]:
    """Compute the metrics and return the scenarios inside the OOD-ness band."""
    groups = {**{str(size): texts for size, texts in sets.items()}, "simulatable": scenarios}
    leaves = {leaf.id: leaf.label for leaf in run.study.tree("diverse").leaves}
    texts = {
        name: [[scenario.leaf, scenario.text] for scenario in chosen]
        for name, chosen in groups.items()
    }
    inputs: list[object] = [texts, leaves, run.config.rarity_llm]
    if run.baseline is not None:
        inputs.append(run.baseline.digest())
    made_from = digest(inputs)
    is_made = run.store.holds("metrics.json") and run.study.metrics.get("made_from") == made_from
    if not is_made or (run.options.retry and unanswered(run.study)):
        run.progress("metrics", 0, 1)
        measured = _measured(run, groups, leaves).model_copy(update={"made_from": made_from})
        run.store.write("metrics.json", measured.to_json() + "\n")
    run.progress("metrics", 1, 1)
    if run.config.band is None or not scenarios:
        return scenarios
    low, high = run.config.band
    values = run.study.metrics["sets"]["simulatable"]["oodness"]["per_text"]
    return [
        scenario
        for scenario, oodness in zip(scenarios, values, strict=True)
        if low <= oodness <= high
    ]


def unanswered(study: Study) -> int:
    """Return the number of texts whose rarity a model was asked for without an answer that could be read."""
    rarity = study.metrics.get("asked") or {}
    return sum("not answered" in text["flags"] for text in rarity.get("per_text", ()))


def _measured(
    run: Context, groups: Mapping[str, Sequence[Scenario]], leaves: Mapping[str, str]
) -> Measurements:
    metrics = Metrics(run.encoder, run.baseline, seed=run.config.seed)
    measured = measurements(metrics, groups, leaves)
    if run.rarity_llm is None or not groups["simulatable"]:
        return measured
    texts = groups["simulatable"]
    try:
        rarity = metrics.rarity(texts, run.rarity_llm)
    except LLMError:
        unknown = [TextRarity(flags=("not answered",))] * len(texts)
        rarity = gather_rarity(unknown, speaker(run.rarity_llm), None, (), None, seed=0)
    return measured.model_copy(update={"asked": rarity})

"""Removing judged models from a study."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from oodscen._pipeline.steps.aspects import judged, unjudged
from oodscen._pipeline.steps.judge import outcomes
from oodscen._registry import make_llm
from oodscen.data._base import canonical_json
from oodscen.data._verdict import Verdict, is_without_pictures, without_pictures
from oodscen.errors import OodscenError, UnknownComponent
from oodscen.judging._people import as_name, is_person, person
from oodscen.judging._references import ALWAYS
from oodscen.report._render import write_report
from oodscen.study._board import board_of
from oodscen.study._config import StudyConfig
from oodscen.study._stale_verdicts import OPINIONS, refuse_stale_verdicts
from oodscen.study._study import Study


def drop_models(study: Study, names: Sequence[str]) -> dict[str, int]:
    """Remove judged models: their verdicts, and their place in the configuration and the leaderboard.

    A model takes its answers without pictures with it. No model is asked. Answers stay in `answers.jsonl`, so
    judging a dropped model again asks only what it has not answered; calls stay in `calls.jsonl`, since they were
    paid for. The reference answerers of every study keep their verdicts.

    Args:
        study: The study on disk.
        names: Names as in `vlms`, or as in verdicts.

    Returns:
        The number of removed verdicts by name; for a model that can no longer be made, of those that no other model
        accounts for.

    Raises:
        UnknownComponent: When a name was never judged, with close matches.
        UsageError: When a verdict of another model does not belong to its drive as it is now.
        InUse: When another process writes the study.
    """
    with study.store.writing():
        return _drop(study, names)


class Remaining(NamedTuple):
    """The judging of a study without some of its models."""

    config: StudyConfig
    verdicts: list[Verdict]
    dropped: dict[str, int]
    """The number of removed verdicts by the name that was given."""


def without_models(study: Study, names: Sequence[str]) -> Remaining:
    """Return what remains of a study's judging without these models; the study stays as it is.

    Raises:
        UnknownComponent: When a name was never judged, with close matches.
    """
    config, verdicts = study.config, study.stored_verdicts
    if not names:
        return Remaining(config, verdicts, {})
    answerers = _answerers(config)
    # A person's name may be typed in another form of the same characters.
    names = [as_name(name) if is_person(name) else name for name in names]
    _refuse_unknown(names, answerers, verdicts)
    dropped = _dropped_entries(names, answerers)
    models = _dropped_models(names, dropped, answerers, verdicts)
    remaining = [verdict for verdict in verdicts if verdict.model not in models]
    counts = Counter(verdict.model for verdict in verdicts if verdict.model in models)
    people = tuple(name for name in config.people if person(name) not in models)
    config = _remaining(config, dropped).model_copy(update={"people": people})
    unclaimed = models - {*answerers.values()}
    return Remaining(
        config,
        remaining,
        {name: _count(name, answerers.get(name, name), counts, unclaimed) for name in names},
    )


def _drop(study: Study, names: Sequence[str]) -> dict[str, int]:
    config, remaining, counts = without_models(study, names)
    refuse_stale_verdicts(study, remaining)
    info = _recounted(study, config, remaining)
    study.check()
    board = board_of(study, remaining)
    study.store.write("study.json", canonical_json(info) + "\n")
    study.store.write_lines("verdicts.jsonl", remaining)
    study.store.write("leaderboard.json", canonical_json(board.model_dump(mode="json")) + "\n")
    write_report(study)
    return counts


def _answerers(config: StudyConfig) -> dict[str, str | None]:
    """Return the name in verdicts of every judged answerer, by its name in the configuration.

    It is `None` for a model that can no longer be made.
    """
    answerers = {name: _name_in_verdicts(name, config) for name in config.vlms}
    for name in config.withheld:
        if name in config.vlms:
            model = answerers[name]
            answerers[without_pictures(name)] = without_pictures(model) if model else None
    answerers |= {person(name): person(name) for name in config.people}
    return answerers


def _refuse_unknown(
    names: Iterable[str], answerers: Mapping[str, str | None], verdicts: Iterable[Verdict]
) -> None:
    """Refuse names under which nothing was judged.

    Raises:
        UnknownComponent: If there is one.
    """
    judged_names = {verdict.model for verdict in verdicts} - {*ALWAYS}
    known = {*answerers, *filter(None, answerers.values()), *judged_names}
    for name in names:
        if name not in known:
            raise UnknownComponent("judged model", name, known)


def _dropped_entries(names: Collection[str], answerers: Mapping[str, str | None]) -> set[str]:
    """Return the names in the configuration that are dropped, with the answers without pictures of each."""
    dropped = {entry for entry, model in answerers.items() if entry in names or model in names}
    return dropped | {without_pictures(entry) for entry in dropped} & answerers.keys()


def _dropped_models(
    names: Collection[str],
    dropped: Collection[str],
    answerers: Mapping[str, str | None],
    verdicts: Iterable[Verdict],
) -> set[str]:
    """Return the names in verdicts that are dropped.

    A model that can no longer be made may have judged under another name. Where all remaining models can be made,
    every verdict is dropped that none of them accounts for.
    """
    models = {answerers.get(name) or name for name in (*names, *dropped)}
    remaining = [model for entry, model in answerers.items() if entry not in dropped]
    if all(remaining):
        models |= {verdict.model for verdict in verdicts} - {*remaining}
    return models - {*ALWAYS}


def _count(
    name: str, model: str | None, counts: Mapping[str, int], unclaimed: Iterable[str]
) -> int:
    """Return how many verdicts are removed under a name: those of its model, or of unclaimed ones if it has none."""
    if model is not None:
        return counts.get(model, 0)
    form = is_without_pictures(name)
    return sum(counts.get(other, 0) for other in unclaimed if is_without_pictures(other) is form)


def _remaining(config: StudyConfig, dropped: Collection[str]) -> StudyConfig:
    """Return a configuration without the dropped models and the servers that only they use."""
    writers = config.model_copy(update={"vlms": ()}).models
    changes = {
        "vlms": tuple(name for name in config.vlms if name not in dropped),
        "withheld": tuple(
            name
            for name in config.withheld
            if name not in dropped and without_pictures(name) not in dropped
        ),
        "asked": {name: judging for name, judging in config.asked.items() if name not in dropped},
        "servers": {
            name: address
            for name, address in config.servers.items()
            if name not in dropped or name in writers
        },
    }
    return config.model_copy(update=changes)


def _recounted(study: Study, config: StudyConfig, verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """Return the content of `study.json` for the remaining verdicts."""
    info = {**study.info, "config": config.model_dump(mode="json")}
    if "counts" in info:
        info["counts"] = {
            **info["counts"],
            "verdicts": len(verdicts),
            "outcomes": outcomes(verdicts),
            **judged(verdicts, study.store.lines(OPINIONS)),
        }
    if "failures" in info:
        failed = sum(verdict.status == "failed" for verdict in verdicts)
        info["failures"] = {**info["failures"], "verdicts": failed}
        if "opinions" in info["failures"]:
            info["failures"]["opinions"] = unjudged(verdicts)
        if info.get("status") == "incomplete" and not any(info["failures"].values()):
            info["status"] = "success"
    return info


def _name_in_verdicts(name: str, config: StudyConfig) -> str | None:
    """Return a model's name in verdicts, or `None` if the model can no longer be made."""
    try:
        return make_llm(name, api_base=config.servers.get(name, config.api_base)).name
    except OodscenError:
        return None

"""Removing judged models from a study."""

from collections.abc import Collection, Sequence
from typing import Any

from oodscen._pipeline.steps.aspects import judged
from oodscen._pipeline.steps.judge import outcomes
from oodscen._registry import make_llm
from oodscen.data._base import canonical_json
from oodscen.data._verdict import Verdict, without_pictures
from oodscen.errors import OodscenError, UnknownComponent
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.judging._people import as_name, is_person, person
from oodscen.judging._references import ALWAYS
from oodscen.report._render import write_report
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
        The number of removed verdicts by name.

    Raises:
        UnknownComponent: When a name was never judged, with close matches.
        UsageError: When a verdict of another model does not belong to its drive as it is now.
        InUse: When another process writes the study.
    """
    with study.store.writing():
        return _drop(study, names)


def _drop(study: Study, names: Sequence[str]) -> dict[str, int]:
    config, verdicts = study.config, study.stored_verdicts
    names_by_entry = {name: _name_in_verdicts(name, config) for name in config.vlms}
    names_by_entry |= {
        without_pictures(name): called and without_pictures(called)
        for name, called in tuple(names_by_entry.items())
        if name in config.withheld
    }
    # A person's name may be typed in another form of the same characters.
    names = [as_name(name) if is_person(name) else name for name in names]
    names_by_entry |= {person(name): person(name) for name in config.people}
    called = {name: other or name for name, other in names_by_entry.items()}
    known = {*called, *called.values(), *({verdict.model for verdict in verdicts} - {*ALWAYS})}
    for name in names:
        if name not in known:
            raise UnknownComponent("judged model", name, known)
    dropped = {name for name in called if name in names or called[name] in names}
    dropped |= {blind for name in dropped if (blind := without_pictures(name)) in called}
    models = {called.get(name, name) for name in (*names, *dropped)}
    if all(names_by_entry[name] for name in called if name not in dropped):
        # A model that can no longer be made may have judged under another name, so drop every
        # verdict that no remaining model accounts for.
        judging = {called[name] for name in called if name not in dropped}
        models |= {verdict.model for verdict in verdicts} - judging
    models -= {*ALWAYS}
    kept = [verdict for verdict in verdicts if verdict.model not in models]
    refuse_stale_verdicts(study, kept)
    counts = {
        name: sum(
            verdict.model in models and verdict.model == called.get(name, name)
            for verdict in verdicts
        )
        for name in names
    }
    people = tuple(name for name in config.people if person(name) not in models)
    config = _remaining(config, dropped).model_copy(update={"people": people})
    info = _recounted(study, config, kept)
    study.check()
    board = leaderboard(kept, study.episodes, study.scenarios, seed=config.seed)
    study.store.write("study.json", canonical_json(info) + "\n")
    study.store.write_lines("verdicts.jsonl", kept)
    study.store.write("leaderboard.json", canonical_json(board.model_dump(mode="json")) + "\n")
    write_report(study)
    return counts


def _remaining(config: StudyConfig, dropped: Collection[str]) -> StudyConfig:
    """Return a configuration without the dropped models and the servers that only they use."""
    asked = config.model_copy(update={"vlms": ()}).models
    withheld = (name for name in config.withheld if not {name, without_pictures(name)} & {*dropped})
    changes = {
        "vlms": tuple(name for name in config.vlms if name not in dropped),
        "withheld": tuple(withheld),
        "asked": {name: found for name, found in config.asked.items() if name not in dropped},
        "servers": {
            name: address
            for name, address in config.servers.items()
            if name not in dropped or name in asked
        },
    }
    return config.model_copy(update=changes)


def _recounted(study: Study, config: StudyConfig, kept: Sequence[Verdict]) -> dict[str, Any]:
    """Return the content of `study.json` for the remaining verdicts."""
    info = {**study.info, "config": config.model_dump(mode="json")}
    if "counts" in info:
        info["counts"] = {
            **info["counts"],
            "verdicts": len(kept),
            "outcomes": outcomes(kept),
            **judged(kept, study.store.lines(OPINIONS)),
        }
    if "failures" in info:
        failed = sum(verdict.status == "failed" for verdict in kept)
        info["failures"] = {**info["failures"], "verdicts": failed}
        if info.get("status") == "incomplete" and not any(info["failures"].values()):
            info["status"] = "success"
    return info


def _name_in_verdicts(name: str, config: StudyConfig) -> str | None:
    """Return a model's name in verdicts, or `None` if the model can no longer be made."""
    try:
        return make_llm(name, api_base=config.servers.get(name, config.api_base)).name
    except OodscenError:
        return None

"""The settings of judging that all models of a study share, which are kept as soon as one has answered."""

from collections.abc import Iterable

from oodscen.data._verdict import Verdict
from oodscen.errors import UsageError
from oodscen.judging._people import is_person
from oodscen.judging._references import is_reference
from oodscen.study._config import SHARED, StudyConfig


def refuse_changed_settings(
    before: StudyConfig, after: StudyConfig, verdicts: Iterable[Verdict]
) -> None:
    """Refuse settings under which models that were judged would have to be asked again.

    More ordinary drives only add questions. What costs no call is judged again: references, people, and models that
    have not answered.

    Args:
        before: The study's configuration.
        after: The configuration to run.
        verdicts: The study's verdicts; read only if a setting changes.

    Raises:
        UsageError: If a model that stays in the study has answered under another setting.
    """
    had = [_option(before, name) for name in _changed(before, after)]
    stay = [name for name in before.vlms if name in after.vlms and not is_reference(name)]
    if not had or not stay or not any(map(_is_settled, verdicts)):
        return
    wanted = [_option(after, name) for name in _changed(before, after)]
    raise UsageError(
        f"the models of this study were judged with {' '.join(had)}, and all models of a study are asked alike: leave "
        f"out {' '.join(wanted)}, or judge in a copy of the study without them (oodscen evaluate COPY --drop MODEL)"
    )


def _changed(before: StudyConfig, after: StudyConfig) -> list[str]:
    """Return the names of settings that differ; more ordinary drives do not count."""
    return [
        name
        for name in SHARED
        if getattr(after, name) != getattr(before, name)
        and not (name == "ordinary" and after.ordinary > before.ordinary)
    ]


def _option(config: StudyConfig, name: str) -> str:
    """Return a setting as the option of the command line that chooses it."""
    value, words = getattr(config, name), name.replace("_", "-")
    if isinstance(value, bool):
        return f"--{words}" if value else f"--no-{words}"
    return f"--{words} {value}"


def _is_settled(verdict: Verdict) -> bool:
    """Return whether a verdict holds what a model said, which is not asked again of its own accord."""
    return verdict.kind == "model" and not verdict.retryable and not is_person(verdict.model)

"""The command that judges models on a study."""

import json
import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from oodscen._cli.commands.completion import ComponentName
from oodscen._cli.options import (
    LIMITS,
    json_option,
    judging_options,
    limit_options,
    limits_from,
    refuse_idle,
    refuse_idle_prices,
    refuse_idle_server,
    require_option,
)
from oodscen._cli.output import say
from oodscen._cli.paths import READABLE, PathName
from oodscen._cli.progress import bars
from oodscen._cli.summaries import estimated, exit_code, graded, kept_verdicts, left_out, standings
from oodscen.data._verdict import without_pictures
from oodscen.errors import UsageError
from oodscen.judging._people import is_person
from oodscen.judging._references import ALWAYS

if TYPE_CHECKING:
    from oodscen.judging._leaderboard.requirements import RequirementResult
    from oodscen.llm._accounting import Ledger
    from oodscen.study._config import StudyConfig
    from oodscen.study._study import Study


@click.command()
@click.argument("out", type=PathName(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--vlm",
    "vlms",
    type=ComponentName("llm"),
    multiple=True,
    help="Vision-language model to judge; repeatable.",
)
@click.option(
    "--drop",
    "dropped",
    multiple=True,
    metavar="MODEL",
    help="Remove a judged model from the study first; repeatable.",
)
@judging_options
@click.option(
    "--answers",
    type=READABLE,
    multiple=True,
    help="File of a person's answers, as `oodscen quiz` pages save it; adds the row human:NAME; repeatable.",
)
@click.option(
    "--api-base",
    help="Address of an OpenAI-compatible server for the models named here.  [default: the study's]",
)
@click.option(
    "--retry-failed",
    is_flag=True,
    help="Ask again where the last answer was unusable or the model's own code failed.",
)
@click.option(
    "--dry-run", is_flag=True, help="Estimate calls, tokens and cost, without asking a model."
)
@require_option
@limit_options
@json_option
def evaluate(out: Path, as_json: bool, **choices: Any) -> None:
    """Judge more vision-language models on the study in the folder OUT.

    Prints the leaderboard, or leaderboard.json with --json. New items are asked first, then unanswered items
    of all models. If a model is given up, only its own items are lost.

    --chain, --rear-view and --ordinary hold for all models: once one has answered, only more ordinary drives may
    be asked for.

    --judge scores the open answers of all models, including earlier ones. --without-pictures and --retry-failed
    go for all judged models if no --vlm names one. --drop and --require alone ask no model. With --json the
    grades of a requirement are the member `requirements`.

    The exit code is 1 if a model judged here, or the judge, left an item without a usable answer. With --require it
    is 0 if all models meet, 4 if one fails, and 5 if none fails but the scenes are too few to decide.
    """
    from oodscen._pipeline import RunOptions, estimate, run_study
    from oodscen._pipeline.answering import add_answers
    from oodscen._pipeline.dropping import drop_models
    from oodscen.judging._leaderboard.requirements import parse_requirement
    from oodscen.llm._accounting import Ledger
    from oodscen.study._study import Study

    evaluation = _Evaluation(
        **{field.name: choices.pop(field.name) for field in fields(_Evaluation)}
    )
    if evaluation.required is not None:
        parse_requirement(evaluation.required)
    study = Study.open(out)
    evaluation.check()
    evaluation.check_against(study)
    limits, ledger = limits_from(choices), Ledger()
    refuse_idle_prices(limits, *evaluation.models(study.config))
    if evaluation.dry_run:
        rows = estimate(out, evaluation.configuration(study.config), RunOptions(limits=limits))
        say(json.dumps([row.model_dump() for row in rows]) if as_json else estimated(rows))
        return
    click.get_current_context().with_resource(study.store.writing())
    if evaluation.dropped:
        for name, count in drop_models(study, evaluation.dropped).items():
            say(f"{name} is taken out with {count} verdicts; {_after_drop(name)}", err=True)
    judged_before = {verdict.id for verdict in study.stored_verdicts}
    people = add_answers(study, evaluation.answers)
    config = evaluation.configuration(study.config, people)
    asked_at = _asked_at(study) if evaluation.vlms else {}
    if evaluation.has_questions:
        with bars(ledger) as progress:
            study = run_study(
                out,
                config,
                progress=progress,
                ledger=ledger,
                limits=limits,
                workers=os.cpu_count() or 1,
                retry=evaluation.retry_failed,
            )
    grades = None if evaluation.required is None else study.requirements(evaluation.required)
    _show_board(study, grades, as_json=as_json)
    for line in kept_verdicts(evaluation.vlms, ledger, asked_at):
        say(line, err=True)
    if grades is not None:
        sys.exit(exit_code(grades))
    # Without a name, --retry-failed judges all models again.
    judges_all = evaluation.retry_failed and not evaluation.vlms
    kept = set() if judges_all else judged_before
    judged = _verdict_names(evaluation.vlms, ledger)
    judged_here = [
        verdict for verdict in study.verdicts if verdict.model in judged or verdict.id not in kept
    ]
    unjudged = study.verdicts if evaluation.judge else judged_here
    sys.exit(
        any(verdict.status == "failed" for verdict in judged_here)
        or any(verdict.judge_error for verdict in unjudged)
    )


def _after_drop(name: str) -> str:
    """Say what remains of a row that was taken out, and how it comes back."""
    if name in ALWAYS:
        return "its row stays, as it is a reference of every study"
    if is_person(name):
        return "its answers stay in people.jsonl; to judge them again, give the file again (--answers FILE)"
    return "its answers stay in answers.jsonl, and judging it again uses them unless --retry-failed is given"


def _verdict_names(vlms: Iterable[str], ledger: "Ledger") -> set[str]:
    """Return the names of models in verdicts, with and without pictures."""
    names = {ledger.kept_verdicts[vlm][0] if vlm in ledger.kept_verdicts else vlm for vlm in vlms}
    return names | {without_pictures(name) for name in names}


def _asked_at(study: "Study") -> dict[str, str]:
    """Return when each judged model was last asked, by its name in verdicts; empty if not recorded."""
    return {
        call.get("model", ""): call.get("time", "")
        for call in study.store.lines("calls.jsonl")
        if call.get("stage") == "evaluate"
    }


@dataclass(frozen=True)
class _Evaluation:
    """The options of `evaluate` that say who is judged, and how."""

    vlms: tuple[str, ...]
    dropped: tuple[str, ...]
    protocol: str
    chain: bool | None
    rear_view: bool | None
    without_pictures: bool
    ordinary: int | None
    answers: tuple[Path, ...]
    judge: str | None
    api_base: str | None
    retry_failed: bool
    dry_run: bool
    required: str | None

    @property
    def has_questions(self) -> bool:
        """True if there is more to do than to remove models and to grade."""
        return (
            bool(self.vlms or self.judge or self.answers)
            or self.protocol == "paper"
            or self.without_pictures
            or self.retry_failed
            or bool(self.chosen)
        )

    def check(self) -> None:
        """Refuse options that ask for nothing, or that contradict each other."""
        if not (self.has_questions or self.dropped or self.required is not None):
            raise UsageError(
                "name a model to judge (--vlm MODEL), to remove (--drop MODEL), or to score open answers "
                "(--judge MODEL), or give a person's answers (--answers FILE) or a requirement (--require)"
            )
        if self.dry_run and (self.dropped or self.answers or self.required):
            raise UsageError(
                "--dry-run estimates what models would be asked: it goes without --drop, "
                "--answers and --require"
            )
        if self.dry_run:
            refuse_idle("with --dry-run, which counts what was never asked", "retry_failed")
        if not self.has_questions:
            refuse_idle("with --drop and --require alone, which ask no model", *LIMITS)
        if not self.named_models:
            refuse_idle("without --vlm or --judge, whose server it names", "api_base")
        refuse_idle_server(*self.named_models)

    def check_against(self, study: "Study") -> None:
        """Refuse what cannot be asked of a study, before a model is taken out of it."""
        from oodscen._pipeline.answering import read_answers
        from oodscen._pipeline.dropping import without_models
        from oodscen.study._shared_settings import refuse_changed_settings
        from oodscen.study._stale import refuse_stale

        if self.required is not None and not self.has_questions:
            # A model's questions would have the changed scenes run again.
            refuse_stale(study, study.episodes, study.scenes)
        self.configuration(study.config)
        if settings := {name: getattr(self, name) for name in self.chosen}:
            config, verdicts, _ = without_models(study, self.dropped)
            refuse_changed_settings(config, config.model_copy(update=settings), verdicts)
        read_answers(study, self.answers)

    @property
    def chosen(self) -> tuple[str, ...]:
        """The names of the settings shared by all models that the options choose."""
        from oodscen.study._config import SHARED

        return tuple(name for name in SHARED if getattr(self, name) is not None)

    @property
    def named_models(self) -> list[str]:
        """The models that the options name."""
        return [*self.vlms, self.judge] if self.judge else [*self.vlms]

    @property
    def servers(self) -> dict[str, str | None]:
        """The address of the server of each named model; empty without `--api-base`."""
        return dict.fromkeys(self.named_models, self.api_base) if self.api_base else {}

    def models(self, config: "StudyConfig") -> tuple[list[str], dict[str, str | None]]:
        """Return the models that may be asked, and the addresses of their servers."""
        remaining = [name for name in config.models if name not in self.dropped]
        return [*remaining, *self.named_models], {**config.servers, **self.servers}

    def configuration(self, config: "StudyConfig", people: tuple[str, ...] = ()) -> "StudyConfig":
        """Return the configuration of a study that judges so too, and these people's answers."""
        from oodscen.study._config import StudyConfig

        changes = {
            "vlms": self.vlms or (config.vlms if self.protocol == "paper" else ()),
            "protocols": (self.protocol,),
            "asked": {},
            "withheld": (self.vlms or config.vlms) if self.without_pictures else (),
            "people": people,
            "judge": self.judge,
            "servers": self.servers,
            **{name: getattr(self, name) for name in self.chosen},
        }
        return StudyConfig.parse(config.model_dump() | changes).judging_too(config, self.chosen)


def _show_board(
    study: "Study", grades: Sequence["RequirementResult"] | None, *, as_json: bool
) -> None:
    """Print the leaderboard with the grades of a requirement, and the items left out."""
    from oodscen.judging._aspects.labelled import agreement_in_words
    from oodscen.judging._leaderboard.board import Leaderboard

    board = Leaderboard.load(study.folder / "leaderboard.json")
    if as_json:
        content = board.model_dump(mode="json")
        if grades is not None:
            content["requirements"] = [grade.model_dump(mode="json") for grade in grades]
        say(json.dumps(content, indent=2, ensure_ascii=False))
    else:
        say("\n".join(filter(None, (standings(board), agreement_in_words(study.info)))))
        if grades is not None:
            say(graded(grades))
        say(f"report: {(study.folder / 'report.html').resolve()}")
    for line in left_out(study.verdicts):
        say(line, err=True)

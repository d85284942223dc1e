"""The models of one run: made by name, metered, recorded and accounted for."""

from collections.abc import Mapping
from typing import Any

from oodscen._entry_points import is_asked, is_builtin
from oodscen._pipeline.options import RunOptions
from oodscen._registry import make_llm
from oodscen.data._verdict import without_pictures
from oodscen.errors import UsageError
from oodscen.judging._people import is_person
from oodscen.judging._references import ALWAYS, is_reference, takes_cases
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.llm._fallback import FallbackLLM
from oodscen.llm._recording import Recorder
from oodscen.llm._replay import RecordingLLM, ReplayLLM
from oodscen.protocols import LLM
from oodscen.study._config import StudyConfig
from oodscen.study._store import Store

ANSWERS = "answers.jsonl"
"""The recording of a study; questions answered in it are not asked again."""


class Models:
    """Makes the models that a study asks, each of them once.

    Every model other than the built-in author, reference answerers and replays is recorded in
    `answers.jsonl`, so that a resumed run repeats no question; its calls count towards the run's caps.

    Args:
        config: Provides names, seed and address.
        store: The study's files.
        options: Provides models given for names, caps, prices and endpoints, and receives every call.
    """

    def __init__(self, config: StudyConfig, store: Store, options: RunOptions) -> None:
        self.stage = ""
        """The study's current stage, written to every line of `calls.jsonl`."""
        self.limits = options.limits
        self._config = config
        self._store = store
        self._options = options
        self._made: dict[tuple[str, str | None], LLM] = {}
        self._recorder: Recorder | None = None

    def author(self, name: str) -> LLM:
        """Return the model of this name as a writer, with the configuration's fallback."""
        return self._get(name, self._config.fallback)

    def get(self, name: str) -> LLM:
        """Return the model of this name, without a fallback."""
        return self._get(name, None)

    def close(self) -> None:
        """Close the recording; the next question opens it again."""
        if self._recorder is not None:
            self._recorder.close()

    def threads(self, name: str) -> int:
        """Return how many questions a model may be asked at once."""
        return 1 if is_builtin(name) else self.limits.concurrency

    def check_names(self) -> None:
        """Check that every answerer to be judged has a name of its own, under which its verdicts are kept.

        Raises:
            UsageError: If two have one name, or a model has that of a reference or of a person.
        """
        names = [
            (name, self.get(name).name)
            for name in self._config.vlms
            if is_asked(name) or not is_reference(self.get(name))
        ]
        for name, verdict_name in names:
            if is_person(verdict_name):
                raise UsageError(
                    f"{name!r} calls itself {verdict_name!r}, which is how a person's answers are named: give it "
                    "another name"
                )
        names += [
            (f"{name} without pictures", without_pictures(self.get(name).name))
            for name in self._config.withheld
            if name in self._config.vlms and not takes_cases(self.get(name))
        ]
        owners = dict.fromkeys(ALWAYS, "a reference")
        for name, verdict_name in names:
            if verdict_name in owners:
                raise UsageError(
                    f"the answers of {name!r} would be kept under the name {verdict_name!r}, which is that of "
                    f"{owners[verdict_name]}: give it another name, or take one of them out (oodscen evaluate --drop)"
                )
            owners[verdict_name] = repr(name)

    def _get(self, name: str, fallback: str | None) -> LLM:
        key = (name, fallback)
        if key not in self._made:
            self._made[key] = self._wrapped(name, fallback)
        return self._made[key]

    def _wrapped(self, name: str, fallback: str | None) -> LLM:
        model = self._make(name)
        if is_reference(model):
            return model
        logged: LLM = LoggedLLM(model, self._log)
        if fallback is not None:
            logged = FallbackLLM(logged, LoggedLLM(self._make(fallback), self._log))
        elif is_builtin(name) or isinstance(model, ReplayLLM):
            return logged
        if self._recorder is None:
            self._recorder = Recorder.at(self._store.path(ANSWERS))
        return RecordingLLM(logged, self._recorder, is_reading=not self._options.retry)

    def _make(self, name: str) -> LLM:
        try:
            model = make_llm(
                self._options.models.get(name) or name,
                seed=self._config.seed,
                api_base=self._config.servers.get(name, self._config.api_base),
                limits=self.limits,
            )
        except UsageError as error:
            if name not in self._judged_before():
                raise
            raise UsageError(
                f"{error}; it was judged in this study before, and oodscen evaluate --drop {name} takes it out"
            ) from None
        if isinstance(model, ReplayLLM) and self._is_new_answerer(name):
            model.refuse_several()
        return model

    def _is_new_answerer(self, name: str) -> bool:
        """Return whether a model is to be judged, or to judge, that the study on disk does not name as such."""
        if name == self._config.judge:
            return name != self._config_before().get("judge")
        return name in self._config.vlms and name not in self._judged_before()

    def _judged_before(self) -> tuple[str, ...]:
        """Return the models that the study on disk names as judged."""
        return tuple(self._config_before().get("vlms", ()))

    def _config_before(self) -> Mapping[str, Any]:
        """Return the configuration of the study on disk; empty if there is none."""
        if not self._store.has("study.json"):
            return {}
        config: Mapping[str, Any] = self._store.read("study.json").get("config", {})
        return config

    def _log(self, call: Call) -> None:
        call = call.model_copy(update={"stage": self.stage})
        self._options.ledger.add(call)
        self._store.append("calls.jsonl", call)

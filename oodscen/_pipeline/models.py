"""The models of one run: made by name, metered, recorded, accounted for."""

from collections.abc import Mapping

from oodscen._registry import is_builtin, make_llm
from oodscen.judging._references import is_reference
from oodscen.llm._accounting import Ledger
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.llm._capped import MeteredLLM
from oodscen.llm._fallback import FallbackLLM
from oodscen.llm._remote.limits import Traffic
from oodscen.llm._replay import Recorder, RecordingLLM, ReplayLLM
from oodscen.protocols import LLM
from oodscen.study._config import StudyConfig
from oodscen.study._store import Store

ANSWERS = "answers.jsonl"
"""The recording of a study: what is in it is not asked again."""


class Models:
    """Makes the models that a study asks; each is made once.

    A model that is neither built in nor a reference answerer nor a replay is recorded in `answers.jsonl`, so
    that a run that was stopped asks nothing twice, and its calls are held to the run's caps.

    Args:
        config: Names, seed and address.
        store: Of the study.
        traffic: Caps, prices and endpoints of the run.
        given: Objects that answer for names.
        ledger: Told about every call.
        is_retry: Ask anew what failed, whatever is recorded.
    """

    def __init__(
        self,
        config: StudyConfig,
        store: Store,
        traffic: Traffic,
        *,
        given: Mapping[str, LLM] | None = None,
        ledger: Ledger | None = None,
        is_retry: bool = False,
    ) -> None:
        self.stage = ""
        """Of the study, named in every line of `calls.jsonl`."""
        self.traffic = traffic
        self._config = config
        self._store = store
        self._given = given or {}
        self._ledger = ledger or Ledger()
        self._is_retry = is_retry
        self._made: dict[str, LLM] = {}
        self._recorder: Recorder | None = None

    def author(self, name: str) -> LLM:
        """Return the model that writes under this name, with the fallback of the configuration."""
        fallback = self._config.fallback
        return self.get(name) if fallback is None else self._get(name, fallback)

    def get(self, name: str) -> LLM:
        """Return the model of this name alone."""
        return self._get(name, None)

    def close(self) -> None:
        """Let go of the recording; the next question opens it again."""
        if self._recorder is not None:
            self._recorder.close()

    def threads(self, name: str) -> int:
        """Return how many questions may be put to a model at once."""
        return 1 if is_builtin(name) else self.traffic.concurrency

    def _get(self, name: str, fallback: str | None) -> LLM:
        key = f"{name}\0{fallback or ''}"
        if key not in self._made:
            self._made[key] = self._wrapped(name, fallback)
        return self._made[key]

    def _wrapped(self, name: str, fallback: str | None) -> LLM:
        made = self._make(name)
        if is_reference(made):
            return made
        logged: LLM = LoggedLLM(made, self._log)
        if fallback is not None:
            logged = FallbackLLM(logged, LoggedLLM(self._make(fallback), self._log))
        if fallback is None and (is_builtin(name) or isinstance(made, ReplayLLM)):
            return logged
        if self._recorder is None:
            self._recorder = Recorder.at(self._store.path(ANSWERS))
        return RecordingLLM(logged, self._recorder, is_reading=not self._is_retry)

    def _make(self, name: str) -> LLM:
        given = self._given.get(name)
        made = make_llm(
            given or name,
            seed=self._config.seed,
            api_base=self._config.servers.get(name, self._config.api_base),
            traffic=self.traffic,
        )
        # A client of litellm counts its HTTP requests itself.
        is_free = is_builtin(name) and given is None
        is_free = is_free or isinstance(made, ReplayLLM) or hasattr(made, "traffic")
        return made if is_free or is_reference(made) else MeteredLLM(made, self.traffic)

    def _log(self, call: Call) -> None:
        call = call.model_copy(update={"stage": self.stage})
        self._ledger.add(call)
        self._store.append("calls.jsonl", call)

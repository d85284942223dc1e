"""Models that record their answers, and models that answer from a recording."""

import time
from pathlib import Path

from oodscen._display import Brief
from oodscen._files import refuse_special
from oodscen.errors import DataError, Issue, ReplayMiss
from oodscen.llm._check import complete
from oodscen.llm._recording import Exchange, Recorder, Recording
from oodscen.llm._wrapper import WrappingLLM
from oodscen.protocols import LLM, Completion, Request


class RecordingLLM(WrappingLLM):
    """Records every answer of another model, and answers recorded questions from the recording.

    Args:
        llm: The wrapped model.
        recorder: The recording; several models may share one.
        is_reading: Answer from the recording if it holds an answer of this model.
    """

    _repr_fields = ("_llm", "_recorder")

    def __init__(
        self, llm: LLM, recorder: Recorder | str | Path, *, is_reading: bool = True
    ) -> None:
        super().__init__(llm)
        self._recorder = recorder if isinstance(recorder, Recorder) else Recorder.at(recorder)
        self._is_reading = is_reading

    def complete(self, request: Request) -> Completion:
        """Return the recorded answer, or ask the model and record its answer.

        Raises:
            InUse: When another process is recording to the file; the model is not asked.
        """
        if (found := self._found(request)) is not None:
            return found
        self._recorder.open()
        if (found := self._found(request)) is not None:
            return found
        began = time.perf_counter()
        completion = complete(self._llm, request)
        seconds = time.perf_counter() - began
        self._recorder.add(Exchange.of(request, completion, self.name, seconds))
        return completion

    def _found(self, request: Request) -> Completion | None:
        exchange = self._recorder.find(request, self.name) if self._is_reading else None
        return None if exchange is None else exchange.again()


class ReplayLLM(Brief):
    """Answers from a recording without asking any model: `replay:FILE`, or `replay:FILE#MODEL`.

    Args:
        source: The file, and after a `#` the model whose answers to give, if there are several.

    Raises:
        DataError: When the file does not exist or is not a recording.
    """

    _repr_fields = ("name",)

    def __init__(self, source: str | Path) -> None:
        path, mark, model = str(source).rpartition("#")
        if not mark or Path(source).is_file():
            path, model = str(source), ""
        refuse_special(path, "recording")
        self.name = (
            f"replay:{Path(path).name}{mark and '#'}{model}"
            if model
            else (f"replay:{Path(path).name}")
        )
        self._model = model or None
        self._recording = Recording(path)
        if not len(self._recording):
            raise DataError(
                "recording", [Issue("line 1", "it is no exchange, nor is another")], source=path
            )

    @property
    def speaks_for(self) -> str:
        """Name of the recorded model, or this object's own if there are several."""
        names = {self._model} if self._model else self._recording.models
        return str(*names) if len(names) == 1 else self.name

    def complete(self, request: Request) -> Completion:
        """Return the recorded answer.

        Raises:
            ReplayMiss: When there is none, with the differences from the most similar question.
        """
        exchange = self._recording.find(request, self._model)
        if exchange is None:
            raise ReplayMiss(
                self.name,
                request.prompt.purpose,
                self._recording.differences(request, self._model),
            )
        return exchange.again()

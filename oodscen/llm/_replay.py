"""Models that record their answers, and models that answer from a recording."""

import os
import time
from dataclasses import replace
from itertools import accumulate
from pathlib import Path

from oodscen._display import Brief
from oodscen._io.files import refuse_special
from oodscen.errors import DataError, Issue, ReplayMiss, UnknownComponent
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
        if (recorded := self._recorded(request)) is not None:
            return recorded
        self._recorder.open()
        # Opening reads what other processes have recorded meanwhile.
        if (recorded := self._recorded(request)) is not None:
            return recorded
        request = replace(request, repeat=self._recorder.count(request, self.name))
        began = time.perf_counter()
        completion = complete(self._llm, request)
        seconds = time.perf_counter() - began
        self._recorder.add(Exchange.of(request, completion, self.name, seconds))
        return completion

    def _recorded(self, request: Request) -> Completion | None:
        if not self._is_reading:
            return None
        exchange = self._recorder.find(request, self.name)
        return None if exchange is None else exchange.completion()


class ReplayLLM(Brief):
    """Answers from a recording without asking any model: `replay:FILE`, or `replay:FILE#MODEL`.

    Args:
        source: The file, and after a `#` the model whose answers to give, if there are several.

    Raises:
        DataError: When the file does not exist or is not a recording.
        UnknownComponent: When it has no answers of the model.
    """

    _repr_fields = ("name",)

    def __init__(self, source: str | Path) -> None:
        path, self._model = _file_and_model(str(source))
        refuse_special(path, "recording")
        self.name = f"replay:{Path(path).name}"
        if self._model:
            self.name += f"#{self._model}"
        self._recording = Recording(path)
        if not len(self._recording):
            issue = Issue("line 1", "is no exchange, and none follows")
            raise DataError("recording", [issue], source=path)
        if self._model and self._model not in self._recording.models:
            raise UnknownComponent("recorded model", self._model, self._recording.models - {""})

    @property
    def speaks_for(self) -> str:
        """Name of the recorded model, or this object's own if there are several or it has none."""
        names = {self._model} if self._model else self._recording.models
        return (names.pop() if len(names) == 1 else "") or self.name

    def refuse_several(self) -> None:
        """Refuse a recording in which several models answered one question, unless one is chosen.

        Raises:
            UsageError: If it is one.
        """
        if not self._model:
            self._recording.refuse_several()

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
        return exchange.completion()


def _file_and_model(source: str) -> tuple[str, str | None]:
    """Return the file and the model that `FILE#MODEL` names; the name of either may hold a `#` itself."""
    beginnings = accumulate(source.split("#"), "{}#{}".format)
    otherwise = source.rpartition("#")[0] or source
    path = max(filter(os.path.isfile, beginnings), key=len, default=otherwise)
    return path, source[len(path) + 1 :] or None

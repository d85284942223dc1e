"""The base class of language models that wrap another one."""

from typing import Any, ClassVar

from oodscen._display import Brief
from oodscen._members import conforming
from oodscen.protocols import LLM


class WrappingLLM(Brief):
    """A model that wraps another one: it has the other's name, and the other's attributes where it lacks its own.

    Args:
        llm: The wrapped model.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("_llm",)

    def __init__(self, llm: LLM) -> None:
        self.name = conforming("llm", llm).name
        self._llm = llm

    def __getattr__(self, name: str) -> Any:
        # While `copy` makes an object, it has no `_llm` yet.
        if name.startswith("_"):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return getattr(self._llm, name)

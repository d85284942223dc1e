"""The base class of language models that wrap another one."""

from typing import Any, ClassVar

from oodscen._display import Brief
from oodscen._members import conforming
from oodscen.protocols import LLM


class Wrapper(Brief):
    """Takes over the name and the attributes of the wrapped model.

    Args:
        llm: The wrapped model.
    """

    _repr_fields: ClassVar[tuple[str, ...]] = ("_llm",)

    def __init__(self, llm: LLM) -> None:
        self.name = conforming("llm", llm).name
        self._llm = llm

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._llm, name)

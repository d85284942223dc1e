"""The base of language models that stand in front of another one."""

from typing import Any

from oodscen.protocols import LLM


class Wrapper:
    """Takes the name and the attributes of the model behind it.

    Args:
        llm: The model that really answers.
    """

    def __init__(self, llm: LLM) -> None:
        self.name = llm.name
        self._llm = llm

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._llm, name)

"""Doubles without dependencies, and the checks that third-party adapters run on themselves."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from oodscen.testing.check import check_simulator
    from oodscen.testing.encoder import HashEncoder
    from oodscen.testing.flat import FlatSimulator
    from oodscen.testing.llm import FunctionLLM, ScriptedLLM
    from oodscen.testing.server import AnsweringServer
    from oodscen.testing.truth import check_truth

_HOMES = {
    "AnsweringServer": "server",
    "FlatSimulator": "flat",
    "FunctionLLM": "llm",
    "HashEncoder": "encoder",
    "ScriptedLLM": "llm",
    "check_simulator": "check",
    "check_truth": "truth",
}

__all__ = [
    "AnsweringServer",
    "FlatSimulator",
    "FunctionLLM",
    "HashEncoder",
    "ScriptedLLM",
    "check_simulator",
    "check_truth",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})

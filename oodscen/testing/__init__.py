"""Doubles without dependencies, and the checks that third-party adapters run on themselves."""

from typing import TYPE_CHECKING

from oodscen._lazy import lazily

if TYPE_CHECKING:
    from oodscen.testing.check import check_simulator
    from oodscen.testing.encoder import HashEncoder
    from oodscen.testing.flat import FlatSimulator
    from oodscen.testing.llm import FunctionLLM, ScriptedLLM
    from oodscen.testing.server import AnsweringServer
    from oodscen.testing.truth import check_truth
else:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "AnsweringServer": "server",
            "FlatSimulator": "flat",
            "FunctionLLM": "llm",
            "HashEncoder": "encoder",
            "ScriptedLLM": "llm",
            "check_simulator": "check",
            "check_truth": "truth",
        },
    )

__all__ = [
    "AnsweringServer",
    "FlatSimulator",
    "FunctionLLM",
    "HashEncoder",
    "ScriptedLLM",
    "check_simulator",
    "check_truth",
]

"""The content of `study.json`: authors, configuration and versions."""

import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict

from oodscen._entry_points import is_builtin
from oodscen._io.files import file_sha256
from oodscen._version import __version__
from oodscen._words.redaction import redact
from oodscen.data._base import Data, digest
from oodscen.prompts._versions import prompt_versions
from oodscen.study._config import Status, StudyConfig
from oodscen.tree._scenario_tree import ScenarioTree

_BUILTIN = (
    "the built-in author: a deterministic, seeded writer over a knowledge base of hazards, not a "
    "language model"
)
_PACKAGES = ("numpy", "pydantic", "torch", "sentence-transformers", "litellm")


class Info(Data):
    """The fields of `study.json` that every reader may rely on; other fields are allowed."""

    noun: ClassVar[str] = "study"
    model_config = ConfigDict(extra="allow")

    schema_version: Literal[1] = 1
    status: Status | None = None
    config: dict[str, Any]
    authors: dict[str, str] = {}
    versions: dict[str, str] = {}
    prompts: dict[str, str] = {}
    counts: dict[str, Any] = {}
    failures: dict[str, int] = {}
    usage: tuple[dict[str, Any], ...] = ()
    seconds: dict[str, float] = {}
    stopped: str = ""
    camera: Literal["dash", "top"] = "dash"
    """`top` if the simulator draws views from above only, about which no model is asked."""
    rehearses: bool = True
    """False if the simulator can try no action on a road with less grip or at another speed."""


def record(
    config: StudyConfig,
    status: Status,
    *,
    tree: ScenarioTree | None = None,
    packages: Sequence[str] = (),
    **more: Any,
) -> dict[str, Any]:
    """Return the content of `study.json`.

    Args:
        config: The configuration of the run.
        status: The state of the run.
        tree: The tree that the study is given, if it is.
        packages: The installed packages on which the simulator's motion and pictures depend.
        more: Counts, failures and times, once there are any.
    """
    return {
        "schema_version": 1,
        "status": status,
        "config": config.model_dump(mode="json"),
        "authors": authors(config) | ({} if tree is None else {"tree": _given(tree)}),
        "versions": versions(packages),
        "prompts": prompt_versions(),
        **more,
    }


def authors(config: StudyConfig) -> dict[str, str]:
    """Return who may have written the texts; the built-in author is worded so that it cannot pass for a model."""
    names = {
        "llm": config.llm,
        "red_llm": (config.red_llm or config.llm) if config.iterations else None,
        "fallback": config.fallback,
    }
    return {role: _author(name) for role, name in names.items() if name is not None}


def _given(tree: ScenarioTree) -> str:
    """Return a tree's digest, and the models that wrote it according to its log."""
    models = dict.fromkeys(redact(edit.model) for edit in tree.edits if edit.model)
    written = f", written by {', '.join(models)}" if models else ""
    return f"given (digest {tree.digest()[:16]}){written}"


def _author(name: str) -> str:
    if not is_builtin(name):
        return name
    _, colon, knowledge = name.partition(":")
    if not colon:
        return _BUILTIN
    path = Path(knowledge)
    files = sorted(path.glob("*.toml")) if path.is_dir() else [path]
    sums = [[file.name, file_sha256(file).hex()] for file in files if file.is_file()]
    return f"{_BUILTIN}, extended by {path.absolute().name} (digest {digest(sums)[:16]})"


def versions(packages: Sequence[str] = ()) -> dict[str, str]:
    """Return the versions of everything that the results may depend on, the packages of a simulator included."""
    installed = {package: _installed(package) for package in (*_PACKAGES, *packages)}
    return {"oodscen": __version__, "python": platform.python_version(), **installed}


def joined_versions(earlier: Mapping[str, str], now: Mapping[str, str]) -> dict[str, str]:
    """Return the versions of all runs that a study has taken, with a comma between those of one package."""
    joined = dict(earlier)
    for package, found in now.items():
        seen = joined.get(package)
        if seen is None:
            joined[package] = found
        elif found not in seen.split(", "):
            joined[package] = f"{seen}, {found}"
    return joined


@cache
def _installed(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"

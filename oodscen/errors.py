"""All exceptions that oodscen raises.

    OodscenError
    ├── UsageError              the caller's mistake
    │   ├── UnknownComponent    no such simulator, model, encoder, asset ... (with close matches)
    │   ├── MissingExtra        an optional dependency is not installed (with the pip line)
    │   ├── DataError           malformed tree, scenario, scene or file (every issue with its path)
    │   ├── StudyMismatch       the folder belongs to a different configuration
    │   ├── StudyMissing        the folder holds no study; also a StudyError
    │   ├── FolderTaken         the folder holds files that this command did not make (which)
    │   └── InUse               another process is writing this folder or file (who, since when)
    ├── LLMError                a model could not be reached, or its answer not understood
    │   ├── AnswerError         its answer stayed invalid after repair (keeps the raw text)
    │   ├── ResponseError       the response was not an answer: no body, a web page, too large (keeps its start)
    │   ├── LLMTimeout          the server responds, but no answer came in time
    │   ├── ContentFiltered     the provider's content filter blocked this question
    │   ├── ModelSkipped        not asked: the run had already given up on the model
    │   └── ReplayMiss          a recording has no answer to this question (and what differs)
    ├── SceneError              the catalogue or the road refuses a scene
    ├── SimulatorError          the simulator failed
    │   ├── SpawnError          it refused one actor (actor, asset, pose, reason)
    │   └── SimulatorCrash      it crashed, or took its process down with it
    ├── EncoderError            an encoder failed or returned the wrong shape
    ├── StudyError              the folder on disk cannot be read or written
    └── RunStopped              the run stopped early; the study can be resumed
        ├── BudgetExceeded      a cap on requests, tokens, cost or time was reached
        └── EndpointDown        a model's server is down, or refuses the key

All exceptions can be pickled and carry their facts as attributes. Each can also be made of one message, or of an
exception of its own kind whose facts it takes over, as Gymnasium's vector environments do: its other facts are empty then.
"""

import difflib
import inspect
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from oodscen._display import cut
from oodscen._words.text import first_few

if TYPE_CHECKING:
    from oodscen.protocols import Usage

__all__ = [
    "AnswerError",
    "BudgetExceeded",
    "ContentFiltered",
    "DataError",
    "EncoderError",
    "EndpointDown",
    "FolderTaken",
    "InUse",
    "Issue",
    "LLMError",
    "LLMTimeout",
    "MissingExtra",
    "ModelSkipped",
    "OodscenError",
    "ReplayMiss",
    "ResponseError",
    "RunStopped",
    "SceneError",
    "SimulatorCrash",
    "SimulatorError",
    "SpawnError",
    "StudyError",
    "StudyMismatch",
    "StudyMissing",
    "UnknownComponent",
    "UsageError",
]


class Issue(NamedTuple):
    """One fault in the data."""

    path: str
    """Place of the fault, e.g. `actors[2].placement.lane`; empty for the value as a whole."""
    message: str
    """The fault, worded so that the reader knows how to fix it."""

    def __str__(self) -> str:
        return f"{self.path}: {self.message}" if self.path else self.message


class _OfAMessage(type):
    """Makes an error of one message where its class needs several arguments, and of another error."""

    def __call__(cls, *args: Any, **named: Any) -> Any:
        if len(args) == 1 and not named:
            (one,) = args
            if isinstance(one, cls) or (isinstance(one, Exception | str) and _needs_more(cls)):
                return _rebuild(cls, (str(one),), vars(one) if isinstance(one, cls) else {})
        return super().__call__(*args, **named)

    @property
    def __signature__(cls) -> inspect.Signature:
        known = inspect.signature(cls.__init__)  # type: ignore[misc]  # Of this very class.
        return known.replace(parameters=[*known.parameters.values()][1:])


@cache
def _needs_more(kind: type) -> bool:
    """Return whether a class of errors needs more than one argument."""
    variadic = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    required = [
        parameter
        for parameter in inspect.signature(kind).parameters.values()
        if parameter.default is parameter.empty and parameter.kind not in variadic
    ]
    return len(required) > 1


class OodscenError(Exception, metaclass=_OfAMessage):
    """Root of all errors of this library."""

    def __repr__(self) -> str:
        return cut(f"{type(self).__name__}({str(self)!r})")

    def __reduce__(self) -> tuple[Any, ...]:
        return (_rebuild, (type(self), self.args, self.__dict__))


def _rebuild(kind: Any, args: tuple[Any, ...], state: Mapping[str, Any]) -> Any:
    error = kind.__new__(kind)
    error.args = args
    error.__dict__.update(state)
    return error


class UsageError(OodscenError):
    """The caller asked for something impossible; running again will not help."""


class UnknownComponent(UsageError):
    """Nothing is registered under this name."""

    kind: str = ""
    name: str = ""
    known: tuple[str, ...] = ()
    matches: tuple[str, ...] = ()

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.kind = kind
        self.name = name
        self.known = tuple(sorted(known))
        self.matches = tuple(close_matches(str(name), self.known))
        hint = f"; did you mean {' or '.join(self.matches)}?" if self.matches else ""
        listing = (
            f" (known: {', '.join(self.known)})" if self.known and len(self.known) <= 40 else ""
        )
        super().__init__(f"unknown {kind} {name!r}{hint}{listing}")


class MissingExtra(UsageError):
    """The optional dependencies of a part of oodscen are not installed."""

    what: str = ""
    extra: str = ""
    module: str = ""
    pip: str = ""

    def __init__(self, what: str, extra: str, module: str) -> None:
        self.what = what
        self.extra = extra
        self.module = module
        self.pip = f"pip install 'oodscen[{extra}]'"
        super().__init__(f"{what} needs the package {module!r}: {self.pip}")


MOST_TOLD = 100
"""Number of issues that the text of an error lists; `issues` holds all of them."""


class DataError(UsageError):
    """Malformed data from a file, a model or a caller, or an unreadable file."""

    noun: str = ""
    issues: tuple[Issue, ...] = ()
    source: str = ""

    def __init__(
        self, noun: str, issues: Sequence[Issue], *, source: str = "", fault: str = "malformed"
    ) -> None:
        self.noun = noun
        self.issues = tuple(issues)
        self.source = source
        place = f" in {source}" if source else ""
        lines = "".join(f"\n  - {issue}" for issue in self.issues[:MOST_TOLD])
        more = f"\n  - and {len(issues) - MOST_TOLD} more" if len(issues) > MOST_TOLD else ""
        super().__init__(f"{fault} {noun}{place}:{lines}{more}")


class StudyMismatch(UsageError):
    """The study on disk was made with another configuration."""

    folder: str = ""
    differences: Mapping[str, tuple[object, object]] = MappingProxyType({})

    def __init__(self, folder: str, differences: Mapping[str, tuple[object, object]]) -> None:
        self.folder = folder
        self.differences = differences
        lines = "".join(
            f"\n  - {key}: the study has {old!r}, you asked for {new!r}"
            for key, (old, new) in differences.items()
        )
        super().__init__(
            f"{folder} holds a study of another configuration; choose another folder or the "
            f"same options:{lines}"
        )


class LLMError(OodscenError):
    """A language model could not be reached or did not answer."""

    model: str = ""
    retryable: bool = False
    requests: int = 0

    def __init__(
        self, message: str, *, model: str = "", retryable: bool = False, requests: int = 0
    ) -> None:
        self.model = model
        self.retryable = retryable
        """True if a later try may succeed."""
        self.requests = requests
        """Number of HTTP requests made."""
        super().__init__(message)


class ResponseError(LLMError):
    """A server repeatedly sent a response that is not an answer."""

    status: int | None = None
    raw: str = ""

    def __init__(
        self, message: str, *, model: str, status: int | None, raw: str, requests: int = 0
    ) -> None:
        self.status = status
        self.raw = raw
        """The beginning of the last response, with credentials removed."""
        super().__init__(message, model=model, retryable=True, requests=requests)


class LLMTimeout(LLMError):
    """A server responds, but did not answer in time."""


class ContentFiltered(LLMError):
    """A provider's content filter blocked a question; a refusal in the model's own words is an answer."""

    usage: "Usage | None" = None

    def __init__(
        self, message: str, *, model: str = "", usage: "Usage | None" = None, requests: int = 0
    ) -> None:
        self.usage = usage
        """Tokens and cost that the provider states, since a filtered answer may be billed; `None` without a response."""
        super().__init__(message, model=model, requests=requests)


class ModelSkipped(LLMError):
    """A question was not sent, because the run had already given up on its model."""

    reason: str = ""

    def __init__(self, reason: str, *, model: str) -> None:
        self.reason = reason
        super().__init__(f"not asked: {reason}", model=model, retryable=True)


class ReplayMiss(LLMError):
    """A recording holds no answer to a question."""

    purpose: str = ""
    differences: tuple[Issue, ...] = ()

    def __init__(self, model: str, purpose: str, differences: Sequence[Issue]) -> None:
        self.purpose = purpose
        self.differences = tuple(differences)
        """Differences between the question and the most similar recorded one."""
        faults = "; ".join(map(str, self.differences))
        super().__init__(f"{model} has no answer to {purpose!r}: {faults}", model=model)


class AnswerError(LLMError):
    """A model's answer stayed invalid although its faults were fed back to the model."""

    purpose: str = ""
    issues: tuple[Issue, ...] = ()
    raw: str = ""
    attempts: int = 0
    """Number of answers; 0 if no answer to the question could be valid, so that it was not asked."""

    def __init__(
        self, model: str, purpose: str, issues: Sequence[Issue], raw: str, attempts: int
    ) -> None:
        self.purpose = purpose
        self.issues = tuple(issues)
        self.raw = raw
        self.attempts = attempts
        faults = "; ".join(map(str, self.issues))
        happened = "gave no valid answer to" if attempts else "was not asked"
        tries = f" in {attempts} attempts" if attempts > 1 else ""
        super().__init__(f"{model} {happened} {purpose!r}{tries}: {faults}", model=model)


class SceneError(OodscenError):
    """A scene that cannot be staged; lists every reason with its path in the scene."""

    scene_id: str = ""
    issues: tuple[Issue, ...] = ()

    def __init__(self, scene_id: str, issues: Sequence[Issue]) -> None:
        self.scene_id = scene_id
        self.issues = tuple(issues)
        lines = "".join(f"\n  - {issue}" for issue in self.issues)
        super().__init__(f"scene {scene_id!r} cannot be staged:{lines}")


class SimulatorError(OodscenError):
    """A simulator failed while running a scene."""


class SpawnError(SimulatorError):
    """A simulator refused to place one actor."""

    actor: str = ""
    asset: str = ""
    pose: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    reason: str = ""

    def __init__(
        self, actor: str, asset: str, pose: tuple[float, float, float, float], reason: str
    ) -> None:
        self.actor = actor
        self.asset = asset
        self.pose = pose
        self.reason = reason
        x, y, z, yaw = pose
        super().__init__(
            f"cannot spawn {actor!r} ({asset}) at x={x:.2f} y={y:.2f} z={z:.2f} yaw={yaw:.2f}: {reason}"
        )


class SimulatorCrash(SimulatorError):
    """A simulator crashed during a scene: a foreign exception or a dead process."""

    simulator: str = ""
    reason: str = ""
    retryable: bool = False

    def __init__(self, simulator: str, reason: str, *, retryable: bool = False) -> None:
        self.simulator = simulator
        self.reason = reason
        self.retryable = retryable
        """True if a later try may succeed: a process can die for outside reasons."""
        super().__init__(f"the simulator {simulator!r} crashed: {reason}")


class EncoderError(OodscenError):
    """An encoder failed, or did not return one finite row per text."""


class StudyError(OodscenError):
    """A study's folder cannot be read or written; earlier results stay valid."""


class StudyMissing(StudyError, UsageError):
    """The given folder holds no study."""

    folder: str = ""

    def __init__(self, folder: str) -> None:
        self.folder = folder
        super().__init__(f"{folder} holds no study: it has no study.json")


class FolderTaken(UsageError):
    """A folder holds files of the same name that the command did not make; nothing was changed."""

    folder: str = ""
    names: tuple[str, ...] = ()

    def __init__(self, folder: str, names: Sequence[str]) -> None:
        self.folder = folder
        self.names = tuple(names)
        super().__init__(
            f"{folder} holds {first_few(self.names)} already; nothing is overwritten: choose another "
            "folder, or move these files away"
        )


class InUse(UsageError):
    """Another process is writing the folder or file; nothing was changed."""

    path: str = ""
    what: str = ""
    holder: str = ""
    since: str = ""

    def __init__(self, path: str, what: str, holder: str, since: str) -> None:
        self.path = path
        self.what = what
        self.holder = holder
        """Process, host and command of the writer."""
        self.since = since
        """Date and time, as text; empty if unknown."""
        began = f" since {since}" if since else ""
        super().__init__(
            f"the {what} {path} is being written by {holder}{began}; wait for its end, or choose "
            "another place"
        )


class RunStopped(OodscenError):
    """The run stopped early; its results stay valid, and the same command continues it."""

    requests: int = 0
    """Number of HTTP requests that the stopped call of a model had made."""


class BudgetExceeded(RunStopped):
    """The next request could exceed a cap on requests, tokens, cost or time."""

    cap: str = ""
    limit: float = 0.0
    spent: float = 0.0

    def __init__(self, cap: str, limit: float, spent: float) -> None:
        self.cap = cap
        """The cap: `requests`, `tokens`, `cost_usd` or `seconds`."""
        self.limit = limit
        self.spent = spent
        super().__init__(
            f"the cap of {limit:g} {cap.replace('_usd', ' in USD')} is reached ({spent:g} used or under way; "
            "the next request could exceed it); the same command continues where it stopped"
        )


class EndpointDown(RunStopped):
    """A model's server no longer answers any request, or refuses the key."""

    endpoint: str = ""
    reason: str = ""

    def __init__(self, endpoint: str, reason: str) -> None:
        self.endpoint = endpoint
        self.reason = reason
        super().__init__(
            f"{endpoint} is given up: {reason}; fix this and run the same command to continue"
        )


def close_matches(name: str, known: Iterable[str]) -> list[str]:
    """Return up to three known names that resemble `name`, best match first."""
    by_fold = {candidate.casefold(): candidate for candidate in known}
    found = difflib.get_close_matches(name.casefold(), list(by_fold), n=3, cutoff=0.55)
    return [by_fold[match] for match in found]

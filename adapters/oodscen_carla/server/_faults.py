"""Faults that the server produces for tests."""

import json
import threading
from dataclasses import asdict, dataclass
from typing import Literal, get_args

FaultKind = Literal["late", "refuse", "hang", "die", "drop"]


@dataclass(frozen=True)
class Fault:
    """One fault; it strikes the calls of one procedure.

    `refuse` answers with an error, `hang` never answers, `die` ends the server's process. `late`
    sends the pictures of a tick after its answer, and `drop` loses them; both strike ticks.
    """

    kind: FaultKind
    call: str = "tick_cue"
    """The procedure."""
    after: int = 0
    """Number of calls that pass first."""
    times: int = 1
    """Number of calls that are struck."""

    def __post_init__(self) -> None:
        if self.kind not in get_args(FaultKind):
            raise ValueError(f"no fault {self.kind!r}; known: {', '.join(get_args(FaultKind))}")
        if any(type(count) is not int or count < 0 for count in (self.after, self.times)):
            raise ValueError("after and times are whole numbers from 0")

    @classmethod
    def from_json(cls, line: str) -> "Fault":
        """Read what `to_json` has written.

        Raises:
            ValueError: If the line is no fault.
        """
        fields = json.loads(line)
        try:
            return cls(**fields)
        except TypeError:
            raise ValueError("a fault has a kind, and may have call, after and times") from None

    def to_json(self) -> str:
        """Return the fault as one line."""
        return json.dumps(asdict(self))


@dataclass
class _Pending:
    """A fault that is still to come."""

    fault: Fault
    passes: int
    """Number of calls that still pass before it."""
    strikes: int
    """Number of calls that it still strikes."""


class Faults:
    """The faults that are still to come."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pending: list[_Pending] = []

    def add(self, fault: Fault) -> None:
        """Add a fault."""
        with self._lock:
            self._pending.append(_Pending(fault, fault.after, fault.times))

    def strike(self, call: str) -> FaultKind | None:
        """Count a call, and return the fault that strikes it."""
        kind: FaultKind | None = None
        with self._lock:
            for pending in self._pending:
                if pending.fault.call != call or not pending.strikes:
                    continue
                if pending.passes:
                    pending.passes -= 1
                elif kind is None:
                    pending.strikes -= 1
                    kind = pending.fault.kind
        return kind

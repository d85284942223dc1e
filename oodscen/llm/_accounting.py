"""The resources that a run's calls used, per stage and model, and as one progress line."""

import math
import threading
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar, TypeGuard

from oodscen._entry_points import is_asked
from oodscen.data._base import Data
from oodscen.llm._call_log import Call

_MOST = 1e15
"""Upper bound of a valid amount, since a file may hold anything: others count as missing, as do negative ones."""


class Account(Data):
    """The totals of a group of calls, e.g. of one stage to one model."""

    noun: ClassVar[str] = "account"

    group: tuple[str, ...]
    """The values that the group's calls share, e.g. stage and model."""
    calls: int
    requests: int
    """HTTP requests."""
    retries: int
    """HTTP requests beyond the first of their call."""
    repairs: int
    """Calls that asked for a repaired answer."""
    failed: int
    input_tokens: int
    output_tokens: int
    cached_tokens: int
    cacheable_tokens: int
    cost_usd: float | None
    """Cost in USD; `None` if that of a call with an answer or tokens is not known."""
    seconds: float
    """Sum over all calls, some of which may have overlapped."""
    p50_s: float
    """Median duration of a call, in seconds."""
    p95_s: float


def accounts(
    calls: Iterable[Mapping[str, Any]], by: Sequence[str] = ("stage", "model")
) -> list[Account]:
    """Sum up lines of `calls.jsonl`, one account per group, in the order of first appearance.

    Args:
        calls: The lines.
        by: Fields that the calls of a group share.
    """
    groups: dict[tuple[str, ...], list[Mapping[str, Any]]] = {}
    for call in calls:
        groups.setdefault(tuple(str(call.get(name) or "?") for name in by), []).append(call)
    return [account(group, members) for group, members in groups.items()]


def account(group: tuple[str, ...], calls: Sequence[Mapping[str, Any]]) -> Account:
    """Sum up the calls of one group; missing and invalid amounts count as 0."""
    requests = [int(_number(call, "requests")) for call in calls]
    costs = [call.get("cost_usd") for call in calls if _is_billed(call)]
    known_costs = [float(cost) for cost in costs if _is_amount(cost)]
    seconds = sorted(_number(call, "seconds") for call in calls)
    return Account(
        group=group,
        calls=len(calls),
        requests=sum(requests),
        retries=sum(max(0, number - 1) for number in requests),
        repairs=sum(_number(call, "attempt") > 1 for call in calls),
        failed=sum(call.get("status") == "failed" for call in calls),
        input_tokens=round(sum(_number(call, "input_tokens") for call in calls)),
        output_tokens=round(sum(_number(call, "output_tokens") for call in calls)),
        cached_tokens=round(sum(_number(call, "cached_tokens") for call in calls)),
        cacheable_tokens=round(sum(_number(call, "cacheable_tokens") for call in calls)),
        cost_usd=sum(known_costs) if len(known_costs) == len(costs) else None,
        seconds=round(sum(seconds), 6),
        p50_s=_quantile(seconds, 0.5),
        p95_s=_quantile(seconds, 0.95),
    )


class Ledger:
    """Running totals of a run, for the progress line."""

    def __init__(self) -> None:
        self.calls = self.retries = self.repairs = self.failed = self.tokens = 0
        self.cost_usd = 0.0
        self.is_cost_known = True
        """True while the cost of every call is known that was answered by a model that is asked, or used tokens."""
        self.kept_verdicts: dict[str, tuple[str, int]] = {}
        """Name and number of verdicts kept from earlier runs, by the judged model's name in the configuration."""
        self._lock = threading.Lock()

    def add(self, call: Call) -> None:
        """Count one call."""
        with self._lock:
            self.calls += 1
            self.retries += max(0, call.requests - 1)
            self.repairs += call.attempt > 1
            self.failed += call.status == "failed"
            tokens = call.input_tokens + call.output_tokens
            self.tokens += tokens
            self.cost_usd += call.cost_usd or 0.0
            is_free = not tokens and (call.status != "ok" or not is_asked(call.model))
            self.is_cost_known &= call.cost_usd is not None or is_free

    def __str__(self) -> str:
        """Return the totals as a short line; empty before the first call."""
        if not self.calls:
            return ""
        parts = [f"{self.calls} calls"]
        if self.tokens or self.cost_usd or not self.is_cost_known:
            cost = f"${self.cost_usd:.2f}" if self.is_cost_known else "cost not known"
            parts += [f"{self.tokens / 1000:.0f}k tokens", cost]
        counts = {"retries": self.retries, "repairs": self.repairs, "failed": self.failed}
        return ", ".join([*parts, *(f"{count} {noun}" for noun, count in counts.items() if count)])


def _is_billed(call: Mapping[str, Any]) -> bool:
    """Return whether a call has a cost: one that was answered, or whose answer a filter withheld."""
    is_answered = call.get("status") not in ("failed", "interrupted")
    return is_answered or _number(call, "input_tokens") + _number(call, "output_tokens") > 0


def _number(call: Mapping[str, Any], name: str) -> float:
    value = call.get(name)
    return float(value) if _is_amount(value) else 0.0


def _is_amount(value: object) -> TypeGuard[int | float]:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < _MOST


def _quantile(ordered: Sequence[float], share: float) -> float:
    """Return the smallest value with at least this share of all values at or below it."""
    if not ordered:
        return 0.0
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]

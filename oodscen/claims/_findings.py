"""Findings: verdicts on single claims, with the content of the scene that decides them."""

from collections.abc import Iterable
from typing import ClassVar, Literal

from oodscen.data._base import Data
from oodscen.data._claim import Claim

Status = Literal["holds", "fails", "open"]


class ClaimFinding(Data):
    """The verdict on one claim."""

    noun: ClassVar[str] = "finding"

    claim: Claim
    status: Status
    """`open` if neither the scene nor the catalogue decides the claim."""
    found: str
    """Description of the content of the scene."""
    path: str = ""
    """Path of the relevant part of the scene."""


def finding(claim: Claim, holds: bool | None, found: str, path: str) -> ClaimFinding:
    """Return the finding on a claim; `holds` is `None` if it cannot be decided."""
    statuses: dict[bool | None, Status] = {True: "holds", False: "fails", None: "open"}
    return ClaimFinding(claim=claim, status=statuses[holds], found=found, path=path)


def failures(findings: Iterable[ClaimFinding]) -> int:
    """Return the number of claims that fail."""
    return sum(finding.status == "fails" for finding in findings)

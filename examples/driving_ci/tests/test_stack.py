"""The stack in every scene of the study, and in its ordinary twin."""

from stack import Stack

from oodscen import Scene
from oodscen.pytest_plugin import Drive


def test_the_stack_is_safe(drive: Drive) -> None:
    assert drive(Stack).is_safe


def test_the_stack_drives_on_in_ordinary_traffic(drive: Drive, twin: Scene) -> None:
    driven = drive(Stack, twin)
    assert driven.is_safe
    assert not driven.is_needless
    assert driven.result.progress > 0.5

"""Part about the ego's motion: controls, grip and contacts, against the reference world."""

from typing import NamedTuple

import numpy as np

from oodscen.protocols import Control
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly, follow_lane
from oodscen.testing._kit.tracks import Tracks, run_both, start_fault, turned_by

_CONTROL = 0.2
"""Relative tolerance of the ego's change of speed and of heading under a constant control."""
_GRIP = 0.3
"""The same under controls that ask for more than the tyres can transmit."""
_SLIPPERY = 0.7
"""Highest friction at which controls that a dry road can take clearly exceed the grip."""
_LEAST_FRICTION = 0.3
"""Friction below which no road is tried."""
_SECONDS = 1.5
"""Length of a run under a constant control, s."""
_TALL_M = 0.5
"""Height above which an asset is surely met by the ego's body, m."""


def check_ego(probe: Probe) -> None:
    """Compare the ego's response to constant controls with the reference world's."""
    for name, speed, control in (
        ("braking at 5 m/s^2", 12.0, Control(-5.0)),
        ("accelerating at 2 m/s^2", 5.0, Control(2.0)),
        ("steering left by 0.05 rad", 8.0, Control(0.0, 0.05)),
        ("steering right by 0.05 rad", 8.0, Control(0.0, -0.05)),
    ):
        scene = probe.scene(speed=speed)
        tracks, reference = run_both(probe, scene, constantly(control), seconds=_SECONDS)
        fault = start_fault(tracks, reference, 0)
        probe.findings.expect(not fault, "ego", fault)
        change, expected = _change(tracks), _change(reference)
        probe.findings.expect(
            abs(change.speed - expected.speed) <= 0.3 + _CONTROL * abs(expected.speed),
            "ego",
            f"{name} changes its speed by {change.speed:.1f} m/s in {_SECONDS:g} s, not "
            f"{expected.speed:.1f}",
        )
        probe.findings.expect(
            abs(change.turn_deg - expected.turn_deg) <= 1.0 + _CONTROL * abs(expected.turn_deg),
            "ego",
            f"{name} turns it by {change.turn_deg:.1f} degrees in {_SECONDS:g} s, not "
            f"{expected.turn_deg:.1f}",
        )
        offset_m = float(np.linalg.norm(tracks.poses[-1, 0, :2] - reference.poses[-1, 0, :2]))
        probe.findings.expect(
            offset_m <= 1.5,
            "ego",
            f"{name} ends {offset_m:.1f} m from the reference after {_SECONDS:g} s",
        )


def check_grip(probe: Probe) -> None:
    """Compare hard braking and steering with the reference world's on a dry road and on a slippery one.

    That one has the catalogue's least friction, but not below `_LEAST_FRICTION`.

    Raises:
        NotApplicable: If no road is slippery, after the dry one was tried.
    """
    least = max(_LEAST_FRICTION, probe.catalogue.weather.min_friction)
    frictions = (1.0, least) if least <= _SLIPPERY else (1.0,)
    for friction in frictions:
        weather = probe.clear.model_copy(update={"friction": friction})
        for name, speed, control in (
            ("braking", 24.0, Control(-20.0)),
            ("steering", 14.0, Control(0.0, 0.1 if friction < 1.0 else 0.3)),
        ):
            scene = probe.scene(speed=speed, weather=weather)
            tracks, reference = run_both(probe, scene, constantly(control), seconds=_SECONDS)
            change, expected = _change(tracks), _change(reference)
            speed_tolerance = 0.5 + _GRIP * abs(expected.speed)
            turn_tolerance_deg = 3.0 + _GRIP * abs(expected.turn_deg)
            probe.findings.expect(
                abs(change.speed - expected.speed) <= speed_tolerance
                and abs(change.turn_deg - expected.turn_deg) <= turn_tolerance_deg,
                "ego",
                f"{name} at friction {friction:g} changes its speed by {change.speed:.1f} m/s and turns "
                f"it by {change.turn_deg:.1f} degrees in {_SECONDS:g} s, not {expected.speed:.1f} and "
                f"{expected.turn_deg:.1f}",
            )
    if least > _SLIPPERY:
        raise NotApplicable(
            f"no slippery road: the catalogue's least friction is over {_SLIPPERY:g}"
        )


class _Change(NamedTuple):
    """A change of the ego's motion over a run."""

    speed: float
    """m/s"""
    turn_deg: float


def _change(tracks: Tracks) -> _Change:
    speeds, headings = tracks.speeds[:, 0], tracks.poses[:, 0, 3]
    return _Change(
        float(speeds[-1] - speeds[0]), turned_by(float(headings[-1]), float(headings[0]))
    )


def check_contact(probe: Probe) -> None:
    """Check that bodies keep moving after a contact, and that the contact is in the state.

    Raises:
        NotApplicable: If no asset of the catalogue blocks the way.
    """
    solid = [asset for asset in probe.catalogue.assets if not asset.is_passable()]
    if not solid:
        raise NotApplicable("no asset blocks the way")
    box = next((asset for asset in solid if asset.height > _TALL_M), solid[0])
    scene = probe.scene(probe.still(box, ahead=15.0), speed=8.0)
    states = probe.run(scene, follow_lane, steps=round(3.0 / probe.simulator.dt))
    is_touched = any(state.contacts for state in states)
    probe.findings.expect(is_touched, "ego", f"drives through a {box.id} without a contact")
    covered_m = float(np.linalg.norm(states[-1].poses[0, :2] - states[0].poses[0, :2]))
    message = (
        f"covers {covered_m:.0f} m through a {box.id} in 3 s at 8 m/s: a contact must not stop it"
    )
    probe.findings.expect(covered_m > 18.0, "ego", message)

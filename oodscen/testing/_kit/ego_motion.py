"""Part about the ego's motion: controls, grip and contacts, against the reference world."""

import numpy as np

from oodscen.protocols import Control
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.samples import constantly, follow_lane
from oodscen.testing._kit.tracks import run_both, start_fault, turned_by

CONTROL = 0.2
"""Relative tolerance of the ego's change of speed and of heading under a constant control."""
GRIP = 0.3
"""The same under controls that ask for more than the tyres can transmit."""
_SLIPPERY = 0.7
"""Greatest friction at which a control is far beyond the grip that is well within it on a dry road."""


def check_ego(probe: Probe) -> None:
    """Compare the ego's response to constant controls with the reference world's."""
    for name, speed, control in (
        ("braking at 5 m/s^2", 12.0, Control(-5.0)),
        ("accelerating at 2 m/s^2", 5.0, Control(2.0)),
        ("steering left by 0.05 rad", 8.0, Control(0.0, 0.05)),
        ("steering right by 0.05 rad", 8.0, Control(0.0, -0.05)),
    ):
        scene = probe.scene(speed=speed)
        tracks, other = run_both(probe, scene, constantly(control), seconds=1.5)
        fault = start_fault(tracks, other, 0)
        probe.findings.expect(not fault, "ego", fault)
        told, wanted = (float(t.speeds[-1, 0] - t.speeds[0, 0]) for t in (tracks, other))
        if not abs(told - wanted) <= 0.3 + CONTROL * abs(wanted):
            message = f"{name} changes its speed by {told:.1f} m/s in 1.5 s, not {wanted:.1f}"
            probe.findings.add("ego", message)
        told, wanted = (turned_by(*t.poses[[-1, 0], 0, 3]) for t in (tracks, other))
        if not abs(told - wanted) <= 1.0 + CONTROL * abs(wanted):
            message = f"{name} turns it by {told:.1f} degrees in 1.5 s, not {wanted:.1f}"
            probe.findings.add("ego", message)
        apart = float(np.linalg.norm(tracks.poses[-1, 0, :2] - other.poses[-1, 0, :2]))
        probe.findings.expect(
            apart <= 1.5, "ego", f"{name} ends {apart:.1f} m from the reference after 1.5 s"
        )


def check_grip(probe: Probe) -> None:
    """Compare hard braking and steering with the reference world's, on a dry road and on the most slippery one."""
    least = max(0.3, probe.catalogue.weather.min_friction)
    for friction in (1.0, least) if least <= _SLIPPERY else (1.0,):
        weather = probe.clear.model_copy(update={"friction": friction})
        for name, speed, control in (
            ("braking", 24.0, Control(-20.0)),
            ("steering", 14.0, Control(0.0, 0.1 if friction < 1.0 else 0.3)),
        ):
            scene = probe.scene(speed=speed, weather=weather)
            tracks, other = run_both(probe, scene, constantly(control), seconds=1.5)
            told, wanted = (float(t.speeds[-1, 0] - t.speeds[0, 0]) for t in (tracks, other))
            turned, turning = (turned_by(*t.poses[[-1, 0], 0, 3]) for t in (tracks, other))
            is_like = abs(told - wanted) <= 0.5 + GRIP * abs(wanted)
            is_like &= abs(turned - turning) <= 3.0 + GRIP * abs(turning)
            message = f"{name} at friction {friction:g} does not stay within the grip"
            probe.findings.expect(is_like, "ego", message)
    if least > _SLIPPERY:
        raise NotApplicable("no slippery road: the catalogue's least friction is over 0.7")


def check_contact(probe: Probe) -> None:
    """Check that bodies keep moving after a contact, and that the contact is in the state."""
    box = max(
        probe.catalogue.assets, key=lambda asset: (not asset.is_passable(), asset.height > 0.5)
    )
    scene = probe.scene(probe.still(box, ahead=15.0), speed=8.0)
    states = probe.run(scene, follow_lane, steps=round(3.0 / probe.simulator.dt))
    touched = [state.step for state in states if state.contacts]
    probe.findings.expect(touched, "ego", f"drives through a {box.id} without a contact")
    way = float(np.linalg.norm(states[-1].poses[0, :2] - states[0].poses[0, :2]))
    message = f"covers {way:.0f} m through a {box.id} in 3 s at 8 m/s: a contact must not stop it"
    probe.findings.expect(way > 18.0, "ego", message)

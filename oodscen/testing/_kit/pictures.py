"""Part about pictures: colours, ids and depth agree with each other, with the state and with the camera."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from oodscen.protocols import Control
from oodscen.testing._kit.cameras import check_cameras
from oodscen.testing._kit.colours import CHANGED, check_colours, check_turning
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.following import check_following
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.shapes import frame_faults


def check_frames(probe: Probe) -> None:
    """Check shapes, types and visible content, and that the largest asset is shown."""
    largest = max(probe.catalogue.assets, key=lambda asset: asset.width * asset.height)
    scene = probe.scene(probe.still(largest, ahead=20.0))
    probe.simulator.reset(scene, 0)
    pictures: list[tuple[NDArray[np.uint8], bytes]] = []
    for camera in (probe.camera(), probe.camera(64, 64)):
        frame = probe.simulator.render(camera)
        pictures.append((frame.rgb, frame.rgb.tobytes()))
        for fault in frame_faults(frame, camera, 2):
            probe.findings.add("", fault)
        is_shown = bool((frame.ids == 2).any())
        probe.findings.expect(is_shown, f"asset {largest.id}", "20 m ahead has no pixel with id 2")
    for _ in range(round(1.0 / probe.simulator.dt)):
        probe.simulator.step(Control())
    probe.simulator.render(probe.camera())
    is_kept = all(rgb.tobytes() == before for rgb, before in pictures)
    probe.findings.expect(is_kept, "", "a later render changed an earlier frame")


def check_pictures(probe: Probe) -> None:
    """Check pictures against ids, depth, state and the camera's parameters."""
    for name, check in (
        ("cameras", check_cameras),
        ("following", check_following),
        ("colours", check_colours),
        ("turning", check_turning),
        ("order", _check_order),
        ("leftovers", _check_leftovers),
        ("rendering", _check_rendering),
    ):
        with probe.findings.trying(name), suppress(NotApplicable):
            check(probe)


def _check_order(probe: Probe) -> None:
    """Check that the nearer of two bodies hides the other."""
    if probe.is_top:
        raise NotApplicable("nothing is behind anything from above")
    asset = probe.box_like
    ahead_m = 10.0 + 0.5 * asset.length
    scene = probe.scene(
        probe.still(asset, id="far", ahead=ahead_m + asset.length + 8.0),
        probe.still(asset, id="near", ahead=ahead_m),
    )
    probe.simulator.reset(scene, 0)
    # Level and as low as the body's middle, so that its box hides all of the other's.
    camera = replace(probe.camera(240, 180), z=0.5 * asset.height, pitch_deg=0.0)
    frame = probe.simulator.render(camera)
    far_px, near_px = (int((frame.ids == row).sum()) for row in (2, 3))
    probe.findings.expect(
        far_px <= 0.35 * near_px,
        "",
        f"a hidden body shows {far_px} pixels, the one before it {near_px}",
    )
    if frame.unhidden is not None:
        unhidden_px = int(frame.unhidden[1])
        probe.findings.expect(
            unhidden_px > far_px or far_px > 0.3 * near_px,
            "",
            f"unhidden counts {unhidden_px} pixels of a hidden body, of which {far_px} show",
        )


def _check_leftovers(probe: Probe) -> None:
    """Check that a scene leaves nothing behind."""
    camera, empty = probe.camera(), probe.scene()
    probe.simulator.reset(empty, 0)
    before = probe.simulator.render(camera)
    probe.simulator.reset(probe.scene(probe.still(probe.box_like, ahead=14.0)), 0)
    probe.simulator.render(camera)
    probe.simulator.reset(empty, 0)
    after = probe.simulator.render(camera)
    pixels = int((after.ids > 1).sum())
    probe.findings.expect(
        pixels == 0, "", f"{pixels} pixels of a body of the scene before are shown"
    )
    difference = np.abs(after.rgb.astype(np.int16) - before.rgb.astype(np.int16)).max(axis=2)
    changed = float((difference >= 2 * CHANGED).mean())
    probe.findings.expect(changed < 0.02, "", f"{changed:.0%} of the picture show the scene before")


def _check_rendering(probe: Probe) -> None:
    """Check that rendering does not change the run."""
    scene = probe.scenes[0]
    runs = []
    for renders in (False, True):
        state = probe.simulator.reset(scene, 0)
        fingerprints = [state.fingerprint()]
        for step in range(12):
            if renders and step % 4 == 0:
                probe.simulator.render(probe.camera(64, 48))
                probe.simulator.observe()
            fingerprints.append(probe.simulator.step(Control(0.0, 0.01)).fingerprint())
        runs.append(fingerprints)
    probe.findings.expect(runs[0] == runs[1], "", "rendering changes the run")

"""Checks that pictures follow the camera's parameters."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from oodscen.driving._flat_frame import tangents
from oodscen.driving._sight.outlines import area, clipped
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.driving._sight.visibility import Eye
from oodscen.protocols import Camera, Control, Frame
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.shapes import place_faults

_DEPTH = 0.06
"""Relative tolerance of the ground's depth."""
_LEAST_SHARE = 0.75
"""Least share of the road's pixels whose depth must be within the tolerance."""
_SAMPLES = 400
"""Number of pixels whose place on the road is looked up."""
_LEAST_SAMPLES = 20
"""Fewest pixels of the road that are compared."""
_FARTHEST_M = 45.0
"""Depth beyond the camera's height up to which the road is compared, m."""
_LEAST_FALL = 1e-3
"""Least fall of a pixel's ray by which the height is divided; the ground that it meets is too far to be compared."""


def check_cameras(probe: Probe) -> None:
    """Check that bodies and ground appear where the camera's parameters put them, also after some steps."""
    box = probe.box_like
    scene = probe.scene(
        probe.still(box, id="near", ahead=16.0, offset=3.2, heading=20.0),
        probe.still(box, id="far", ahead=26.0, offset=-2.8),
        speed=6.0,
    )
    state = probe.simulator.reset(scene, 0)
    cast = bodies(scene, probe.catalogue, state.poses)
    for name, camera in _varied_cameras(probe).items():
        frame = probe.simulator.render(camera)
        faults = place_faults(frame, camera, cast) + _ground_faults(probe, frame, camera, cast)
        for fault in faults:
            probe.findings.add(name, fault)
    for _ in range(round(1.0 / probe.simulator.dt)):
        state = probe.simulator.step(Control(0.0, 0.04))
    camera = probe.camera(240, 180)
    cast = bodies(scene, probe.catalogue, state.poses)
    for fault in place_faults(probe.simulator.render(camera), camera, cast):
        probe.findings.add("after a second", fault)


def _ground_faults(
    probe: Probe, frame: Frame, camera: Camera, cast: Sequence[PlacedBody]
) -> list[str]:
    """Compare the depth of the road with that of a plane, along the optical axis."""
    eye = Eye(camera, cast[0].solid)
    u, v = tangents(camera)
    fall = eye.forward[2] + v[:, None] * eye.down[2] + u[None, :] * eye.right[2]
    expected = camera.z / np.maximum(-fall, _LEAST_FALL)
    is_near = (expected < _FARTHEST_M + camera.z) & (frame.ids == 0)
    stride = max(1, int(is_near.sum()) // _SAMPLES)
    rows, columns = (indices[::stride] for indices in np.nonzero(is_near))
    depths = expected[rows, columns]
    x = eye.place[0] + depths * (eye.forward[0] + u[columns] * eye.right[0] + v[rows] * eye.down[0])
    y = eye.place[1] + depths * (eye.forward[1] + u[columns] * eye.right[1] + v[rows] * eye.down[1])
    road = probe.staged(probe.scene()).corridor
    is_road = [
        road.strip_at(*road.locate(*point, float(road.start + 20.0))) in road.driving
        for point in zip(x.tolist(), y.tolist(), strict=True)
    ]
    rows, columns, depths = rows[is_road], columns[is_road], depths[is_road]
    if len(rows) < _LEAST_SAMPLES:
        return []
    shown = frame.depth[rows, columns]
    errors = np.abs(shown / depths - 1.0)
    if float((errors <= _DEPTH).mean()) >= _LEAST_SHARE:
        return []
    median = int(np.argsort(errors)[len(errors) // 2])
    return [f"gives the road a depth of {shown[median]:.1f} m, not {depths[median]:.1f}"]


def check_turned_cameras(probe: Probe) -> None:
    """Check that a camera that is turned shows the bodies beside and behind the ego, and only those it looks at.

    Raises:
        NotApplicable: If the simulator sees from above only.
    """
    if probe.is_top:
        raise NotApplicable("the simulator sees from above only, so its camera cannot turn")
    box = probe.box_like
    scene = probe.scene(
        probe.still(box, id="beside", ahead=1.0, offset=5.0, heading=20.0),
        probe.still(box, id="behind", ahead=-16.0, offset=2.8),
    )
    state = probe.simulator.reset(scene, 0)
    cast = bodies(scene, probe.catalogue, state.poses)
    plain = replace(probe.camera(240, 180), fov_deg=90.0)
    for turn_deg in (90.0, 180.0, -90.0):
        camera = plain.behind() if turn_deg == 180.0 else replace(plain, yaw_deg=turn_deg)
        frame, subject = probe.simulator.render(camera), f"camera turned by {turn_deg:g} degrees"
        for fault in place_faults(frame, camera, cast):
            probe.findings.add(subject, fault)
        eye = Eye(camera, cast[0].solid)
        for row, body in enumerate(cast[1:], start=2):
            outline = eye.silhouette(body.solid)
            if not area(clipped(outline, camera.width, camera.height)) and (frame.ids == row).any():
                probe.findings.add(subject, f"shows {body.id!r}, which is not where it looks")


def _varied_cameras(probe: Probe) -> dict[str, Camera]:
    """Return cameras that differ from the plain one in one parameter each."""
    plain = probe.camera(240, 180)
    varied = {
        "the plain camera": plain,
        "camera with another size": replace(plain, width=200, height=240),
        "camera with another field of view": replace(plain, fov_deg=90.0),
        "camera with another height": replace(plain, z=plain.z + (30.0 if probe.is_top else 1.6)),
        "camera with a place further ahead": replace(plain, x=plain.x + 4.0),
        "camera with a place to the left": replace(plain, y=1.5),
    }
    if not probe.is_top:
        varied["camera with another pitch"] = replace(plain, pitch_deg=plain.pitch_deg + 10.0)
    return varied

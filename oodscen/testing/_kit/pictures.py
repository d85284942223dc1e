"""Part about pictures: colours, ids and depth agree with each other, with the state and with the camera."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Asset
from oodscen.data._scene import Scene
from oodscen.driving._flat_frame import tangents
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.driving._sight.visibility import Eye, area, clipped
from oodscen.protocols import Camera, Control, Frame
from oodscen.testing._kit.findings import NotApplicable
from oodscen.testing._kit.following import check_following
from oodscen.testing._kit.probe import Probe
from oodscen.testing._kit.shapes import LEAST_PX, frame_faults, place_faults

DEPTH = 0.06
"""Relative tolerance of the ground's depth."""
CHANGED = 12
"""Difference of a colour that counts as a change, of 255."""
CONTRAST = 12.0
"""Least distance between the mean colours of a body and of the road, of 441."""


def check_frames(probe: Probe) -> None:
    """Check shapes, types and visible content, and that the tallest asset appears where it stands."""
    size = max(probe.catalogue.assets, key=lambda asset: asset.width * asset.height)
    scene = probe.scene(probe.still(size, ahead=20.0))
    probe.simulator.reset(scene, 0)
    kept: list[tuple[NDArray[np.uint8], bytes]] = []
    for camera in (probe.camera(), probe.camera(64, 64)):
        frame = probe.simulator.render(camera)
        kept.append((frame.rgb, frame.rgb.tobytes()))
        for fault in frame_faults(frame, camera, 2):
            probe.findings.add("", fault)
        is_shown = bool((frame.ids == 2).any())
        probe.findings.expect(is_shown, f"asset {size.id}", "20 m ahead has no pixel with id 2")
    for _ in range(round(1.0 / probe.simulator.dt)):
        probe.simulator.step(Control())
    probe.simulator.render(probe.camera())
    is_kept = all(rgb.tobytes() == before for rgb, before in kept)
    probe.findings.expect(is_kept, "", "a later render changed an earlier frame")


def check_pictures(probe: Probe) -> None:
    """Check pictures against ids, depth, state and the camera's parameters."""
    for part in (
        _check_cameras,
        check_following,
        _check_colours,
        _check_roads,
        _check_order,
        _check_leftovers,
        _check_rendering,
    ):
        with probe.findings.trying(part.__name__.removeprefix("_").removeprefix("check_")):
            try:
                part(probe)
            except NotApplicable:
                continue


def check_turning(probe: Probe) -> None:
    """Check that a camera that is turned shows the bodies beside and behind the ego where it looks."""
    if probe.is_top:
        raise NotApplicable("the simulator sees from above only, so its camera cannot turn")
    box = _box(probe)
    scene = probe.scene(
        probe.still(box, id="beside", ahead=1.0, offset=5.0, heading=20.0),
        probe.still(box, id="behind", ahead=-16.0, offset=2.8),
    )
    state = probe.simulator.reset(scene, 0)
    cast = bodies(scene, probe.catalogue, state.poses)
    plain = replace(probe.camera(240, 180), fov_deg=90.0)
    for turn in (90.0, 180.0, -90.0):
        camera = plain.behind() if turn == 180.0 else replace(plain, yaw_deg=turn)
        frame = probe.simulator.render(camera)
        for fault in place_faults(frame, camera, cast):
            probe.findings.add(f"camera turned by {turn:g} degrees", fault)
        for row, body in enumerate(cast[1:], start=2):
            outline = Eye(camera, cast[0].solid).silhouette(body.solid)
            if not area(clipped(outline, camera.width, camera.height)) and (frame.ids == row).any():
                fault = f"shows {body.id!r}, which is not where it looks"
                probe.findings.add(f"camera turned by {turn:g} degrees", fault)


def cameras(probe: Probe) -> dict[str, Camera]:
    """Return cameras that differ from the plain one in one parameter each."""
    plain = probe.camera(240, 180)
    varied = {
        "the plain camera": plain,
        "another size": replace(plain, width=200, height=240),
        "another field of view": replace(plain, fov_deg=90.0),
        "another height": replace(plain, z=plain.z + (30.0 if probe.is_top else 1.6)),
        "a place further ahead": replace(plain, x=plain.x + 4.0),
        "a place to the left": replace(plain, y=1.5),
    }
    if not probe.is_top:
        varied["another pitch"] = replace(plain, pitch_deg=plain.pitch_deg + 10.0)
    return varied


def _box(probe: Probe) -> Asset:
    """Return an asset whose shape is nearly its box."""
    return probe.asset_for("vehicle", "object", "work_zone")


def _check_cameras(probe: Probe) -> None:
    """Check that bodies and ground appear where the camera's parameters put them, also after some steps."""
    box = _box(probe)
    scene = probe.scene(
        probe.still(box, id="near", ahead=16.0, offset=3.2, heading=20.0),
        probe.still(box, id="far", ahead=26.0, offset=-2.8),
        speed=6.0,
    )
    state = probe.simulator.reset(scene, 0)
    for name, camera in cameras(probe).items():
        frame = probe.simulator.render(camera)
        cast = bodies(scene, probe.catalogue, state.poses)
        for fault in [
            *place_faults(frame, camera, cast),
            *_ground_faults(probe, frame, camera, cast),
        ]:
            probe.findings.add(f"camera with {name}" if name != "the plain camera" else name, fault)
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
    with np.errstate(divide="ignore"):
        wanted = np.where(fall < -1e-3, -camera.z / fall, np.inf)
    x = eye.place[0] + wanted * (eye.forward[0] + u * eye.right[0] + v[:, None] * eye.down[0])
    y = eye.place[1] + wanted * (eye.forward[1] + u * eye.right[1] + v[:, None] * eye.down[1])
    near = (wanted < 45.0 + camera.z) & (frame.ids == 0)
    if near.sum() < 100:
        return []
    rows, columns = (places[:: max(1, len(places) // 400)] for places in np.nonzero(near))
    road = probe.staged(probe.scene()).corridor
    on_road = [
        road.strip_at(*road.locate(float(x[r, c]), float(y[r, c]), float(road.start + 20.0)))
        in road.driving
        for r, c in zip(rows, columns, strict=True)
    ]
    rows, columns = rows[on_road], columns[on_road]
    if len(rows) < 20:
        return []
    off = np.abs(frame.depth[rows, columns] / wanted[rows, columns] - 1.0)
    if float((off <= DEPTH).mean()) < 0.75:
        row = int(np.argsort(off)[len(off) // 2])
        told, right = (one[rows[row], columns[row]] for one in (frame.depth, wanted))
        return [f"gives the road a depth of {told:.1f} m, not {right:.1f}"]
    return []


# ------------------------------------------------------------------ colours


def _check_colours(probe: Probe) -> None:
    """Check that the picture changes where a body is, and that bodies differ from the road."""
    camera = probe.camera(240, 180)
    probe.simulator.reset(probe.scene(), 0)
    empty = probe.simulator.render(camera)
    tried, dull = 0, []
    for index, asset in enumerate(_telling(probe)):
        ahead = 12.0 + 0.5 * asset.length
        probe.simulator.reset(
            probe.scene(probe.still(asset, ahead=ahead, offset=2.2 if index % 2 else -2.2)), 0
        )
        frame = probe.simulator.render(camera)
        mask = frame.ids == 2
        if mask.sum() < LEAST_PX:
            continue
        tried += 1
        difference = np.abs(frame.rgb.astype(np.int16) - empty.rgb.astype(np.int16)).max(axis=2)
        changed = difference >= CHANGED
        inside, outside = float(changed[mask].mean()), float(changed[~mask].mean())
        if inside < 0.4 or inside < 1.5 * outside:
            what = (
                f"the picture changes in {inside:.0%} of its pixels and {outside:.0%} of the others"
            )
            probe.findings.add(f"asset {asset.id}", what)
        ground = frame.rgb[_road_pixels(probe, camera)].astype(np.float64)
        if len(ground):
            away = float(np.linalg.norm(frame.rgb[mask].mean(axis=0) - np.median(ground, axis=0)))
            if away < CONTRAST:
                dull.append(asset.id)
    if tried >= 2 and len(dull) > 0.5 * tried:
        probe.findings.add("", f"most bodies have the colour of the road: {', '.join(dull[:6])}")


def _telling(probe: Probe) -> list[Asset]:
    """Return up to six assets of different categories that are large enough to see."""
    firsts: dict[str, Asset] = {}
    for asset in probe.catalogue.assets:
        if asset.height > 0.4 and asset.width > 0.3:
            firsts.setdefault(asset.category, asset)
    return list(firsts.values())[:6]


def _road_pixels(probe: Probe, camera: Camera) -> tuple[slice, slice]:
    """Return a patch of the lane right in front of the ego."""
    if probe.is_top:
        low = int(0.60 * camera.height)
        return slice(low, low + 8), slice(camera.width // 2 - 4, camera.width // 2 + 4)
    return slice(int(0.8 * camera.height), int(0.92 * camera.height)), slice(
        int(0.42 * camera.width), int(0.58 * camera.width)
    )


def _check_roads(probe: Probe) -> None:
    """Check that the picture turns with the ego."""
    camera = probe.camera()
    probe.simulator.reset(probe.scene(speed=8.0), 0)
    first = probe.simulator.render(camera).rgb.astype(np.int16)
    for _ in range(round(2.0 / probe.simulator.dt)):
        probe.simulator.step(Control(0.0, 0.1))
    last = probe.simulator.render(camera).rgb.astype(np.int16)
    change = float(np.abs(last - first).mean())
    probe.findings.expect(change > 1.0, "", "the picture does not change while the ego turns away")


# ------------------------------------------------------------------ order, leftovers, side effects


def _check_order(probe: Probe) -> None:
    """Check that the nearer of two bodies hides the other."""
    if probe.is_top:
        raise NotApplicable("nothing is behind anything from above")
    asset = _box(probe)
    near = 10.0 + 0.5 * asset.length
    scene = probe.scene(
        probe.still(asset, id="far", ahead=near + asset.length + 8.0),
        probe.still(asset, id="near", ahead=near),
    )
    probe.simulator.reset(scene, 0)
    # Level and as low as the body's middle, so that its box hides all of the other's.
    camera = replace(probe.camera(240, 180), z=0.5 * asset.height, pitch_deg=0.0)
    frame = probe.simulator.render(camera)
    far, close = (int((frame.ids == row).sum()) for row in (2, 3))
    is_hidden = far <= 0.35 * close
    probe.findings.expect(
        is_hidden, "", f"a hidden body shows {far} pixels, the one before it {close}"
    )
    if frame.unhidden is not None:
        told = int(frame.unhidden[1])
        what = f"unhidden counts {told} pixels of a hidden body, of which {far} show"
        probe.findings.expect(told > far or far > 0.3 * close, "", what)


def _check_leftovers(probe: Probe) -> None:
    """Check that a scene leaves nothing behind."""
    camera, empty = probe.camera(), probe.scene()
    probe.simulator.reset(empty, 0)
    before = probe.simulator.render(camera)
    probe.simulator.reset(probe.scene(probe.still(_box(probe), ahead=14.0)), 0)
    probe.simulator.render(camera)
    probe.simulator.reset(empty, 0)
    after = probe.simulator.render(camera)
    left = int((after.ids > 1).sum())
    probe.findings.expect(left == 0, "", f"{left} pixels of a body of the scene before are shown")
    apart = np.abs(after.rgb.astype(np.int16) - before.rgb.astype(np.int16)).max(axis=2)
    changed = float((apart >= 2 * CHANGED).mean())
    probe.findings.expect(changed < 0.02, "", f"{changed:.0%} of the picture show the scene before")


def _check_rendering(probe: Probe) -> None:
    """Check that rendering does not change the run."""
    scene: Scene = probe.scenes[0]
    runs = []
    for renders in (False, True):
        state = probe.simulator.reset(scene, 0)
        prints = [state.fingerprint()]
        for step in range(12):
            if renders and step % 4 == 0:
                probe.simulator.render(probe.camera(64, 48))
                probe.simulator.observe()
            prints.append(probe.simulator.step(Control(0.0, 0.01)).fingerprint())
        runs.append(prints)
    probe.findings.expect(runs[0] == runs[1], "", "rendering changes the run")

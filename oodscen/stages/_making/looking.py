"""Pictures of things made to order, and what they show of shape and size."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from oodscen.data._base import Data
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._designs.prop import Prop, check_prop
from oodscen.data._detail_checks import check_details
from oodscen.data._details import DetailKinds, Details, PoseKind
from oodscen.data._scene import Actor, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._base_simulator import render_checked
from oodscen.errors import SceneError
from oodscen.protocols import Camera, Frame, Simulator

DISTANCES_M = (10.0, 15.0, 30.0)
"""Distances between the camera and the near side of a thing, m."""
JUDGED_M = 15.0
"""The distance at which a thing must be large enough."""
LEAST_PX = 150
"""Fewest pixels of a thing that can be recognised there, in a picture of 640 x 480."""
LEAST_CONTRAST = 20.0
"""Least mean difference from the same view without it, of 255."""
UNSEEN = "not shown to be recognised"
"""The verdict on a thing that only its author has named."""
NIGHT = Weather(sun_elevation_deg=-30.0)

_LANE_SEEN = ("residential_two_lane", "urban_three_lane", "highway")
"""Maps on which things are shown, the first that a catalogue has."""
_TOWARDS_DEG, _ASIDE_DEG, _AWAY_DEG = 158.0, 115.0, 22.0
"""Headings at which gestures, lasting poses and animals, and the rear of a vehicle are recognised best."""

_FIRST_ACTOR = 2
"""The value of the first actor in `Frame.ids`."""

Pixels = NDArray[np.uint8]


class PropView(Data):
    """The size of a thing in one picture."""

    noun: ClassVar[str] = "view of a prop"

    distance_m: float
    is_night: bool
    pixels: int
    contrast: float
    """Mean difference from the same view without it, of 255."""


class PropLook(Data):
    """The sizes of a thing in its pictures, and its faults."""

    noun: ClassVar[str] = "look of a prop"

    id: str
    views: tuple[PropView, ...]
    faults: tuple[str, ...] = ()
    recognised: str = UNSEEN
    taken_for: str = ""
    """The words of a vision model that did not name it."""


@dataclass(frozen=True, eq=False)
class ShownProp:
    """A thing with its pictures, by day and by night at every distance."""

    look: PropLook
    pictures: tuple[Pixels, ...]

    def with_verdict(self, recognised: str, taken_for: str) -> "ShownProp":
        """Return the same pictures with the verdict of a vision model."""
        look = self.look.model_copy(update={"recognised": recognised, "taken_for": taken_for})
        return ShownProp(look, self.pictures)


def look_at(
    props: Iterable[Prop], simulator: Simulator, *, camera: Camera | None = None
) -> Iterator[ShownProp]:
    """Show things one by one on an empty road: animals aside, as they cross, and others from behind.

    Raises:
        SceneError: When the simulator refuses a design.
    """
    catalogue = simulator.catalogue()

    def exhibits() -> Iterator[_Exhibit]:
        for prop in props:
            faults = check_prop(prop, catalogue.assets)
            if faults:
                raise SceneError(prop.id, faults)
            turn = _ASIDE_DEG if prop.category == "animal" else 0.0
            yield _Exhibit(prop.id, prop.id, heading_deg=turn, made=(prop,))

    return _shown_props(exhibits(), simulator, camera or Camera())


def look_at_details(simulator: Simulator, *, camera: Camera | None = None) -> Iterator[ShownProp]:
    """Show every pose of people and every state of vehicles' parts, each on the first asset that has it.

    Yields:
        One value per pose and per part, in the catalogue's order; none if the catalogue has none.
    """
    return _shown_props(_details(simulator.catalogue()), simulator, camera or Camera())


@dataclass(frozen=True)
class _Exhibit:
    """One thing to be shown, facing the camera's way by default."""

    name: str
    asset: str
    details: Details | None = None
    heading_deg: float = 0.0
    state: str = ""
    made: tuple[Prop, ...] = ()


def _details(catalogue: Catalogue) -> Iterator[_Exhibit]:
    kinds = catalogue.details or DetailKinds()
    for pose in kinds.poses:
        for asset in catalogue.assets:
            if asset.offers and pose.id in asset.offers.poses:
                turn = _ASIDE_DEG if pose.is_aside else _TOWARDS_DEG
                held = _fitting(catalogue, asset, pose) if pose.grip else ""
                yield _Exhibit(pose.id, asset.id, Details(pose=pose.id, holds=held), turn)
                break
    for part in kinds.parts:
        for asset in catalogue.assets:
            if asset.offers and part.id in asset.offers.parts:
                turn = _TOWARDS_DEG if part.is_ahead else _AWAY_DEG
                # A standing vehicle has its lamps on only if a state says so.
                state = "brake" if part.is_ahead and "brake" in asset.states else ""
                yield _Exhibit(part.id, asset.id, Details(parts=(part.id,)), turn, state)
                break


def _fitting(catalogue: Catalogue, asset: Asset, pose: PoseKind) -> str:
    """Return the id of what a person is shown with: small in one hand, long in both, empty if nothing fits."""
    assets = {asset.id: asset for asset in catalogue.assets}
    kinds = catalogue.details or DetailKinds()
    by_length = [
        (max(thing.length, thing.width), name)
        for name, thing in assets.items()
        if not check_details(Details(pose=pose.id, holds=name), asset, "stand", assets, kinds, {})
    ]
    is_single = pose.grip is not None and pose.grip.how == "beside"
    choose = min if is_single else max
    return choose(by_length, default=(0.0, ""))[1]


def _shown_props(
    exhibits: Iterable[_Exhibit], simulator: Simulator, camera: Camera
) -> Iterator[ShownProp]:
    catalogue = simulator.catalogue()
    without = {
        is_night: _frame(simulator, catalogue, None, 0.0, is_night, camera)
        for is_night in (False, True)
    }
    for exhibit in exhibits:
        views, pictures = [], []
        for is_night in (False, True):
            for distance in DISTANCES_M:
                frame = _frame(simulator, catalogue, exhibit, distance, is_night, camera)
                views.append(_view(frame, without[is_night], distance, is_night))
                pictures.append(frame.rgb)
        look = PropLook(id=exhibit.name, views=tuple(views), faults=tuple(_faults(views, camera)))
        yield ShownProp(look, tuple(pictures))


def _frame(
    simulator: Simulator,
    catalogue: Catalogue,
    exhibit: _Exhibit | None,
    distance_m: float,
    is_night: bool,
    camera: Camera,
) -> Frame:
    """Return the picture of an exhibit before the camera, or of the empty road."""
    roads = {road.id for road in catalogue.maps}
    road = next((name for name in _LANE_SEEN if name in roads), catalogue.maps[0].id)
    actors: tuple[Actor, ...] = ()
    if exhibit is not None:
        half = catalogue.with_made(exhibit.made).asset(exhibit.asset).length / 2
        ahead_m = round(camera.x + distance_m + half, 2)
        actors = (
            Actor(
                id="prop",
                asset=exhibit.asset,
                placement=Placement(ahead_m=ahead_m, heading_deg=exhibit.heading_deg),
                state=exhibit.state,
                details=exhibit.details,
            ),
        )
    scene = Scene(
        id="prop",
        scenario_id="prop",
        map=road,
        ego=Ego(speed=0.0),
        weather=NIGHT if is_night else Weather(),
        actors=actors,
        hazard=Hazard(actors=dict.fromkeys(actor.id for actor in actors), weather=Weather()),
        decision=Trigger(kind="time", value=1.0),
        made=() if exhibit is None else exhibit.made,
    )
    state = simulator.reset(scene, 0)
    return render_checked(simulator, camera, len(state.ids))


def _view(frame: Frame, without: Frame, distance_m: float, is_night: bool) -> PropView:
    is_thing = frame.ids == _FIRST_ACTOR
    pixels = int(np.count_nonzero(is_thing))
    differences = np.abs(frame.rgb.astype(np.int16) - without.rgb.astype(np.int16)).max(axis=2)
    of_thing = differences[is_thing]
    if frame.unhidden is not None:
        pixels = max(pixels, int(frame.unhidden[1]))
        if len(of_thing) * 2 <= pixels:  # What is half transparent has few pixels of its own.
            of_thing = np.sort(differences, axis=None)[-max(1, pixels) :]
    contrast = round(float(of_thing.mean()), 1) if len(of_thing) else 0.0
    return PropView(distance_m=distance_m, is_night=is_night, pixels=pixels, contrast=contrast)


def _faults(views: Sequence[PropView], camera: Camera) -> Iterator[str]:
    least = LEAST_PX * camera.width * camera.height / (640 * 480)
    (judged,) = (view for view in views if view.distance_m == JUDGED_M and not view.is_night)
    if judged.pixels < least:
        yield f"{judged.pixels} pixels at {JUDGED_M:g} m, and {least:.0f} can be recognised"
    if judged.contrast < LEAST_CONTRAST:
        yield f"differs from the bare road by {judged.contrast:g} of 255, at least {LEAST_CONTRAST:g}"

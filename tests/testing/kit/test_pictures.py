"""Pictures that contradict their camera, their colours or their scene are found."""

from dataclasses import replace

import numpy as np
import pytest

from oodscen.protocols import Control
from oodscen.testing._check import examine_parts
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

CATALOGUE = FLAT_CATALOGUE.model_copy(
    update={
        "assets": tuple(map(FLAT_CATALOGUE.asset, ("car", "cyclist", "adult"))),
        "behaviours": FLAT_CATALOGUE.behaviours[:2],
        "maps": (FLAT_CATALOGUE.map("urban_avenue"),),
    }
)


class Few(FlatSimulator):
    """Has few assets and one map, so that the check is quick."""

    def catalogue(self):
        return CATALOGUE


def lines(simulator: type, part: str = "pictures") -> list[str]:
    result, _ = examine_parts(simulator, parts=(part,))
    return result.lines()


@pytest.mark.parametrize("part", ["pictures", "turning", "frames"])
def test_sound_pictures_pass(part) -> None:
    assert lines(Few, part) == []


class Greyed(Few):
    """Draws bodies in the colour of the road."""

    def draw(self, camera):
        frame = super().draw(camera)
        rgb = frame.rgb.copy()
        rows, columns = int(0.85 * camera.height), int(0.5 * camera.width)
        rgb[frame.ids > 1] = rgb[rows, columns]
        return replace(frame, rgb=rgb)


class Painted(Few):
    """Always draws the same colours."""

    def draw(self, camera):
        frame = super().draw(camera)
        ramp = np.linspace(0.0, 250.0, frame.rgb.size).reshape(frame.rgb.shape)
        return replace(frame, rgb=ramp.astype(np.uint8))


class Straight(Few):
    """Draws every drive as one that goes straight on."""

    def step(self, control):
        return super().step(Control(control.acceleration, 0.0))


class Transparent(Few):
    """Draws the far body over the near one."""

    def draw(self, camera):
        frame = super().draw(camera)
        return replace(frame, ids=np.where(frame.ids == 3, 2, frame.ids))


class Miscounts(Few):
    """Counts no pixel of a hidden body."""

    def draw(self, camera):
        frame = super().draw(camera)
        visible = np.bincount(frame.ids.ravel(), minlength=len(self._assets) + 1)[1:]
        return replace(frame, unhidden=visible.astype(np.int32))


class Leaves(Few):
    """Shows the scene before, too."""

    before = None

    def load(self, corridor, scene, seed):
        self.before = self._last if hasattr(self, "_last") else None
        super().load(corridor, scene, seed)

    def draw(self, camera):
        frame = super().draw(camera)
        self._last = frame
        if self.before is not None and self.before.rgb.shape == frame.rgb.shape:
            shown = self.before.ids > 1
            rgb = np.where(shown[..., None], self.before.rgb, frame.rgb)
            return replace(frame, rgb=rgb)
        return frame


class Moves(Few):
    """Drives on while it renders."""

    def render(self, camera):
        frame = super().render(camera)
        self.step(Control())
        return frame


def ignoring(**parameters: float) -> type:
    """Return a simulator whose camera ignores some of its parameters."""

    class Ignores(Few):
        def draw(self, camera):
            return super().draw(replace(camera, **parameters))

    return Ignores


class LooksAway(Few):
    """Turns its camera to the other side."""

    def draw(self, camera):
        return super().draw(replace(camera, yaw_deg=-camera.yaw_deg))


class Shallow(Few):
    """Gives scenery a tenth more depth than it has."""

    def draw(self, camera):
        frame = super().draw(camera)
        depth = np.where(frame.ids == 0, 1.1 * frame.depth, frame.depth)
        return replace(frame, depth=depth.astype(np.float32))


@pytest.mark.parametrize(
    ("simulator", "part", "words"),
    [
        (Greyed, "pictures", "most bodies have the colour of the road: "),
        (Painted, "pictures", "the picture changes in 0% of its pixels"),
        (Painted, "pictures", "the picture is that of a straight drive while the ego turns away"),
        (Straight, "pictures", "the picture is that of a straight drive while the ego turns away"),
        (Transparent, "pictures", "a hidden body shows "),
        (Miscounts, "pictures", "unhidden counts "),
        (Leaves, "pictures", "of the picture show the scene before"),
        (Moves, "pictures", "rendering changes the run"),
        (Shallow, "pictures", "gives the road a depth of "),
        (ignoring(fov_deg=70.0), "pictures", "another field of view"),
        (ignoring(x=0.0), "pictures", "a place further ahead"),
        (ignoring(y=0.0), "pictures", "a place to the left"),
        (ignoring(pitch_deg=0.0), "pictures", "another pitch"),
        (ignoring(yaw_deg=0.0), "turning", "camera turned by"),
        (LooksAway, "turning", "which is not where it looks"),
    ],
)
def test_a_contradiction_is_found(simulator, part, words) -> None:
    assert any(words in line for line in lines(simulator, part))

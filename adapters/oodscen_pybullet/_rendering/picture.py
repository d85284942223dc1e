"""Development of a raw shot into the picture that a camera would record."""

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

from oodscen.driving._sight.weather import extinction
from oodscen.numerics._kernels import is_compiled
from oodscen_pybullet._lighting.glows import add_glare, add_glows
from oodscen_pybullet._lighting.reflections import add_reflections, grazing_depth
from oodscen_pybullet._rendering.exposure import expose
from oodscen_pybullet._rendering.particles import add_puffs
from oodscen_pybullet._rendering.plate import Plate
from oodscen_pybullet._rendering.postprocess import postprocess_pixels
from oodscen_pybullet._rendering.postprocess_arrays import postprocess_arrays
from oodscen_pybullet._rendering.precipitation import add_rain, add_snow
from oodscen_pybullet._rendering.sky import air_colour
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import MIRROR
from oodscen_pybullet._types import U8

_MIRRORING = 0.62
"""Reflectivity of wet asphalt at grazing angles."""
_MIRRORED_LAMPS = 5.0
"""Gain of lamps mirrored in the dark, relative to their pixels; from half of daylight on there is none."""
_ADD_DROPS = {"rain": add_rain, "snow": add_snow}


def develop(picture: RawPicture) -> U8:
    """Apply light and weather: [height, width, 3] uint8; depends only on the argument."""
    view, light, weather, shot = picture.view, picture.light, picture.weather, picture.shot
    rate, air = extinction(weather), air_colour(weather, light)
    plate = expose(picture, rate, air)
    if is_compiled():
        image = np.empty((view.height, view.width, 3), np.uint8)
        _in_bands(plate, image, picture.threads)
    else:
        image = postprocess_arrays(plate)
    if picture.balls:
        add_puffs(image, picture, rate, air)
    add_glows(image, view, shot.depth, light, picture.lamps, rate)
    is_raining = weather.precipitation == "rain"
    if is_compiled() and (is_raining or (plate.kinds & MIRROR).any()):
        add_reflections(
            image,
            shot.depth,
            plate.kinds,
            grazing_depth(view.eye[2] - picture.road_height),
            np.float32(_MIRRORING if is_raining else 0.0),
            np.float32(_MIRRORED_LAMPS * max(1.0 - 2.0 * light.daylight, 0.0)),
            np.uint32(picture.seed % 2**20),
        )
    is_inside = picture.portal is not None and picture.portal.is_inside
    add_glare(image, view, shot.depth, light, is_inside=is_inside)
    if weather.precipitation != "none":
        _ADD_DROPS[weather.precipitation](image, picture, plate.kinds)
    return image


def _in_bands(plate: Plate, image: U8, threads: int) -> None:
    """Let each of some threads develop a band of the picture."""
    edges = [len(image) * band // threads for band in range(threads + 1)]
    bands = [(plate, image, first, end) for first, end in pairwise(edges)]
    with ThreadPoolExecutor(threads) as pool:
        for band in [pool.submit(postprocess_pixels, *band) for band in bands]:
            band.result()

"""JPEG files of pictures."""

import numpy as np
from numpy.typing import NDArray

from oodscen.errors import MissingExtra

_QUALITY = 90


def to_jpeg(rgb: NDArray[np.uint8]) -> bytes:
    """Encode a picture [height, width, 3] as JPEG.

    Raises:
        MissingExtra: If OpenCV is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise MissingExtra("writing frames", "pybullet", "opencv-python-headless") from None
    _, data = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    return data.tobytes()

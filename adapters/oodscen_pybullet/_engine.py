"""Imports the PyBullet engine on demand and silences its output."""

import ctypes
import os
import sys
from types import ModuleType

from oodscen.errors import MissingExtra


def load_pybullet() -> ModuleType:
    """Import PyBullet without the line that it prints on import.

    Raises:
        MissingExtra: If it is not installed.
    """
    loaded = sys.modules.get("pybullet")
    if loaded is not None:
        return loaded
    try:
        import cv2  # noqa: F401  # frames need it; fail before a scene is half loaded
    except ImportError:
        raise MissingExtra("the PyBullet simulator", "pybullet", "cv2") from None
    try:
        with QuietDescriptors():
            import pybullet
    except ImportError:
        raise MissingExtra("the PyBullet simulator", "pybullet", "pybullet") from None
    engine: ModuleType = pybullet
    return engine


class QuietDescriptors:
    """Redirects the output of C code to the null device."""

    def __enter__(self) -> None:
        self._saved: list[tuple[int, int]] = []
        _flush()
        try:
            nowhere = os.open(os.devnull, os.O_WRONLY)
        except OSError:
            return
        for descriptor in (1, 2):
            try:
                self._saved.append((descriptor, os.dup(descriptor)))
                os.dup2(nowhere, descriptor)
            except OSError:
                continue
        os.close(nowhere)

    def __exit__(self, *_: object) -> None:
        _flush()
        for descriptor, saved in self._saved:
            os.dup2(saved, descriptor)
            os.close(saved)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    try:
        ctypes.CDLL(None).fflush(None)
    except (OSError, AttributeError, TypeError):
        return

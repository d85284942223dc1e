"""The reference adapter: urban, rural and highway roads with PyBullet's bodies and camera."""

from oodscen_pybullet._simulator import PyBulletSimulator

__all__ = ["PyBulletSimulator"]

"""A server that speaks the protocol of CARLA 0.9.16, without CARLA, GPU or display."""

from oodscen_carla.server._serve import serve
from oodscen_carla.server._test_server import CarlaTestServer

__all__ = ["CarlaTestServer", "serve"]

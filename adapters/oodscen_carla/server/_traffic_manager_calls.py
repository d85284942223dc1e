"""Calls about the traffic manager, which lives in the client."""

from typing import Any

from oodscen_carla.server import _values as read


class TrafficManagerCalls:
    """Procedures by which clients find each other's traffic managers."""

    def rpc_is_traffic_manager_running(self, port: Any) -> bool:
        return False

    def rpc_get_traffic_manager_running(self, port: Any) -> list[Any]:
        return ["127.0.0.1", read.whole(port)]

    def rpc_add_traffic_manager_running(self, address: Any) -> bool:
        return True

    def rpc_destroy_traffic_manager(self, port: Any) -> bool:
        return True

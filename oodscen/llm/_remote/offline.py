"""The switch `OODSCEN_OFFLINE`: while it is set, this process contacts no other machine.

It acts where sockets are opened. It therefore sees the actual destination, whatever the client and wherever a
redirect, a proxy variable or a host name leads.
"""

import os
import socket
import sys
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit

from oodscen.llm._remote.call_bounds import active

SWITCH = "OODSCEN_OFFLINE"


class OutsideError(ConnectionRefusedError):
    """A connection that the switch blocks; clients see a refused connection."""


def is_offline() -> bool:
    """Return whether the switch is set to anything but the empty string or 0."""
    return os.environ.get(SWITCH, "") not in ("", "0")


def is_loopback(address: str | None) -> bool:
    """Return whether an address such as `http://127.0.0.1:8000/v1` is certainly on this machine."""
    try:
        return _is_here(urlsplit(address or "").hostname or "")
    except ValueError:
        return False


def enforce() -> None:
    """Make this process obey the switch from now on; calling it once is enough."""
    global _is_enforced
    if not _is_enforced:
        _is_enforced = True
        sys.addaudithook(_refuse_outside)


_is_enforced = False


def _refuse_outside(event: str, arguments: tuple[Any, ...]) -> None:
    host = _destination(event, arguments) if event.startswith("socket.") else None
    if host is None or not is_offline() or _is_here(host):
        return
    if (bounds := active()) is not None:
        bounds.stop("offline", host)
    raise OutsideError(f"{SWITCH} is set, and {host} is not this machine")


def _destination(event: str, arguments: tuple[Any, ...]) -> str | None:
    """Return the host that is about to be contacted, if only for a name look-up; `None` if there is none."""
    host: object = None
    if event in ("socket.connect", "socket.sendto", "socket.sendmsg"):
        endpoint, *_, address = arguments
        if endpoint.family in (socket.AF_INET, socket.AF_INET6) and address is not None:
            host = address[0]
    elif event == "socket.gethostbyaddr":
        host = arguments[0]
    elif event == "socket.getnameinfo":
        host = arguments[0][0]
    elif event in ("socket.getaddrinfo", "socket.gethostbyname"):
        # A literal address is resolved without a name look-up.
        host = None if _is_literal(arguments[0]) else arguments[0]
    if isinstance(host, bytes):
        host = host.decode("ascii", "replace")
    return str(host) if host else None


def _is_here(host: str) -> bool:
    return host == "localhost" or (_is_literal(host) and ip_address(host).is_loopback)


def _is_literal(host: object) -> bool:
    try:
        ip_address(str(host))
    except ValueError:
        return False
    return True

"""``arena ros watchdog``: a relay of velocities in a process of its own, which stops the robot when commands end."""

from __future__ import annotations

import time
from collections.abc import Callable

from arena_core import Twist
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.live.settings import Settings
from arena_ros.transport import Transport


def relay_velocities(
    transport: Transport, source: str, target: str, settings: Settings, is_over: Callable[[], bool]
) -> None:
    """Relay velocities from ``source`` to ``target`` as they come; send zeros once
    the newest is too old, and at the end.
    """
    own = get_codec(transport.ros)
    stand = own.encode(to.twist_msg(own, Twist(0.0, 0.0, 0.0)), to.TWIST)
    publish = transport.publisher(target, to.TWIST)
    newest = [float("-inf")]

    def relay(content: bytes) -> None:
        newest[0] = time.monotonic()
        publish(content)

    transport.subscribe(source, to.TWIST, relay)
    try:
        while not is_over():
            if time.monotonic() - newest[0] > settings.watchdog_age:
                publish(stand)
            time.sleep(settings.watchdog_period)
    finally:
        publish(stand)

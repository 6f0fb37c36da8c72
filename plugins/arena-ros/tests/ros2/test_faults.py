"""What can go wrong with a robot on the air, over DDS; and the driver's second pair of eyes."""

from __future__ import annotations

import time

import pytest

from arena_ros.live.loop_monitor import LoopMonitor
from arena_ros.testing import FaultTests

pytestmark = pytest.mark.slow


class TestFaults(FaultTests):
    transport = "ros2-dds"


def test_guard_is_quiet_before_the_first_command_and_after_the_last() -> None:
    stops: list[float] = []
    with LoopMonitor(lambda: stops.append(time.monotonic()), 0.05, None) as guard:
        time.sleep(0.2)
        assert not stops
        guard.note_command()
        while not stops:
            time.sleep(0.01)
        guard.note_standing()
        counts = [-1]
        while counts[-1] != len(stops):  # a stop may be under way; a guard that is never quiet ends this no sooner
            assert len(counts) < 100, "it goes on"
            counts.append(len(stops))
            time.sleep(0.3)

"""Recordings of ROS among the forms of ``arena export``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core.records import Export


class _Recording(Export):
    """Episode after episode in one recording, as ``arena ros export`` writes it."""

    def write(self, folder: Path, target: Path, episodes: Sequence[int]) -> None:
        """Write the recording; the target's ending says of which kind it is."""
        from arena_ros.bags.exporting import export_run

        export_run(folder, target, episodes)


class McapExport(_Recording):
    """ROS 2, MCAP."""

    help: ClassVar[str] = "a recording of ROS 2 for Foxglove, RViz and PlotJuggler"
    ending: ClassVar[str] = ".mcap"


class BagExport(_Recording):
    """ROS 1."""

    help: ClassVar[str] = "a recording of ROS 1"
    ending: ClassVar[str] = ".bag"

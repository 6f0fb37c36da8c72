"""The tracker of a robot that does not look for moving obstacles."""

from arena_core import NO_TRACKS, LaserScan, OccupancyGrid, Pose, Tracker, Tracks


class NoTracker(Tracker):
    """Believes that nothing moves; for planners that never ask for tracks."""

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; there is nothing to forget."""

    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Return no tracks."""
        return NO_TRACKS

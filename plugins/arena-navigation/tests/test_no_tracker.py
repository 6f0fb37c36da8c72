import numpy as np

from arena_core import Pose
from arena_core.testing import component, robot, room, scan


def test_it_believes_that_nothing_moves() -> None:
    tracker = component("tracker", "none", robot=robot())
    tracker.reset(room())
    tracks = tracker.update(scan(Pose(0.0, 0.0), robot()), Pose(0.0, 0.0), 0.0)
    assert len(tracks.ids) == 0
    assert tracks.covariances.shape == (0, 4, 4)
    assert isinstance(tracks.positions, np.ndarray)

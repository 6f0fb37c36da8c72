from dataclasses import fields

import numpy as np

from arena_core import ObservationBatch, ScanMemory, Twist
from arena_core.testing import observation
from arena_policies.observation_view import batch_of_one


def test_a_batch_of_one_is_the_cores():
    view, last, recalled = observation(), Twist(0.1, -0.2, 0.3), np.ones((1, 3), np.float32)
    memory = ScanMemory((1, 2), 1, len(view.scan.ranges))
    memory.begin(np.zeros(1, np.int64), view.scan.ranges[None], view.pose.array()[None])
    ours = batch_of_one(view, last, memory.earlier(), recalled)
    cores = ObservationBatch.of(view, last, memory, recalled)
    pairs = [(getattr(ours, field.name), getattr(cores, field.name)) for field in fields(cores)]
    pairs += [(getattr(ours.paths, name), getattr(cores.paths, name)) for name in ("poses", "offsets")]
    pairs += [(getattr(ours.earlier, name), getattr(cores.earlier, name)) for name in ("ranges", "poses")]
    arrays = [(one, other) for one, other in pairs if isinstance(other, np.ndarray)]
    assert len(arrays) == 12
    for one, other in arrays:
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        np.testing.assert_array_equal(one, other)
    assert ours.maps == cores.maps

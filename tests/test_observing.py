"""What a planner sees is its own and cannot be written to; what it does to it changes nothing that others
read or that is recorded.
"""

import copy
import dataclasses
import pickle
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from arena_core import NO_TRACKS, DepthImage, OccupancyGrid, Pose, PoseEstimate
from arena_core.base.frozen import freeze_array, is_sealed
from arena_core.base.portability import PORTABLE
from arena_core.hosting import build_benchmark, compose, load_registry, to_plain
from arena_core.loop.observing import make_observation, shown_map
from arena_core.records import read_record
from arena_core.testing import boxes_costmap, robot, sensors, straight_path

QUICK = (
    *("planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=8", "world.height=8", "task.pedestrians=2"),
    *("localizer=ground_truth", "task.time_limit=4", "recording.scans=true", "tracker=kalman"),
)


def arrays_of(value, name="observation"):
    """Yield every array that attributes lead to, by its name."""
    if isinstance(value, np.ndarray):
        yield name, value
        return
    if dataclasses.is_dataclass(value):
        for attribute in dir(value):
            if not attribute.startswith("_") and not callable(getattr(value, attribute)):
                yield from arrays_of(getattr(value, attribute), f"{name}.{attribute}")


def tamper(observation):
    """Do what a careless or cheating planner can do to what it is shown; return how many arrays withstood."""
    withstood = 0
    for name, array in arrays_of(observation):
        for way in (
            lambda a: a.__setitem__(..., 0),
            lambda a: setattr(a.flags, "writeable", True),
            lambda a: a.fill(0),
        ):
            with pytest.raises(ValueError):  # noqa: PT011 - numpy's words for it differ
                way(array)
        assert array.base is None or isinstance(array.base, bytes) or is_sealed(array), name
        withstood += 1
    for pose in (observation.pose, observation.goal, observation.waypoint, observation.scan.mount):
        object.__setattr__(pose, "x", 1e3)
    object.__setattr__(observation.scan, "ranges", np.zeros(3, np.float32))
    if observation.map is not None:
        object.__setattr__(observation.map.origin, "x", 1e3)
        observation.map._derived.clear()
    return withstood


def record_of(folder, meddle):
    config = to_plain(compose(QUICK))
    run = build_benchmark({**config, "choices": {}}, load_registry())
    planner, seen = run.navigator.planner, []
    compute = planner.compute_velocity

    def compute_velocity(observation):
        command = compute(observation)
        observation.local_map, observation.tracks  # noqa: B018 - both are computed when asked for
        seen.append(tamper(observation) if meddle else 0)
        return command

    planner.compute_velocity = compute_velocity
    return run.run(0, folder), seen


def test_a_planner_that_writes_to_all_it_sees_changes_neither_the_drive_nor_its_record(tmp_path):
    honest, _ = record_of(tmp_path / "honest", False)
    altered, withstood = record_of(tmp_path / "altered", True)
    assert min(withstood) >= 12
    assert len(withstood) > 10
    assert honest.meta == altered.meta
    assert honest.arrays.keys() == altered.arrays.keys()
    for name, values in honest.arrays.items():
        assert np.array_equal(values, altered[name], equal_nan=values.dtype.kind == "f"), name


def test_a_planner_has_a_robot_and_a_map_of_its_own(tmp_path):
    run = build_benchmark({**to_plain(compose(QUICK)), "choices": {}}, load_registry())
    starts = []
    run.navigator.planner.reset = starts.append
    run.run(0, tmp_path)
    scenario = run.task.scenario(run.settings.seed, 0)
    shown = starts[0].map
    assert shown is not scenario.world.grid
    assert shown.data is scenario.world.grid.data or np.array_equal(shown.data, scenario.world.grid.data)
    assert starts[0].goal == scenario.goal
    assert starts[0].goal is not scenario.goal
    assert run.robot.footprint.vertices_xy.flags.writeable is False


@pytest.mark.parametrize(
    "array", [np.arange(6.0).reshape(2, 3), np.zeros((0, 3)), np.arange(4, dtype=np.int32)[::2], np.array(True)]
)
def test_a_frozen_array_has_the_same_values_and_nothing_leads_to_memory_that_can_be_written(array):
    copy = freeze_array(array)
    assert np.array_equal(copy, array)
    assert (copy.dtype, copy.shape) == (array.dtype, array.shape)
    assert isinstance(copy.base, bytes)
    assert freeze_array(copy) is copy
    with pytest.raises(ValueError, match="cannot set WRITEABLE flag"):
        copy.flags.writeable = True


def test_what_is_recorded_is_taken_before_the_planner_decides(third_party, arena):
    third_party.package(
        "eraser",
        """
        from arena_core import Planner, Robot, Twist, hookimpl

        class Eraser(Planner):
            def __init__(self, robot: Robot) -> None:
                pass

            def compute_velocity(self, observation):
                object.__setattr__(observation.pose, "x", -5.0)
                object.__setattr__(observation.waypoint, "x", -5.0)
                object.__setattr__(observation.path, "poses", None)
                return Twist(0.1)

        @hookimpl
        def register_planners(register):
            register("eraser", Eraser)

        @hookimpl
        def config_package():
            return "eraser.conf"
        """,
        {"planner/eraser": "name: eraser\n"},
    )
    words = [word for word in QUICK if not word.startswith("planner=")]
    assert (
        arena(
            "run", "planner=eraser", *words, "episodes=1", "executor=serial", "report=false", "hydra.run.dir=run"
        ).status
        == 0
    )
    record = read_record(Path("run/records/0000.npz"))
    assert record["estimate"][:, 0].min() > 0.0
    assert record["waypoint"][:, 0].min() > 0.0


def test_planner_is_shown_a_depth_image_of_its_own():
    taken = DepthImage(0.0, np.ones((2, 3), np.float32), 3.0, Pose(0.1, 0.0), 0.2, 0.0, 0.3, 3.0)
    nothing = (
        PoseEstimate(Pose(0.0, 0.0), np.zeros((3, 3))),
        Pose(1.0, 0.0),
        Pose(1.0, 0.0),
        straight_path(Pose(0.0, 0.0), Pose(1.0, 0.0)),
    )
    without, with_image = (
        sensors(Pose(0.0, 0.0), robot()),
        dataclasses.replace(sensors(Pose(0.0, 0.0), robot()), depth=taken),
    )
    seen = make_observation(with_image, *nothing, None, boxes_costmap, lambda: NO_TRACKS).depth
    assert seen is not taken
    assert seen.mount is not taken.mount
    assert seen.depths.tolist() == taken.depths.tolist()
    with pytest.raises(ValueError, match="read-only"):
        seen.depths[0, 0] = 0.0
    assert make_observation(without, *nothing, None, boxes_costmap, lambda: NO_TRACKS).depth is None


WRITE = """
import ctypes
import sys
from arena_core import OccupancyGrid, Pose
import numpy as np
grid = OccupancyGrid(np.zeros((3, 5), np.int8), 0.1, Pose(0.0, 0.0))
array = getattr(grid, sys.argv[1])
ctypes.memset(array.ctypes.data, 1, array.size)
"""


@pytest.mark.skipif(PORTABLE, reason="pages that no one can write to are POSIX's")
@pytest.mark.parametrize("array", ["data", "occupied"])
def test_a_maps_memory_cannot_be_written_by_compiled_code(array):
    assert subprocess.run([sys.executable, "-c", WRITE, array]).returncode in (-signal.SIGSEGV, -signal.SIGBUS)


def test_a_maps_array_stays_read_only_and_travels():
    grid = OccupancyGrid(np.arange(15, dtype=np.int8).reshape(3, 5), 0.1, Pose(0.0, 0.0))
    with pytest.raises(ValueError, match="cannot set WRITEABLE flag"):
        grid.data.flags.writeable = True
    for other in (pickle.loads(pickle.dumps(grid)), copy.deepcopy(grid)):
        assert (other.data == grid.data).all()
    assert shown_map(grid).data is grid.data
    assert OccupancyGrid(np.zeros((0, 5), np.int8), 0.1, Pose(0.0, 0.0)).data.shape == (0, 5)

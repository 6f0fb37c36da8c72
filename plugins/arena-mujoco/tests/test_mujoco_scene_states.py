"""Moments of a recorded episode, and what ``arena render`` refuses before it draws anything."""

import numpy as np
import pytest

from arena_core import ConfigurationError, EpisodeRecord
from arena_mujoco.pictures.command import RenderCommand
from arena_mujoco.pictures.scene_states import SceneStates

STAMPS = 0.1 * np.arange(21)


@pytest.fixture(scope="module")
def drama():
    """Two seconds: the robot turns through pi, one person walks east at 1.3 m/s, another comes after a second."""
    people = np.zeros((21, 2, 2), np.float32)
    people[:, 0, 0] = 1.3 * STAMPS
    people[:10, 1] = np.nan
    theta = np.angle(np.exp(1j * (3.0 + STAMPS)))
    arrays = {
        "stamp": STAMPS,
        "pose": np.column_stack((STAMPS, np.zeros(21), theta)),
        "pedestrian_positions": people,
        "pedestrian_radii": np.array([0.3, 0.3]),
        "pedestrian_states": np.full((21, 2), 2, np.int8),
        "path_poses": np.zeros((5, 3)),
        "path_offsets": np.array([0, 2, 5]),
        "path_stamps": np.array([0.0, 1.0]),
    }
    return SceneStates(EpisodeRecord(arrays, {"config": {}}), calm=0.5)


def test_between_two_steps_everything_moves_evenly(drama):
    still = drama.at(0.55)
    assert still.pose == pytest.approx((0.55, 0.0, 3.55))
    assert still.positions[0] == pytest.approx((0.715, 0.0), abs=1e-6)
    assert np.isnan(still.positions[1]).all()
    assert len(still.trail) == 7


def test_path_is_the_latest_that_was_planned(drama):
    assert [len(drama.at(stamp).path) for stamp in (0.0, 0.95, 1.0, 2.0)] == [2, 2, 3, 3]


def test_feet_stay_within_the_body_and_take_turns(drama):
    feet = np.array([drama.at(stamp).feet[0] - drama.at(stamp).positions[0] for stamp in STAMPS])
    assert np.hypot(feet[..., 0], feet[..., 1]).max() <= 0.3
    ahead = np.sign(feet[3:, 0, 0] - feet[3:, 1, 0])
    assert 2 <= np.count_nonzero(np.diff(ahead)) <= 5  # about two steps a second
    assert (feet[3:, 0, 1] > 0.0).all()  # the left foot is to the left of who walks east


def test_doors_are_as_they_were_at_the_step_that_holds(drama):
    assert drama.at(0.5).doors_open.tolist() == []
    arrays = {**drama.record.arrays, "doors_open": (STAMPS > 0.95)[:, None]}
    with_door = SceneStates(EpisodeRecord(arrays, drama.record.meta), calm=0.5)
    assert [with_door.at(stamp).doors_open.tolist() for stamp in (0.0, 0.98, 1.02, 5.0)] == [
        [False],
        [False],
        [True],
        [True],
    ]


def test_a_moment_after_the_end_is_the_end(drama):
    assert drama.at(9.0).pose == pytest.approx(drama.at(2.0).pose)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--to", "a.avi"), r"arguments are none; allowed: arena render RUN"),
        (("run",), "out is missing; allowed: arena render RUN"),
        (("run", "--to", "a.avi"), r"out is a\.avi; allowed: a name that ends in \.mp4, \.gif, \.png"),
        (("run", "to=a.png", "size=640"), "size is 640; allowed: WIDTHxHEIGHT"),
        (("run", "to=a.png", "size=641x480"), "size is 641x480; allowed: even numbers from 16x16 to 3840x2160"),
        (("run", "to=a.png", "camera=behind"), "camera is 'behind'; allowed: one of follow, top, onboard"),
        (("run", "to=a.png", "zoom=2"), "there is no key zoom"),
    ],
)
def test_wrong_words_are_named(words, said):
    with pytest.raises(ConfigurationError, match=said):
        RenderCommand().run(words)


def test_teammates_move_evenly_too_and_turn_the_short_way(drama):
    track = np.zeros((21, 2, 3))
    track[:, 0] = drama.record["pose"]
    track[:, 1, 0], track[:, 1, 2] = 2.0 * STAMPS, np.angle(np.exp(1j * (3.0 + STAMPS)))
    team = {"team_stamp": STAMPS, "team_pose": track}
    meta = {**drama.record.meta, "team": {"member": 0, "robots": [{"name": "robot0"}, {"name": "robot1"}]}}
    states = SceneStates(EpisodeRecord({**drama.record.arrays, **team}, meta), calm=0.5)
    assert states.at(0.55).mates == pytest.approx(np.array([[1.1, 0.0, 3.55]]))
    assert drama.at(0.55).mates.shape == (0, 3)

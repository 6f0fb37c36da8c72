"""The true people as tracks, and what they will truly do."""

import math

import numpy as np
import pytest

from arena_core import NO_TRACKS, ConfigurationError, Pose
from arena_core.testing import check, component, observation, people, robot, room, scan, truth

NOW = Pose(0.0, 0.0)


@pytest.fixture(scope="module")
def known():
    return truth(robot())


def shown(part, known):
    part.see(known)
    part.reset(room())
    return part


def tracks_of(known, *words, pose=NOW):
    tracker = shown(component("tracker", "ground_truth", words, robot=robot()), known)
    return tracker.update(scan(pose, robot()), pose, 0.0)


def test_the_tracker_keeps_the_contract():
    assert check("tracker", component("tracker", "ground_truth", robot=robot()), robot())


def test_tracks_are_where_people_are(known):
    tracks, state = tracks_of(known), known.state()
    assert tracks.ids.tolist() == [1, 2, 3]
    assert tracks.positions == pytest.approx(state.pedestrians.positions)
    assert tracks.velocities == pytest.approx(state.pedestrians.velocities)
    assert tracks.radii == pytest.approx(0.3)


def test_people_out_of_range_are_not_told_of(known):
    assert tracks_of(known, "tracker.range=1.7").ids.tolist() == [2]


def test_people_whom_the_scan_does_not_show_may_be_left_out(known):
    """The sample scan shows the empty room."""
    assert tracks_of(known, "tracker.hidden=false").ids.tolist() == []


def test_people_stand_to_the_believed_robot_as_they_do_to_the_true_one(known):
    believed = Pose(1.0, -2.0, 0.5 * math.pi)
    placed, true = tracks_of(known, pose=believed), known.state()
    for k in range(3):
        seen = believed.relative(Pose(*placed.positions[k]))
        meant = true.pose.relative(Pose(*true.pedestrians.positions[k]))
        assert (seen.x, seen.y) == pytest.approx((meant.x, meant.y))


def predicted(known, *words, tracks=None, pose=NOW):
    predictor = shown(component("predictor", "truth", words), known)
    return predictor.predict(observation(pose=pose, body=robot(), tracks=people(0.0) if tracks is None else tracks))


def test_people_are_foreseen_where_they_come_to_be(known):
    times = np.arange(0.0, 2.01, 0.4)
    ahead = known.people_ahead(times).positions
    places = predicted(known).at(times)
    moved = ahead - known.state().pedestrians.positions[:, None]
    assert places - people(0.0).positions[:, None] == pytest.approx(moved, abs=1e-9)


def test_beyond_the_horizon_people_keep_the_velocity_that_they_truly_have_then(known):
    last = known.people_ahead((0.0, 1.0))
    told = predicted(known, "predictor.horizon=1.0")
    assert told.at((3.0,))[:, 0] == pytest.approx(told.at((1.0,))[:, 0] + 2.0 * last.velocities[:, 1])


def test_without_a_horizon_each_keeps_its_true_velocity(known):
    told = predicted(known, "predictor.horizon=0")
    assert told.velocities == pytest.approx(known.state().pedestrians.velocities)


def test_a_track_that_is_nobodys_keeps_its_own_velocity(known):
    own = people(0.0)
    stray = own.positions + np.array((0.0, 10.0))
    told = predicted(known, tracks=type(own)(own.ids, stray, own.velocities, own.radii, own.covariances))
    assert told.at((1.5,))[:, 0] == pytest.approx(stray + 1.5 * own.velocities)


def test_an_error_of_the_pose_turns_what_people_do_as_it_turns_their_tracks(known):
    believed = Pose(1.0, -2.0, 0.5 * math.pi)
    told = predicted(known, pose=believed, tracks=tracks_of(known, pose=believed)).at((1.0,))[:, 0]
    meant = known.people_ahead((1.0,)).positions[:, 0]
    for k in range(3):
        seen, true = believed.relative(Pose(*told[k])), known.state().pose.relative(Pose(*meant[k]))
        assert (seen.x, seen.y) == pytest.approx((true.x, true.y), abs=1e-6)


def test_nobody_is_foreseen_where_nobody_is_tracked(known):
    assert len(predicted(known, tracks=NO_TRACKS).means) == 0


@pytest.mark.parametrize("words", ["predictor.step=0.01", "predictor.horizon=1000", "predictor.gate=-1"])
def test_impossible_figures_are_refused(words):
    with pytest.raises(ConfigurationError, match=words.partition("=")[0]):
        component("predictor", "truth", [words])

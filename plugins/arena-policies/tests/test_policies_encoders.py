from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, ObservationBatch, Pose, Twist
from arena_core.testing import check, component, joined, observation, robot

PRESETS = ("rosnav", "rosnav_sectors", "gring")
DRIVES = ("differential", "omnidirectional", "ackermann")


def fields(encoder, row):
    """Return the numbers of each field by its name."""
    ends = np.cumsum([field.size for field in encoder.layout()])
    return dict(zip((field.name for field in encoder.layout()), np.split(row, ends[:-1]), strict=True))


BODIES = {drive: robot(drive) for drive in DRIVES}


@cache
def built(preset, drive="differential", *overrides):
    return component("observation_encoder", preset, [f"observation_encoder.{o}" for o in overrides], robot=BODIES[drive])


def seen(preset, view, command=None, *overrides):
    encoder = built(preset, "differential", *overrides)
    return fields(encoder, encoder.encode(ObservationBatch.of(view, command or Twist(0.0)))[0])


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("drive", DRIVES)
def test_encoders_hold_their_contract(preset, drive):
    body = robot(drive)
    assert check("observation_encoder", component("observation_encoder", preset, robot=body), body)


def test_rosnav_sees_beams_waypoint_and_last_command():
    view, body = observation(waypoint=Pose(0.0, 2.0), goal=Pose(3.0, 0.0)), robot()
    raw = seen("rosnav", view, Twist(0.3, 0.0, -0.4), "scaled=false")
    limit = body.lidar.range_max
    assert raw["ranges"] == pytest.approx(np.minimum(view.scan.ranges, limit))
    assert (raw["rho"], raw["theta"]) == (pytest.approx(2.0), pytest.approx(np.pi / 2))
    assert [raw[name][0] for name in ("last_vx", "last_vy", "last_wz")] == pytest.approx([0.3, 0.0, -0.4])
    scaled = seen("rosnav", view, Twist(0.3, 0.0, -0.4))
    assert scaled["ranges"] == pytest.approx(raw["ranges"] / limit)
    assert (scaled["rho"], scaled["theta"]) == (pytest.approx(0.2), pytest.approx(0.5))
    to_goal = seen("rosnav", view, None, "target=goal")
    assert (to_goal["rho"], to_goal["theta"]) == (pytest.approx(0.3), pytest.approx(0.0))


def test_sectors_show_the_nearest_beam_and_what_is_close_most():
    body = robot()
    view = observation()
    view.scan.ranges[:] = np.inf
    far = seen("rosnav_sectors", view)["closeness"]
    assert np.ptp(far) == 0.0
    beams = body.lidar.beams
    view.scan.ranges[beams // 2] = body.footprint.radius
    near = seen("rosnav_sectors", view)["closeness"]
    assert np.flatnonzero(near != far).tolist() == [len(near) // 2]
    assert near.max() == pytest.approx(2.0)


def test_sectors_share_all_beams_however_many():
    body = robot()
    for sectors in (1, 7, 90, 10_000):
        view = observation()
        for beam in range(0, body.lidar.beams, 5):
            view.scan.ranges[:] = 5.0
            view.scan.ranges[beam] = 0.5
            ranges = seen("gring", view, None, f"sectors={sectors}")["ranges"]
            assert len(ranges) == min(sectors, body.lidar.beams)
            assert (ranges < ranges.max()).sum() == (1 if sectors > 1 else 0)


@settings(derandomize=True, deadline=None, max_examples=30)
@given(x=st.floats(-4, 4), y=st.floats(-4, 4), theta=st.floats(-10, 10))
def test_waypoint_is_seen_from_the_robot(x, y, theta):
    view = observation(pose=Pose(0.5, -0.5, theta), waypoint=Pose(x, y))
    state = seen("rosnav_sectors", view)
    there = Pose(0.5, -0.5, theta).relative(Pose(x, y))
    away = min(np.hypot(there.x, there.y), 8.0)
    assert state["waypoint_distance"][0] * 2.0 == pytest.approx(away, abs=1e-5)
    assert away * state["waypoint_cos"][0] == pytest.approx(there.x, abs=1e-5)
    assert away * state["waypoint_sin"][0] == pytest.approx(there.y, abs=1e-5)


def test_gring_sees_eight_points_ahead_in_its_own_frame():
    view = observation(pose=Pose(0.0, 0.0, np.pi / 2), goal=Pose(0.0, 3.0))
    points = seen("gring", view)["waypoints_xy"].reshape(8, 2) * 4.0
    assert points[:, 0] == pytest.approx([0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.0, 3.0], abs=1e-3)
    assert points[:, 1] == pytest.approx(np.zeros(8), abs=1e-3)


@pytest.mark.parametrize("preset", PRESETS)
def test_batch_of_many_equals_each_alone_bit_for_bit(preset):
    random = np.random.default_rng(0)
    encoder = component("observation_encoder", preset, robot=robot())
    batches = []
    for _ in range(64):
        x, y, theta, v, w = random.uniform(-1, 1, 5).tolist()
        view = observation(Pose(x, y, 3.0 * theta), Pose(y, -x), Pose(3.0, y), Twist(v, 0.0, w))
        batches.append(ObservationBatch.of(view, Twist(w, 0.0, v)))
    together = encoder.encode(joined(batches))
    assert all((together[k] == encoder.encode(batch)[0]).all() for k, batch in enumerate(batches))


@pytest.mark.parametrize("preset", PRESETS)
def test_range_that_is_no_number_stays_none(preset):
    view = observation()
    view.scan.ranges[3] = np.nan
    encoder = component("observation_encoder", preset, robot=robot())
    assert np.isnan(encoder.encode(ObservationBatch.of(view, Twist(0.0)))).sum() == 1


@pytest.mark.parametrize("override", ["sectors=0", "range_max=-1.0", "decay=0.0"])
def test_impossible_numbers_are_refused(override):
    with pytest.raises(ConfigurationError, match=f"observation_encoder.{override.split('=')[0]}"):
        component("observation_encoder", "rosnav_sectors", [f"observation_encoder.{override}"], robot=robot())

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, ObservationBatch, Pose, ScanMemory, Tracks, Twist
from arena_core.hosting import straight_predictions
from arena_core.testing import check, component, join_batches, observation, robot
from arena_policies.encoding import nearest_in_sectors
from arena_policies.scan_history import beams_of, past_sector_ranges
from arena_policies.track_prediction import bodies_of, predict_sector_ranges, sectors_of

LOOKING_BACK = ["observation_encoder.lookback=[0.1,0.3]"]
PRESETS = ("rosnav", "rosnav_sectors", "gring", "gring_as_released", "aio")
DRIVES = ("differential", "omnidirectional", "ackermann")


def fields(encoder, row):
    """Return the numbers of each field by its name."""
    ends = np.cumsum([field.size for field in encoder.layout()])
    return dict(zip((field.name for field in encoder.layout()), np.split(row, ends[:-1]), strict=True))


BEAMS = {name: component("robot", name).lidar for name in ("turtlebot3", "jackal", "robotino")}
BODIES = {drive: robot(drive) for drive in DRIVES}


@cache
def built(preset, drive="differential", *overrides):
    return component(
        "observation_encoder", preset, [f"observation_encoder.{o}" for o in overrides], robot=BODIES[drive]
    )


def ranges_of(view):
    """Return a view's ranges to write to: what planners are shown, they cannot write to."""
    if not view.scan.ranges.flags.writeable:
        object.__setattr__(view.scan, "ranges", view.scan.ranges.copy())
    return view.scan.ranges


def batch_of(encoder, view, command=None, earlier=None):
    """Return the batch of one of a robot that has only just begun, or that saw ``earlier`` at the steps
    that the encoder looks back at.
    """
    memory = ScanMemory(encoder.lookback, 1, len(view.scan.ranges))
    first = earlier or view
    memory.begin(np.zeros(1, np.int64), first.scan.ranges[None], first.pose.array()[None])
    return ObservationBatch.of(view, command or Twist(0.0), memory, tracked=encoder.tracked)


def seen(preset, view, command=None, *overrides):
    encoder = built(preset, "differential", *overrides)
    return fields(encoder, encoder.encode(batch_of(encoder, view, command))[0])


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("drive", DRIVES)
def test_encoders_hold_their_contract(preset, drive):
    body = robot(drive)
    assert check("observation_encoder", component("observation_encoder", preset, robot=body), body)


def test_encoder_that_looks_back_holds_its_contract():
    body = robot()
    encoder = component("observation_encoder", "rosnav_sectors", LOOKING_BACK, robot=body)
    assert encoder.lookback == (1, 3)
    assert [field.name for field in encoder.layout()][:3] == ["closeness", "closeness_1", "closeness_2"]
    assert check("observation_encoder", encoder, body)


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
    ranges_of(view)[:] = np.inf
    far = seen("rosnav_sectors", view)["closeness"]
    assert np.ptp(far) == 0.0
    beams = body.lidar.beams
    ranges_of(view)[beams // 2] = body.footprint.radius
    near = seen("rosnav_sectors", view)["closeness"]
    assert len(np.flatnonzero(near != far)) == 1
    assert near.max() == pytest.approx(2.0)


def test_sectors_of_a_scan_all_round_begin_behind_and_overlap():
    body = replace(robot(), lidar=BEAMS["turtlebot3"])
    encoder = component("observation_encoder", "rosnav_sectors", robot=body)
    closeness = {}
    for degrees in (0, 90, 180, 270):
        view = observation()
        view = replace(view, scan=replace(view.scan, ranges=np.full(360, np.inf, np.float32)))
        ranges_of(view)[degrees] = 0.5
        row = fields(encoder, encoder.encode(ObservationBatch.of(view, Twist(0.0)))[0])["closeness"]
        closeness[degrees] = np.flatnonzero(row > row.min()).tolist()
    assert closeness == {0: [45], 90: [67], 180: [0, 90], 270: [22]}


@pytest.mark.parametrize("name", BEAMS)
def test_earlier_scan_from_the_same_pose_shows_the_same_sectors(name):
    lidar, random = BEAMS[name], np.random.default_rng(0)
    stride = max(lidar.beams // 360, 1)
    ranges, poses = random.uniform(0.2, 9.0, (3, lidar.beams)).astype(np.float32), random.uniform(-3.0, 3.0, (3, 3))
    ranges[:, np.arange(lidar.beams) % stride > 0] = np.inf
    direct, again = np.empty((3, 90)), np.empty((3, 1, 90))
    nearest_in_sectors(ranges, 8.0, direct)
    past_sector_ranges(ranges[:, None], poses[:, None], poses, beams_of(lidar), 8.0, again)
    assert again[:, 0] == pytest.approx(direct, abs=1e-12)


@settings(derandomize=True, deadline=None, max_examples=50)
@given(
    x=st.floats(-1, 1), y=st.floats(-1, 1), turn=st.floats(-3, 3), beam=st.integers(0, 359), away=st.floats(0.2, 5.0)
)
def test_earlier_return_is_seen_where_it_lies(x, y, turn, beam, away):
    lidar = BEAMS["turtlebot3"]
    ranges = np.full((1, 1, 360), np.inf, np.float32)
    ranges[0, 0, beam] = away
    then, now = Pose(0.3, -0.2, 0.7), Pose(0.3, -0.2, 0.7).compose(Pose(x, y, turn))
    out = np.empty((1, 1, 360))
    past_sector_ranges(ranges, then.array()[None, None], now.array()[None], beams_of(lidar), 9.0, out)
    angle = beam * lidar.angle_increment
    hit = then.compose(lidar.mount).compose(Pose(away * np.cos(angle), away * np.sin(angle)))
    seen = now.compose(lidar.mount).relative(hit)
    assume(np.hypot(seen.x, seen.y) > 1e-6)  # what lies at the sensor itself has no direction
    assert out.min() == pytest.approx(np.hypot(seen.x, seen.y), abs=1e-5)
    off = out[0, 0].argmin() * lidar.angle_increment - np.arctan2(seen.y, seen.x)
    assert abs(np.sin(off / 2)) * 2 <= 0.5 * lidar.angle_increment + 1e-5


def test_looking_back_takes_whole_control_steps():
    with pytest.raises(
        ConfigurationError, match=r"lookback has 0.25; allowed: multiples of the robot's control period, 0.1 s"
    ):
        built("rosnav_sectors", "differential", "lookback=[0.25]")


def test_sectors_share_all_beams_however_many():
    body = robot()
    for sectors in (1, 7, 90, 10_000):
        view = observation()
        for beam in range(0, body.lidar.beams, 5):
            ranges_of(view)[:] = 5.0
            ranges_of(view)[beam] = 0.5
            ranges = seen("gring_as_released", view, None, f"sectors={sectors}")["ranges"]
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


def test_rosnav_may_see_where_its_path_turns():
    view = observation(pose=Pose(0.0, 0.0, np.pi / 2), goal=Pose(0.0, 2.0))
    state = seen("rosnav_sectors", view, None, "ahead=3", "spacing=0.8")
    points = state["ahead_xy"].reshape(3, 2) * 0.8 * np.arange(1, 4)[:, None]
    assert points == pytest.approx(np.array([(0.8, 0.0), (1.6, 0.0), (2.0, 0.0)]), abs=1e-3)
    without = seen("rosnav_sectors", view)
    assert "ahead_xy" not in without
    assert all((state[name] == values).all() for name, values in without.items())


def test_gring_sees_eight_waypoints_ahead_in_its_own_frame():
    view = observation(pose=Pose(0.0, 0.0, np.pi / 2), goal=Pose(0.0, 4.0))
    points = seen("gring_as_released", view)["waypoints_xy"].reshape(8, 2)
    assert points[:, 0] == pytest.approx([1.5, 3.0, *[4.0] * 6], abs=1e-3)
    assert points[:, 1] == pytest.approx(np.zeros(8), abs=1e-3)
    ways = seen("gring", view)["waypoints_xy"].reshape(8, 2) * 1.5 * np.arange(1, 9)[:, None]
    assert ways == pytest.approx(points, abs=1e-3)


@pytest.mark.parametrize("name", ["turtlebot3", "jackal", "robotino"])
def test_gring_as_released_sees_every_beam_as_far_as_the_lidar_does(name):
    body = component("robot", name)
    encoder = component("observation_encoder", "gring_as_released", robot=body)
    view = observation(body=body)
    ranges_of(view)[:] = np.linspace(0.5, body.lidar.range_max, body.lidar.beams)
    ranges_of(view)[7] = np.inf
    state = fields(encoder, encoder.encode(batch_of(encoder, view))[0])
    expected = view.scan.ranges.copy()
    expected[7] = body.lidar.range_max
    assert np.sort(state["ranges"]) == pytest.approx(np.sort(expected), abs=0.026)
    assert state["ranges"].size == {"turtlebot3": 360, "jackal": 720, "robotino": 552}[name]


def test_gring_sees_earlier_scans_as_they_were():
    encoder = built("gring")
    assert encoder.lookback == (5, 10)
    now, then = observation(pose=Pose(1.0, 0.0, 0.3)), observation(pose=Pose(0.0, 0.0, 0.0))
    both = fields(encoder, encoder.encode(batch_of(encoder, now, earlier=then))[0])
    assert (both["closeness"] == seen("gring", now)["closeness"]).all()
    assert (both["closeness_1"] == seen("gring", then)["closeness"]).all()
    assert (both["closeness_2"] == both["closeness_1"]).all()


def test_gring_aligned_sees_earlier_scans_from_where_it_is_now():
    now, then = observation(pose=Pose(1.0, 0.0, 0.3)), observation(pose=Pose(0.0, 0.0, -0.4))
    wanted = built("rosnav_sectors", "differential", "lookback=[0.5,1.0]", "overlap=0")
    aligned = built("gring", "differential", "aligned=true")
    other, mine = (fields(e, e.encode(batch_of(e, now, earlier=then))[0]) for e in (wanted, aligned))
    for scan in ("closeness", "closeness_1", "closeness_2"):
        assert (mine[scan] == other[scan]).all()
    assert (mine["closeness_1"] != seen("gring", then)["closeness"]).any()


def test_gring_as_released_rounds_metres():
    view = observation(pose=Pose(0.013, 0.0, 0.1), twist=Twist(0.3))
    state = seen("gring_as_released", view)
    assert list(state) == ["ranges", "waypoints_xy"], "no speeds"
    for numbers in state.values():
        assert numbers / 0.05 == pytest.approx(np.round(numbers / 0.05), abs=1e-4)
    assert seen("gring", view)["vx"] == pytest.approx(0.3)


def test_aio_tells_what_is_on_the_map_from_what_is_not():
    view = observation()
    walls = seen("aio", view)
    empty = walls["scan_dynamic"].min()
    assert (walls["scan_dynamic"] == empty).all()
    assert (walls["scan"] > empty).all()
    ranges_of(view)[90] = 1.0  # straight ahead, of a scan of 180 beams from behind on
    person = seen("aio", view)
    assert np.flatnonzero(person["scan_dynamic"] > empty).tolist() == [16]
    assert person["scan_dynamic"][16] == pytest.approx(2.0 * np.exp(-0.8) - 0.1, abs=1e-3)
    unmapped = seen("aio", replace(view, map=None))
    assert (unmapped["scan_dynamic"] == empty).all(), "without a map, all of it stands"
    assert unmapped["scan"][16] == person["scan_dynamic"][16]


@settings(derandomize=True, deadline=None, max_examples=30)
@given(x=st.floats(-3, 3), y=st.floats(-3, 3), theta=st.floats(-10, 10))
def test_aio_takes_no_wall_for_something_that_moves(x, y, theta):
    walls = seen("aio", observation(pose=Pose(x, y, theta)))
    assert np.ptp(walls["scan_dynamic"]) == 0.0


def test_aio_sees_goal_and_waypoint():
    state = seen("aio", observation(goal=Pose(0.0, -3.0), waypoint=Pose(2.0, 0.0), twist=Twist(0.4)))
    assert (state["goal_distance"], state["goal_cos"], state["goal_sin"]) == (
        pytest.approx(0.6),
        pytest.approx(0, abs=1e-6),
        -1.0,
    )
    assert (state["waypoint_distance"], state["waypoint_cos"], state["waypoint_sin"]) == (1.0, 1.0, 0.0)
    assert state["vx"] == pytest.approx(0.4)


@pytest.mark.parametrize("preset", PRESETS)
def test_batch_of_many_equals_each_alone_bit_for_bit(preset):
    random = np.random.default_rng(0)
    encoder = component("observation_encoder", preset, robot=robot())
    batches = []
    for _ in range(64):
        x, y, theta, v, w = random.uniform(-1, 1, 5).tolist()
        view = observation(Pose(x, y, 3.0 * theta), Pose(y, -x), Pose(3.0, y), Twist(v, 0.0, w))
        batches.append(batch_of(encoder, view, Twist(w, 0.0, v)))
    together = encoder.encode(join_batches(batches))
    assert all((together[k] == encoder.encode(batch)[0]).all() for k, batch in enumerate(batches))


@pytest.mark.parametrize("beam", [3, 90])
@pytest.mark.parametrize("preset", PRESETS)
def test_range_that_is_no_number_stays_none(preset, beam):
    view = observation()
    ranges_of(view)[beam] = np.nan
    encoder = component("observation_encoder", preset, robot=robot())
    assert np.isnan(encoder.encode(batch_of(encoder, view, earlier=observation()))).any()


@pytest.mark.parametrize("override", ["sectors=0", "range_max=-1.0", "decay=0.0", "overlap=-1", "lookback=[0.0]"])
def test_impossible_numbers_are_refused(override):
    with pytest.raises(ConfigurationError, match=f"observation_encoder.{override.split('=')[0]}"):
        component("observation_encoder", "rosnav_sectors", [f"observation_encoder.{override}"], robot=robot())


def tracked(*bodies):
    """Return tracks of bodies (x, y, vx, vy, radius)."""
    x, y, vx, vy, radii = np.array(bodies, np.float64).reshape(-1, 5).T
    return Tracks(
        np.arange(len(x), dtype=np.int32),
        np.stack((x, y), 1),
        np.stack((vx, vy), 1),
        radii.copy(),
        np.zeros((len(x), 4, 4)),
    )


def test_encoder_that_foresees_holds_its_contract():
    body = robot()
    encoder = component(
        "observation_encoder", "rosnav_sectors", ["observation_encoder.foreseen=[1,2.5]", *LOOKING_BACK], robot=body
    )
    assert encoder.tracked
    assert [field.name for field in encoder.layout()][:5] == ["closeness", *(f"closeness_{k}" for k in range(1, 5))]
    assert check("observation_encoder", encoder, body)


@pytest.mark.parametrize("name", BEAMS)
def test_without_tracks_the_scan_stays_as_it_is(name):
    lidar, random = BEAMS[name], np.random.default_rng(1)
    ranges, poses = random.uniform(0.2, 9.0, (3, lidar.beams)).astype(np.float32), random.uniform(-3.0, 3.0, (3, 3))
    now, then = np.empty((3, 90)), np.empty((3, 2, 90))
    nearest_in_sectors(ranges, 8.0, now)
    bodies = bodies_of([tracked()] * 3, [straight_predictions(tracked())] * 3, np.array((1.0, 2.0)))
    predict_sector_ranges(ranges, poses, bodies, sectors_of(lidar, 90), 8.0, then)
    assert (then == now[:, None]).all()


@given(
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.floats(-math.pi, math.pi),
    st.floats(1.0, 4.0),
    st.floats(-math.pi, math.pi),
)
@settings(max_examples=60, deadline=None)
def test_body_is_seen_where_it_will_be(x, y, heading, way, bearing):
    """A disc that comes from where it leaves a gap is shown as rays meet it there, wherever the robot looks."""
    lidar = replace(BEAMS["turtlebot3"], mount=Pose(0.1, 0.05, 0.4))
    c, s = math.cos(heading), math.sin(heading)
    sensor = np.array((x + c * 0.1 - s * 0.05, y + s * 0.1 + c * 0.05))
    at = sensor + way * np.array((math.cos(bearing + heading + 0.4), math.sin(bearing + heading + 0.4)))
    speed = np.array((0.3, -0.2))
    person = tracked((*(at - 2.0 * speed), *speed, 0.3))
    bodies = bodies_of([person], [straight_predictions(person)], np.array((2.0,)))
    then = np.empty((1, 1, 90))
    empty = np.full((1, lidar.beams), np.inf, np.float32)
    predict_sector_ranges(empty, np.array(((x, y, heading),)), bodies, sectors_of(lidar, 90), 8.0, then)
    assert then.min() == pytest.approx(way - 0.3, abs=0.01)
    shown = np.flatnonzero(then[0, 0] < 8.0)
    assert len(shown) >= 1
    off = (lidar.angle_min + (4.0 * shown + 1.5) * lidar.angle_increment - bearing + math.pi) % (
        2.0 * math.pi
    ) - math.pi
    assert np.abs(off).max() <= math.asin(0.3 / way) + 0.05


def test_body_that_goes_leaves_what_is_behind_it():
    body, view = robot(), observation()
    ranges = ranges_of(view)
    ranges[:] = np.inf
    beam = body.lidar.beams // 2
    angle = body.lidar.angles()[beam]
    ranges[beam] = 2.0
    heading, mount = view.pose.theta + body.lidar.mount.theta, body.lidar.mount
    c, s = math.cos(view.pose.theta), math.sin(view.pose.theta)
    sensor = view.pose.x + c * mount.x - s * mount.y, view.pose.y + s * mount.x + c * mount.y
    at = sensor[0] + 2.3 * math.cos(angle + heading), sensor[1] + 2.3 * math.sin(angle + heading)
    encoder = built("rosnav_sectors", "differential", "foreseen=[1.0]")
    away = tracked((*at, 100.0, 0.0, 0.3))
    row = fields(encoder, encoder.encode(replace(batch_of(encoder, view), tracks=(away,)))[0])
    assert np.ptp(row["closeness"]) > 0.0
    assert np.ptp(row["closeness_1"]) == 0.0


def test_body_that_will_stand_on_the_sensor_is_seen_all_round():
    body, view = robot(), observation()
    ranges_of(view)[:] = np.inf
    encoder = built("rosnav_sectors", "differential", "foreseen=[1.0]")
    upon = tracked((view.pose.x - 1.0, view.pose.y, 1.0, 0.0, 0.5))
    row = fields(encoder, encoder.encode(replace(batch_of(encoder, view), tracks=(upon,)))[0])["closeness_1"]
    assert row == pytest.approx(2.0 * math.exp(body.footprint.radius) + body.footprint.radius / 8.0, rel=1e-5)

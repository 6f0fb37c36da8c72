import dataclasses
import math

import numpy as np
import pytest

from arena_core import ConfigurationError, Footprint, NoValidCommand, Pose, Tracks, Twist, VelocityLimits
from arena_mpc.interior_point import compiled_problem
from arena_mpc.plan import Solution
from arena_mpc.planner import MpcPlanner
from arena_mpc.shooting import solve_shooting

AHEAD = [(0.05 * k, 0.0) for k in range(50)]
ALL = ["turtlebot3", "jackal", "robotino", "jackal_ackermann"]


def _arc(twist, time):
    turn = twist.wz * time
    middle = Pose(0.0, 0.0, 0.5 * turn).compose(Pose(twist.vx * time, twist.vy * time))
    return Pose(middle.x, middle.y, turn)


def _drive(planner, view, path, pose, steps, window, twist=None, tracks=None, period=0.1):
    """Return the poses of a closed loop in which every command is obeyed at once."""
    twist, poses = twist or Twist(0.0), [pose]
    for k in range(steps):
        moved = tracks(k * period) if tracks else view.none
        try:
            twist = planner.compute_velocity(view(window, pose, path, twist, k * period, moved))
        except NoValidCommand:
            twist = Twist(0.0)
        pose = pose.compose(_arc(twist, period))
        poses.append(pose)
    return poses


@pytest.fixture
def view(observe, people):
    def _view(*arguments):
        return observe(*arguments)

    _view.none = people()
    return _view


def test_free_straight_path_is_driven_near_full_speed(build, costmap, observe):
    command = build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2)))
    assert command.vx > 0.95 * 0.22
    assert abs(command.wz) < 0.1


@pytest.mark.parametrize(
    ("robot", "preset"),
    [
        *((robot, preset) for robot in ALL for preset in ("mpc", "mpc_quadratic")),
        *(  # takes five times as long to solve
            pytest.param(robot, "mpc_as_released", marks=[pytest.mark.long] * (robot != "jackal")) for robot in ALL
        ),
    ],
)
def test_every_preset_drives_every_robot_to_its_goal(preset, robot, build, costmap, view):
    path = [(-0.5 + 0.1 * k, 0.0) for k in range(16)]
    poses = _drive(build(robot, preset), view, path, Pose(-0.5, 0.0, 0.3), 80, costmap())
    assert min(pose.distance(Pose(1.0, 0.0)) for pose in poses) < 0.3


@pytest.mark.parametrize("robot", ALL)
def test_robot_goes_round_a_box_on_its_path(robot, build, costmap, view):
    # one 5 cm further across stops a TurtleBot3: the path itself has to change
    window = costmap((0.2, 0.5, -0.25, 0.1), cells=120)
    path = [(-1.0 + 0.1 * k, 0.0) for k in range(30)]
    poses = _drive(build(robot), view, path, Pose(-0.5, 0.05), 90, window)
    assert max(pose.x for pose in poses) > 0.8
    assert all(_gap(pose, (0.2, 0.5, -0.25, 0.1)) > 0.1 for pose in poses)


def _gap(pose, box):
    return math.hypot(max(box[0] - pose.x, pose.x - box[1], 0.0), max(box[2] - pose.y, pose.y - box[3], 0.0))


@pytest.mark.parametrize("aside", [-0.2, 0.02])
def test_robot_leaves_the_way_of_a_person_who_walks_towards_it(aside, build, costmap, view, people):
    def tracks(time):
        return people((1.5 - 0.3 * time, aside, -0.3, 0.0))

    poses = _drive(build(), view, AHEAD, Pose(0.0, 0.0), 100, costmap(), tracks=tracks)
    gaps = [math.hypot(pose.x - 1.5 + 0.3 * 0.1 * k, pose.y - aside) for k, pose in enumerate(poses)]
    assert min(gaps) > 0.3 + 0.113
    assert poses[-1].x > 0.8  # and goes on behind the person


def test_prediction_looks_where_a_person_will_be(build, costmap, observe, people):
    crossing = people((0.8, 1.2, 0.0, -0.35))
    standing = people((0.8, 1.2, 0.0, 0.0))
    plans = []
    for tracks in (crossing, standing):
        planner = build()
        planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=tracks))
        plans.append(planner._plan)
    assert plans[0].step * (len(plans[0].states) - 1) > plans[1].step * (len(plans[1].states) - 1) + 0.1


def test_tracked_person_is_no_wall(build, costmap, observe, people):
    marks = costmap((0.5, 0.9, -0.3, 0.3))
    walking_off = people((0.7, 0.0, 0.5, 0.0))
    assert build().compute_velocity(observe(marks, Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=walking_off)).vx > 0.15


def test_robot_stops_before_a_wall_that_closes_the_way(build, costmap, view):
    poses = _drive(build(), view, AHEAD, Pose(0.0, 0.0), 120, costmap((1.0, 1.2, -3.0, 3.0)))
    assert max(pose.x for pose in poses) < 1.0 - 0.113
    assert max(pose.x for pose in poses) > 0.5


def test_enclosed_robot_brakes(build, costmap, observe):
    ring = costmap((-0.3, 0.3, 0.12, 0.3), (-0.3, 0.3, -0.3, -0.12), (0.12, 0.3, -0.3, 0.3), (-0.3, -0.12, -0.3, 0.3))
    try:
        command = build().compute_velocity(observe(ring, Pose(0.0, 0.0), AHEAD, Twist(0.0)))
    except NoValidCommand:
        return
    assert abs(command.vx) < 0.25 * 0.22


def test_robot_turns_toward_a_path_behind_it(build, costmap, view):
    poses = _drive(build(limits={"vx_min": 0.0}), view, [(-x, y) for x, y in AHEAD], Pose(0.0, 0.0), 80, costmap())
    assert math.cos(poses[-1].theta) < -0.8
    assert poses[-1].x < -0.3


def test_holonomic_robot_goes_sideways_where_that_is_useful(build, costmap, observe):
    command = build("robotino").compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), [(0.0, 0.1 * k) for k in range(20)])
    )
    assert command.vy > 0.1


def test_car_never_turns_tighter_than_it_can(build, costmap, observe, robots):
    planner, pose, twist = build("jackal_ackermann"), Pose(0.0, 0.0), Twist(0.0)
    radius = robots["jackal_ackermann"].wheelbase / math.tan(robots["jackal_ackermann"].steering_max)
    for k in range(30):
        twist = planner.compute_velocity(
            observe(costmap(), pose, [(0.0, 0.1 * k) for k in range(20)], twist, stamp=0.1 * k)
        )
        pose = pose.compose(_arc(twist, 0.1))
        assert abs(twist.wz) <= abs(twist.vx) / radius + 1e-6


def test_released_set_is_capped_whatever_the_robot_can_do(build, costmap, observe):
    for robot in ALL:
        planner = build(robot, "mpc_as_released")
        planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.39)))
        assert planner._plan.states[1:, 3].max() <= 0.4 + 1e-3


def test_commands_repeat_bit_for_bit(build, costmap, view, people):
    def drive(planner):
        window = costmap((0.6, 0.9, -0.4, 0.05))
        poses = _drive(
            planner, view, AHEAD, Pose(0.0, 0.0), 15, window, tracks=lambda t: people((2.0 - t, 0.3, -1.0, 0.0))
        )
        return [pose.array().tolist() for pose in poses]

    assert drive(build()) == drive(build())


FATROP = {"name": "fatrop"}


def test_second_planner_of_a_process_compiles_nothing(build, costmap, observe):
    build(solver=FATROP).compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD))
    before = compiled_problem.cache_info().misses
    build(solver=FATROP).compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD))
    assert compiled_problem.cache_info().misses == before


def test_resizing_never_waits_for_a_compiler(build, costmap, observe):
    planner = build(solver=FATROP)
    planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD))
    before = compiled_problem.cache_info().misses
    for stages in (10, 15, 25, 30):
        planner._optimiser._solvers[0].prepare(stages)
    assert compiled_problem.cache_info().misses == before


@pytest.mark.parametrize("escape_speed", [None, 0.3])
def test_failed_solver_is_answered_with_the_last_plan_then_with_a_way_out_or_the_brake(
    escape_speed, build, costmap, observe, monkeypatch
):
    planner = build(escape_speed=escape_speed)
    planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2)))
    expected = planner._plan.states[2, 3:]
    monkeypatch.setattr("arena_mpc.solvers.solve_shooting", lambda *_: Solution(None, math.inf, 1))
    command = planner.compute_velocity(observe(costmap(), Pose(0.02, 0.0), AHEAD, Twist(0.2), stamp=0.2))
    assert (command.vx, command.wz) == pytest.approx(expected.tolist(), abs=0.02)
    before_a_wall = observe(costmap((0.1, 0.3, -0.5, 0.5)), Pose(0.04, 0.0), AHEAD, Twist(0.2), stamp=0.3)
    if escape_speed is None:
        with pytest.raises(NoValidCommand, match="mpc"):
            planner.compute_velocity(before_a_wall)
    else:
        assert planner.compute_velocity(before_a_wall).vx < 0.0
    assert (planner.counts.optimised, planner.counts.shifted, planner.counts.refused) == (1, 1, 1)


def test_all_solvers_drive_alike_where_the_way_is_clear(build, costmap, observe, monkeypatch):
    seen = observe(costmap(), Pose(0.0, 0.1), AHEAD, Twist(0.2))
    fatrop = build(solver=FATROP).compute_velocity(seen)
    shooting = build().compute_velocity(seen)
    monkeypatch.setattr("arena_mpc.interior_point.has_solver", lambda name: False)
    planner = build(solver=FATROP)
    assert [solver._settings.name for solver in planner._optimiser._solvers] == ["ipopt"]
    ipopt = planner.compute_velocity(seen)
    assert (ipopt.vx, ipopt.wz) == pytest.approx((fatrop.vx, fatrop.wz), abs=0.01)
    assert (ipopt.vx, ipopt.wz) == pytest.approx((shooting.vx, shooting.wz), abs=0.05)


@pytest.mark.parametrize("most", [1, 7, 150])
@pytest.mark.parametrize("preset", ["mpc", "mpc_quadratic"])
def test_step_takes_no_more_iterations_than_allowed(preset, most, build, costmap, view, people, monkeypatch):
    taken = []

    def counted(*arguments):
        found = solve_shooting(*arguments)
        taken.append(found.iterations)
        return found

    monkeypatch.setattr("arena_mpc.solvers.solve_shooting", counted)
    planner = build("jackal", preset, solver={"max_iterations": most, "solution_iterations": min(most, 60)})
    window, pose = costmap((0.8, 1.0, -0.4, 0.1), cells=120), Pose(0.0, 0.0)
    for k in range(15):
        taken.clear()
        tracks = people((1.6 - 0.03 * k, 0.4, -0.3, -0.2), (1.2, -0.8 + 0.05 * k, 0.0, 0.5))
        _drive(planner, view, AHEAD, pose, 1, window, Twist(0.5), lambda _, seen=tracks: seen)
        pose = Pose(0.03 * k, 0.0)
        assert 0 < sum(taken) <= most


def test_interior_point_step_takes_no_more_iterations_than_allowed(build, costmap, observe):
    planner = build("turtlebot3", "mpc_as_released", solver={"max_iterations": 100})
    seen = observe(costmap((0.5, 0.6, -0.1, 0.1)), Pose(0.0, 0.0), AHEAD, Twist(0.1))
    state, optimiser = np.zeros(5), planner._optimiser
    scene, reference = _scene(planner, seen)
    assert (
        optimiser.optimise(scene, reference, state, planner._plan_along(reference.path, state), 100).iterations <= 100
    )
    assert optimiser.optimise(scene, reference, state, planner._plan_along(reference.path, state), 99).plan is None


def _scene(planner, seen):
    from arena_mpc.scene import scene_of

    scene = scene_of(seen, 0.0, moving=False)
    return scene, planner._local_reference(seen, scene)


def test_every_plan_keeps_to_speeds_and_accelerations(build, costmap, observe):
    for robot, slow in (("jackal", (4.0, 8.0)), ("robotino", (2.5, 2.5, 3.2))):
        for iterations in (1, 3, 60):
            planner = build(robot, solver={"max_iterations": 150, "solution_iterations": iterations})
            planner.compute_velocity(
                observe(costmap((0.8, 1.0, -0.4, 0.1), cells=120), Pose(0.0, 0.0), AHEAD, Twist(0.5))
            )
            velocities = planner._plan.states[:, 3:]
            assert (np.abs(np.diff(velocities, axis=0)) <= planner._plan.step * np.array(slow) + 1e-9).all()
            assert velocities[:, 0].max() <= 2.0 + 1e-9


def test_carried_on_plan_needs_fewer_iterations_than_a_new_one(build, costmap, observe):
    planner, state = build("jackal"), np.array((0.0, 0.0, 0.0, 0.5, 0.0))
    seen = observe(costmap((0.8, 1.0, -0.6, -0.3), cells=120), Pose(0.0, 0.0), AHEAD, Twist(0.5))
    scene, reference = _scene(planner, seen)
    fresh = planner._optimiser.optimise(scene, reference, state, planner._plan_along(reference.path, state), 150)
    again = planner._optimiser.optimise(scene, reference, state, fresh.plan, 150)
    assert again.iterations < fresh.iterations


def test_hard_distances_are_kept_by_every_stage(build, costmap, observe):
    box = (0.8, 0.9, 0.05, 0.3)
    planner = build("turtlebot3", "mpc_as_released")
    planner.compute_velocity(observe(costmap(box), Pose(0.0, 0.0), AHEAD, Twist(0.1)))
    gaps = [
        _gap(Pose(*stage[:3]), (box[0] + 0.025, box[1] - 0.025, box[2] + 0.025, box[3] - 0.025))
        for stage in planner._plan.states
    ]
    assert min(gaps) >= 0.2 - 2e-3
    goal = planner._plan.states[-1, :3]
    assert goal == pytest.approx((1.5, 0.0, 0.0), abs=0.06)


def test_released_set_holds_the_released_values(released):
    planner = released["planner"]
    assert released["control_period"] == 0.2
    assert released["replan"]["period"] == 1.0
    assert released["recoveries"]["behaviours"] == ["clear_far", "turn", "clear", "turn"]
    assert planner["solver"] == {"name": "ipopt", "max_iterations": 500, "solution_iterations": 100, "tolerance": 1e-4}
    limits = {name: planner["limits"][name] for name in ("vx_min", "vx_max", "wz_max", "ax_max", "alpha_max")}
    assert limits == {"vx_min": -0.2, "vx_max": 0.4, "wz_max": 0.3, "ax_max": 0.2, "alpha_max": 0.2}
    obstacles = {
        name: planner["obstacles"][name]
        for name in ("hard", "association", "min_distance", "cutoff", "forced_inclusion", "moving")
    }
    assert obstacles == {
        "hard": True, "association": "cells", "min_distance": 0.2, "cutoff": 2.5, "forced_inclusion": 0.5, "moving": 0,
    }  # fmt: skip
    assert (planner["look_ahead"], planner["final_state_fixed"], planner["weights"]["via_points"]) == (1.5, True, 10.5)
    grid = {name: planner["grid"][name] for name in ("stages", "stages_min", "stages_max", "step", "outer_iterations")}
    assert grid == {"stages": 20, "stages_min": 2, "stages_max": 50, "step": 0.3, "outer_iterations": 5}


@pytest.mark.parametrize(
    "change", [{"obstacles": {"hard": True}}, {"obstacles": {"association": "cells"}}, {"final_state_fixed": True}]
)
def test_shooting_refuses_what_needs_an_interior_point(change, build):
    with pytest.raises(ConfigurationError, match=r"solver\.name is shooting; allowed with .*: fatrop, ipopt"):
        build(**change)


@pytest.mark.parametrize("rows", [0, 1])
def test_path_of_no_or_one_pose_does_no_harm(rows, build, costmap, observe):
    path = [(0.5, 0.0)][:rows]
    if rows:
        assert build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), path)).vx > 0.0
        return
    with pytest.raises(NoValidCommand, match="path is empty"):
        build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), path))


def test_pose_that_is_no_number_is_refused(build, costmap, observe):
    with pytest.raises(NoValidCommand, match="not finite"):
        build().compute_velocity(observe(costmap(), Pose(math.nan, 0.0), AHEAD))


def test_goal_on_an_obstacle_is_approached_and_not_touched(build, costmap, view):
    box = (0.8, 1.1, -0.15, 0.15)
    poses = _drive(build(), view, [(0.05 * k, 0.0) for k in range(20)], Pose(0.0, 0.0), 100, costmap(box))
    assert all(_gap(pose, box) > 0.113 for pose in poses)
    assert max(pose.x for pose in poses) > 0.4


def test_two_hundred_clusters_are_no_trouble(build, costmap, observe, people):
    generator = np.random.default_rng(2)
    corners = generator.uniform(-2.9, 2.9, (200, 2))
    corners = corners[np.hypot(*corners.T) > 0.6]
    window = costmap(*((x, x + 0.1, y, y + 0.1) for x, y in corners))
    tracks = people(*((x, y, 0.1, -0.1) for x, y in corners))
    for seen in (people(), tracks):
        try:
            command = build().compute_velocity(observe(window, Pose(0.0, 0.0), AHEAD, Twist(0.1), tracks=seen))
        except NoValidCommand:
            continue
        assert np.isfinite(command.array()).all()


def test_tracks_that_are_no_numbers_are_ignored(build, costmap, observe):
    broken = Tracks(
        np.zeros(1, np.int32), np.full((1, 2), np.nan), np.zeros((1, 2)), np.full(1, 0.3), np.zeros((1, 4, 4))
    )
    assert build().compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.2), tracks=broken)).vx > 0.2


@pytest.mark.parametrize("key", ["vx_max", "wz_max", "ax_max", "alpha_max"])
def test_limit_of_zero_is_refused(key, build):
    with pytest.raises(ConfigurationError, match=rf"limits\.{key} is 0"):
        build(limits={key: 0.0})


def test_robot_without_sideways_limits_is_driven_all_the_same(planner_of, costmap, observe, robots):
    stiff = dataclasses.replace(robots["robotino"], limits=VelocityLimits(0.0, 1.0, 0.0, 1.0, 2.0, 0.0, 3.0))
    command = planner_of(stiff, limits={"vx_min": None, "vx_max": None, "vy_max": None}).compute_velocity(
        observe(costmap(), Pose(0.0, 0.0), AHEAD, Twist(0.9))
    )
    assert command.vx > 0.8
    assert abs(command.vy) < 0.01


@pytest.mark.parametrize(
    ("robot", "model"), [("jackal_ackermann", "unicycle"), ("turtlebot3", "omnidirectional"), ("robotino", "bicycle")]
)
def test_model_that_the_robot_cannot_follow_is_refused(robot, model, build):
    with pytest.raises(ConfigurationError, match=f"model is {model}; allowed for"):
        build(robot, model=model)


def test_unknown_kinematics_are_refused(planner_of, robots):
    flying = dataclasses.replace(robots["turtlebot3"], kinematics="flying")
    with pytest.raises(ConfigurationError, match="allowed: differential, ackermann, omnidirectional"):
        planner_of(flying)


def test_grid_outside_its_own_bounds_is_refused(build):
    with pytest.raises(ConfigurationError, match=r"grid\.stages is 99"):
        build(grid={"stages": 99})
    with pytest.raises(ConfigurationError, match=r"grid\.step is 9"):
        build(grid={"step": 9.0})


def test_reset_forgets_the_last_plan(build, costmap, observe, planner_of, robots):
    planner = planner_of(robots["turtlebot3"])
    assert isinstance(planner, MpcPlanner)
    seen = observe(costmap((0.6, 0.9, -0.4, 0.05)), Pose(0.0, 0.0), AHEAD, Twist(0.2))
    first = planner.compute_velocity(seen)
    planner.compute_velocity(observe(costmap(), Pose(0.3, 0.2, 1.0), AHEAD, Twist(0.0), stamp=0.1))
    planner.reset(_episode())
    assert planner.compute_velocity(seen) == first


def _episode():
    from arena_core import EpisodeStart

    return EpisodeStart(None, Pose(0.0, 0.0), 0.1, np.random.default_rng(0))


def test_long_robot_is_covered_by_its_discs(robots):
    from arena_mpc.footprint import covering_discs

    for count in (1, 2, 3):
        discs = covering_discs(robots["jackal_ackermann"].footprint, count)
        corners = robots["jackal_ackermann"].footprint.vertices_xy
        away = np.hypot(*(corners[:, None] - discs.centres_xy).transpose(2, 0, 1)).min(axis=1)
        assert len(discs.centres_xy) == count
        assert away.max() <= discs.radius + 1e-9
    assert covering_discs(Footprint.circle(0.2), None).radius == 0.2
    assert covering_discs(Footprint.circle(0.2), 0).radius == 0.0

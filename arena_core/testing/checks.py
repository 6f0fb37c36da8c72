"""The contract of every kind of component, as facts that are tried one after the other."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from copy import deepcopy
from dataclasses import replace
from typing import Any, get_args

import numpy as np

from arena_core.base.errors import ArenaError, ContractViolation, NoPath, NoValidCommand
from arena_core.base.random_streams import random_generator
from arena_core.contracts.learning import ObservationBatch, ObservationEncoder, ObservationField, Reward, ScanMemory
from arena_core.contracts.navigation import (
    GlobalPlanner,
    Localizer,
    LocalMap,
    PathBatch,
    Planner,
    Predictor,
    Tracker,
    WaypointGenerator,
)
from arena_core.contracts.running import Better, Executor, Job, Lost, Metric, MetricPack
from arena_core.contracts.simulation import Branches, PedestrianModel, RobotBatch, Simulator, TaskMode, WorldSource
from arena_core.contracts.truth import BrainPart
from arena_core.loop.extras import kept_candidates
from arena_core.loop.foreseeing import fault_of_predictions
from arena_core.loop.navigator import check_command
from arena_core.loop.world_truth import WorldTruth
from arena_core.runs.jobs.rows import TEXT
from arena_core.testing import samples
from arena_core.testing.steps import join_batches, transition
from arena_core.values.episode import Scenario
from arena_core.values.geometry import Footprint, Pose, Twist
from arena_core.values.predictions import Predictions
from arena_core.values.robot import Robot
from arena_core.values.sensing import Observation, Tracks
from arena_core.values.world import ABSENT, LETHAL, Costmap, Crowd, OccupancyGrid, Pedestrians

Facts = Iterator[tuple[str, bool]]
SLOT = np.zeros(1, np.int64)
BETTER = get_args(Better)


def check(kind: str, component: Any, body: Robot) -> list[str]:
    """Try every fact of a kind's contract and return them; raise ContractViolation at the first that does not hold."""
    held = []
    if isinstance(component, BrainPart) and component.privileged:
        component.see(samples.truth(body))
    for fact, holds in CHECKS[kind](component, body):
        if not holds:
            raise ContractViolation(f"{kind} {type(component).__name__}: not so: {fact}")
        held.append(fact)
    return held


def check_planner(planner: Planner, body: Robot) -> Facts:
    """Try a planner in the walled room."""
    views = _sample_views(body)
    first = _drive_planner(planner, body, views)
    yield "every command is a finite Twist, or NoValidCommand is raised", True
    yield "the same observations after a reset give the same commands", _drive_planner(planner, body, views) == first
    _drive_planner(planner, body, views[::-1])
    yield "nothing of one episode survives into the next", _drive_planner(planner, body, views) == first
    seen = [v.scan.ranges.copy() for v in views]
    _drive_planner(planner, body, views)
    yield "telling what it considered changes no command", _drive_planner(planner, body, views, tells=True) == first
    yield "observations are left as they are", all((a == v.scan.ranges).all() for a, v in zip(seen, views, strict=True))
    yield "a deep copy goes on as it would, and both apart", _copies_decide_alike(planner, body, views)
    planner.reset(samples.episode_start(body, known=False))
    _ask_planner(planner, samples.observation(body=body, known=False))
    yield "it works without a map", True
    progress = _measure_true_progress if planner.privileged else _measure_progress
    yield "it approaches a waypoint on a free, straight path", progress(planner, body) > 0.2


def check_robot(robot: Robot, body: Robot) -> Facts:
    """Look at a robot's figures."""
    yield "it is a Robot with a footprint", isinstance(robot, Robot) and isinstance(robot.footprint, Footprint)
    inscribed = robot.footprint.inscribed_radius
    yield "the inscribed radius is positive and not above the radius", 0.0 < inscribed <= robot.footprint.radius + 1e-9
    span = robot.lidar.angle_increment * (robot.lidar.beams - 1)
    yield "the lidar spans no more than a full turn", span <= 2.0 * math.pi + 1e-6
    ticks = np.array((robot.control_period, robot.lidar.period, robot.odometry.period)) / 0.01
    yield "periods are multiples of 10 ms", bool(np.allclose(ticks, np.round(ticks)))


def check_world(source: WorldSource, body: Robot) -> Facts:
    """Ask a source of worlds twice."""
    world, again = source.world(0, 0), source.world(0, 0)
    yield "it is the same world for the same seed and index", bool((world.grid.data == again.grid.data).all())
    yield "some cells are free", bool((world.grid.data == 0).any())


def check_task(task: TaskMode, body: Robot) -> Facts:
    """Draw scenarios."""
    one, same, other = task.scenario(3, 0), task.scenario(3, 0), task.scenario(3, 1)
    yield "a scenario is a pure function of seed and index", _same_scenario(one, same)
    yield "another index has another name", one.name != other.name or task.count() == 1
    cells = one.world.grid.cells([(one.start.x, one.start.y), (one.goal.x, one.goal.y)])
    inside = one.world.grid.contains(cells).all()
    yield (
        "start and goal lie on the map, on cells that are not occupied",
        bool(inside) and not one.world.grid.occupied[tuple(cells.T)].any(),
    )
    yield "people have numbers of their own", len({p.id for p in one.pedestrians}) == len(one.pedestrians)
    levels = rule.levels if (rule := task.staging()) else 0
    yield (
        "the scenarios of a level say which it is",
        all(task.at_stage(k).scenario(3, 0).stage == k for k in range(levels)),
    )


def check_localizer(localizer: Localizer, body: Robot) -> Facts:
    """Localise along a straight drive in the walled room."""
    truth = [Pose(-1.0 + 0.05 * k, 0.3, 0.1) for k in range(41)]
    estimates = _run_localizer(localizer, body, truth)
    yield "poses are finite", all(np.isfinite(e.pose.array()).all() for e in estimates)
    covariances = np.array([e.covariance for e in estimates])
    yield (
        "covariances are symmetric and not negative",
        bool(
            np.allclose(covariances, covariances.transpose(0, 2, 1))
            and (np.linalg.eigvalsh(covariances) >= -1e-9).all()
        ),
    )
    yield "the estimate stays within 0.2 m on clean sensors", estimates[-1].pose.distance(truth[-1]) < 0.2
    again = _run_localizer(localizer, body, truth)
    yield "the same sensors after a reset give the same poses", [e.pose for e in again] == [e.pose for e in estimates]


def check_global_planner(planner: GlobalPlanner, body: Robot) -> Facts:
    """Plan in the walled room, free and divided."""
    start, goal = Pose(-3.0, -2.0, 0.0), Pose(3.0, 2.0, 0.0)
    path = planner.plan(samples.room(), start, goal)
    ends = path.poses[[0, -1], :2] - [(start.x, start.y), (goal.x, goal.y)]
    yield "the path runs from start to goal", bool(np.hypot(*ends.T).max() < 0.1)
    yield "the path is hardly longer than the straight line in a free room", path.length < 1.1 * start.distance(goal)
    yield (
        "the same query gives the same path",
        bool((planner.plan(samples.room(), start, goal).poses == path.poses).all()),
    )
    data = samples.room().data.copy()
    data[:, data.shape[1] // 2] = 100
    try:
        planner.plan(OccupancyGrid(data, samples.room().resolution, samples.room().origin), start, goal)
        yield "a divided room raises NoPath", False
    except NoPath:
        yield "a divided room raises NoPath", True


def check_waypoints(generator_: WaypointGenerator, body: Robot) -> Facts:
    """Follow a straight path."""
    path = samples.straight_path(Pose(-4.0, 0.0), Pose(4.0, 0.0))
    generator_.reset(SLOT, 1)
    for k in range(8):
        found = generator_.next(PathBatch.of([path]), np.array(((-4.0 + k, 0.05, 0.0),)), np.array((float(k),)))
        ok = found.poses.shape == (1, 3) and found.status.shape == (1,) and int(found.status[0]) == 0
        yield f"a robot {k} m along the path gets a waypoint on the path, ahead", ok and found.poses[0, 0] > -4.0 + k
    generator_.reset(np.arange(2), 2)
    pair = generator_.next(PathBatch.of([path, path]), np.array(((-4.0, 0.0, 0.0), (0.0, 0.0, 0.0))), np.zeros(2))
    generator_.reset(SLOT, 1)
    alone = generator_.next(PathBatch.of([path]), np.array(((-4.0, 0.0, 0.0),)), np.zeros(1))
    yield "a robot among others gets what it would get alone", bool((pair.poses[0] == alone.poses[0]).all())


def check_local_map(local_map: LocalMap, body: Robot) -> Facts:
    """Look at the wall of the room."""
    pose = Pose(4.0, 0.0, 0.0)
    for grid in (samples.room(), None):
        local_map.reset(grid)
        yield (
            "the wall is lethal, the robot's own place is not",
            _shows_wall(local_map.update(samples.scan(pose, body), pose)),
        )
        goal = Pose(-4.0, 0.0)
        planning = local_map.planning_grid(goal, all_marks=True)
        holds_goal = isinstance(planning, OccupancyGrid) and bool(planning.contains(planning.cells((goal.x, goal.y))))
        yield "a planning grid that holds the goal comes from it", holds_goal
        local_map.clear(pose, 0.0)
        yield (
            "once cleared, it shows the wall again at the next scan",
            _shows_wall(local_map.update(samples.scan(pose, body), pose)),
        )


def _shows_wall(window: Costmap) -> bool:
    """Return whether the wall at x = 5 m is lethal, and the place of a robot at x = 4 m is not."""
    cells = ((np.array(((4.97, 0.0), (4.0, 0.0))) - window.origin_xy) / window.resolution).astype(int)
    wall = window.costs[cells[0, 1], cells[0, 0] - 1 : cells[0, 0] + 2].max()
    return bool(wall == LETHAL and window.costs[cells[1, 1], cells[1, 0]] < LETHAL)


def check_tracker(tracker: Tracker, body: Robot) -> Facts:
    """Look at a room in which no one moves."""
    tracker.reset(samples.room())
    tracks = [
        tracker.update(samples.scan(Pose(0.0, 0.0), body, stamp=0.1 * k), Pose(0.0, 0.0), 0.1 * k) for k in range(10)
    ][-1]
    n = len(tracks.ids)
    shapes = (tracks.positions.shape, tracks.velocities.shape, tracks.radii.shape, tracks.covariances.shape)
    yield (
        "tracks have the documented shapes",
        isinstance(tracks, Tracks) and shapes == ((n, 2), (n, 2), (n,), (n, 4, 4)),
    )
    yield "an empty room has no fast track", bool((np.hypot(*tracks.velocities.T) < 0.5).all())


def check_predictor(predictor: Predictor, body: Robot) -> Facts:
    """Watch people walk through the walled room."""
    views = [samples.observation(body=body, stamp=0.1 * k, tracks=samples.people(0.1 * k)) for k in range(6)]
    seen = [view.tracks.positions.copy() for view in views]
    said = _predict_all(predictor, views)
    for one, view in zip(said, views, strict=True):
        if fault := fault_of_predictions(one, view.tracks):
            raise ContractViolation(f"predictor {type(predictor).__name__}: predict returned {fault}")
    yield "predictions are finite, have the documented shapes and begin where the tracks are", True
    covariances = np.concatenate([one.covariances.reshape(-1, 2, 2) for one in said])
    even = np.allclose(covariances, covariances.transpose(0, 2, 1))
    yield "covariances are symmetric and not negative", bool(even and (np.linalg.eigvalsh(covariances) >= -1e-9).all())
    several = [one.weights for one in said if len(one.weights)]
    weighed = all((each >= 0.0).all() and np.allclose(each.sum(axis=0), 1.0) for each in several)
    yield "weights of alternatives are not negative and add up to 1", weighed
    yield "the same observations after a reset give the same predictions", _alike(_predict_all(predictor, views), said)
    left = all((a == view.tracks.positions).all() for a, view in zip(seen, views, strict=True))
    yield "observations are left as they are", left
    yield "a deep copy goes on as it would, and both apart", _copies_predict_alike(predictor, views)
    nobody = predictor.predict(samples.observation(body=body, stamp=1.0))
    yield "without tracks there are no predictions", len(nobody.means) == 0
    predictor.reset(None)
    unknown = samples.observation(body=body, tracks=samples.people(0.0), known=False)
    yield "it works without a map", not fault_of_predictions(predictor.predict(unknown), unknown.tracks)


def _predict_all(predictor: Predictor, views: Sequence[Observation]) -> list[Predictions]:
    predictor.reset(samples.room())
    return [predictor.predict(view) for view in views]


def _alike(ones: Sequence[Predictions], others: Sequence[Predictions]) -> bool:
    both = zip(ones, others, strict=True)
    return all((getattr(a, name) == getattr(b, name)).all() for a, b in both for name in Predictions.__slots__)


def _copies_predict_alike(predictor: Predictor, views: Sequence[Observation]) -> bool:
    """Return whether a copy that is asked first says what the predictor then does."""
    _predict_all(predictor, views[:3])
    twins = deepcopy(predictor), predictor
    first, then = ([one.predict(view) for view in views[3:]] for one in twins)
    return _alike(first, then)


def check_pedestrians(model: PedestrianModel, body: Robot) -> Facts:
    """Let three people walk in the room, or those whom the model puts there itself."""
    people = [samples.person(k, -2.0 + 2.0 * k, -2.0, (2.0 - k, 3.0), (-2.0, -2.0 - 0.5 * k)) for k in range(3)]
    problem = samples.scenario(people=people)
    begun, alone = model.reset(SLOT, [problem], 1).world(0), _walk_people(model, [problem])[0]
    yield (
        "people keep their numbers, and each has one",
        np.array_equal(alone.ids, begun.ids) and len(set(begun.ids.tolist())) == len(begun.ids),
    )
    there = np.isfinite(alone.positions).all(axis=1)
    yield "who is absent is at NaN, and no one else", bool((there == (alone.states != ABSENT)).all())
    starts = np.array([p.position_xy for p in people])
    if np.array_equal(begun.positions, starts):
        moved = np.hypot(*(alone.positions - starts).T)
        far = 1.8 * 0.5 * 4.0  # m: some models let people run, faster than they walk
        yield "a person walks, and no one faster than they may", bool((moved > 0.1).any() and (moved < far).all())
    else:
        yield (
            "people who are not the scenario's walk alike without those",
            _same_people(_walk_people(model, [samples.scenario()])[0], alone),
        )
    yield "the same start gives the same walk", _same_people(_walk_people(model, [problem])[0], alone)
    among = _walk_people(model, [samples.scenario(people=people[:1], name="other"), problem])[1]
    yield "a world among others gives what it gives alone", _same_people(among, alone)
    if type(model).fork is not PedestrianModel.fork:
        yield "a fork walks as the original would, and both go on apart", _forked_people_walk_alike(model, problem)


def check_simulator(simulator: Simulator, body: Robot) -> Facts:
    """Drive in the walled room."""
    problem = samples.scenario(people=[samples.person(1, 0.0, 3.0, (2.0, 3.0), (0.0, 3.0))])
    ticks = round(body.control_period / simulator.inner_step)
    first = simulator.reset([problem])
    yield (
        "an episode begins at its start, at rest, at stamp 0",
        first.state(0).pose == problem.start and first.state(0).stamp == 0.0,
    )
    command = np.array(((0.1, 0.0, 0.2),))
    states = [simulator.advance(command, ticks) for _ in range(20)]
    yield "stamps count the time", abs(states[-1].state(0).stamp - 20 * ticks * simulator.inner_step) < 1e-9
    yield "a commanded robot moves", states[-1].state(0).pose.distance(problem.start) > 0.05
    view = states[-1].sensors(0)
    yield (
        "a scan has the robot's beams and its own stamp",
        len(view.scan.ranges) == body.lidar.beams and view.scan.stamp <= view.stamp,
    )
    simulator.reset([samples.scenario(name="sample/1"), problem])
    pair = [simulator.advance(command.repeat(2, axis=0), ticks) for _ in range(20)][-1]
    same = pair.state(1).pose == states[-1].state(0).pose and (pair.sensors(1).scan.ranges == view.scan.ranges).all()
    yield "a world among others gives what it gives alone", bool(same)
    simulator.reset([replace(problem, speed_share=0.5)])
    fastest = max(simulator.advance(np.array(((9.0, 0.0, 0.0),)), ticks).state(0).twist.vx for _ in range(10))
    if type(simulator).fork is not Simulator.fork:
        yield "a fork does what the original does, and both go on apart", _fork_drives_alike(simulator, problem, ticks)
    share = 0.5 * body.limits.vx_max
    yield "a robot keeps to the scenario's share of its speed limits, within a hundredth", 0.0 < fastest <= 1.01 * share


def check_reward(reward: Reward, body: Robot) -> Facts:
    """Judge some steps, together and one by one."""
    together = transition(5)
    values = reward.reward(together)
    yield "it gives each robot a finite number", values.shape == (5,) and bool(np.isfinite(values).all())
    yield "the same step gives the same reward", bool((reward.reward(together) == values).all())
    alone = [reward.reward(transition(5, slice(k, k + 1)))[0] for k in range(5)]
    yield "a robot among others gets what it gets alone", bool((np.array(alone) == values).all())


def check_observation_encoder(encoder: ObservationEncoder, body: Robot) -> Facts:
    """Encode what a planner sees, together and one by one."""
    fields, views = encoder.layout(), _sample_views(body)
    batches, rows, recalled = [], [], encoder.blank(1)
    for k, view in enumerate(views):
        command = Twist(0.1, 0.0, 0.05 * k)
        batches.append(
            ObservationBatch.of(
                view, command, _make_memory(encoder, views[:k], view), recalled, tracked=encoder.tracked
            )
        )
        rows.append(encoder.encode(batches[-1]))
        recalled = rows[-1] if encoder.recurrent else recalled
    size = sum(field.size for field in fields)
    yield (
        "an observation is float32 and as long as the layout says",
        all(r.shape == (1, size) and r.dtype == np.float32 for r in rows),
    )
    yield "fields have names of their own, a unit, bounds and a meaning", _well_described(fields)
    low = np.concatenate([np.full(field.size, field.low, np.float32) for field in fields])
    high = np.concatenate([np.full(field.size, field.high, np.float32) for field in fields])
    yield "every number is within its bounds", all(bool(((r >= low) & (r <= high)).all()) for r in rows)
    together = encoder.encode(join_batches(batches))
    yield "an observation among others gives what it gives alone", bool((together == np.concatenate(rows)).all())
    yield "the result is new each time", not np.shares_memory(together, encoder.encode(join_batches(batches)))


def _make_memory(encoder: ObservationEncoder, before: Sequence[Observation], view: Observation) -> ScanMemory:
    """Return the memory of a robot that saw some views before this one."""
    memory = ScanMemory(encoder.lookback, 1, len(view.scan.ranges))
    for step, seen in enumerate((*before, view)):
        ranges, poses = seen.scan.ranges[None], seen.pose.array()[None]
        memory.remember(ranges, poses) if step else memory.begin(np.zeros(1, np.int64), ranges, poses)
    return memory


def check_metrics(pack: MetricPack, body: Robot) -> Facts:
    """Evaluate small records: without and with a contact, and of a person who leaves."""
    metrics = pack.metrics()
    yield "names are unique", len({m.name for m in metrics}) == len(metrics)
    yield "every metric has a unit and a description", all(m.unit and m.description for m in metrics)
    yield f"better is {', '.join(BETTER)}", all(m.better in BETTER for m in metrics)
    for sample in (samples.record(), samples.record(contact=True), samples.record(contact=True, leaves=True)):
        values = [m.compute(sample) for m in metrics]
        yield "every value is a text in unit text, else a number", all(map(_fits_unit, metrics, values))
        again = [m.compute(sample) for m in metrics]
        yield "the same record gives the same values", [repr(v) for v in again] == [repr(v) for v in values]


def _fits_unit(metric: Metric, value: Any) -> bool:
    """Return whether a value is what the metric's unit says, and nothing infinite."""
    text = isinstance(value, str)
    return text == (metric.unit == TEXT) and (text or (isinstance(float(value), float) and not math.isinf(value)))


def check_executor(executor: Executor, body: Robot) -> Facts:
    """Run tiny jobs, in two rounds."""
    with closing(executor):
        for jobs in (range(3), range(3, 5)):
            rows = list(executor.map(echo_job, [Job({}, "", k) for k in jobs]))
            yield (
                "every job gives one row",
                sorted(row["episode"] for row in rows if not isinstance(row, Lost)) == list(jobs),
            )


def echo_job(job: Job) -> dict[str, Any]:
    """Return a job's number: the smallest work that there is."""
    return {"episode": job.episode}


CHECKS: dict[str, Callable[[Any, Robot], Facts]] = {
    "planner": check_planner,
    "robot": check_robot,
    "world": check_world,
    "task": check_task,
    "localizer": check_localizer,
    "global_planner": check_global_planner,
    "waypoints": check_waypoints,
    "local_map": check_local_map,
    "tracker": check_tracker,
    "predictor": check_predictor,
    "pedestrians": check_pedestrians,
    "simulator": check_simulator,
    "reward": check_reward,
    "observation_encoder": check_observation_encoder,
    "metrics": check_metrics,
    "executor": check_executor,
}


def _sample_views(body: Robot) -> list[Observation]:
    here = Pose(0.0, 0.0, 0.0)
    walled = samples.walled_costmap(here, body.footprint.inscribed_radius)
    return [
        samples.observation(body=body),
        samples.observation(body=body, twist=Twist(0.2, 0.0, 0.1), stamp=0.1),
        samples.observation(body=body, waypoint=Pose(-2.0, 0.1), goal=Pose(-3.0, 0.1), stamp=0.2),
        samples.observation(body=body, goal=Pose(0.05, 0.0), waypoint=Pose(0.05, 0.0), stamp=0.3),
        samples.observation(body=body, costmap=walled, stamp=0.4),
        samples.observation(body=body, pose=Pose(4.6, 0.0, 0.0), stamp=0.5),
    ]


def _well_described(fields: Sequence[ObservationField]) -> bool:
    named = len({field.name for field in fields}) == len(fields)
    return named and all(field.size > 0 and field.low < field.high and field.unit and field.meaning for field in fields)


def _drive_planner(
    planner: Planner, body: Robot, views: Sequence[Observation], *, tells: bool = False
) -> list[Twist | None]:
    planner.reset(samples.episode_start(body))
    return [_ask_planner(planner, view, tells=tells) for view in views]


def _copies_decide_alike(planner: Planner, body: Robot, views: Sequence[Observation]) -> bool:
    """Return whether a copy that is asked first answers as the planner then does."""
    planner.reset(samples.episode_start(body))
    for view in views[:3]:
        _ask_planner(planner, view)
    twins = deepcopy(planner), planner
    first, then = ([_ask_planner(one, view) for view in views[3:]] for one in twins)
    return first == then


def _ask_planner(planner: Planner, view: Observation, *, tells: bool = False) -> Twist | None:
    try:
        try:
            return check_command(planner.compute_velocity(view), planner)
        except NoValidCommand:
            return None
        finally:
            if tells:
                kept_candidates(planner.considered(), type(planner).__name__)
    except ArenaError as error:
        raise ContractViolation(str(error)) from error


def _measure_progress(planner: Planner, body: Robot) -> float:
    """Return how far 3 s of obeyed commands bring a robot along a straight, free path, as a part of the possible."""
    planner.reset(samples.episode_start(body))
    pose, twist, goal = Pose(-2.5, 0.0, 0.0), Twist(0.0), Pose(2.5, 0.0, 0.0)
    steps = round(3.0 / body.control_period)
    for k in range(steps):
        view = samples.observation(pose, Pose(pose.x + 2.0, 0.0), goal, twist, body, stamp=k * body.control_period)
        twist = _ask_planner(planner, view) or Twist(0.0)
        turned = Pose(pose.x, pose.y, pose.theta + 0.5 * twist.wz * body.control_period)
        moved = turned.compose(Pose(twist.vx * body.control_period, twist.vy * body.control_period))
        pose = Pose(moved.x, moved.y, pose.theta + twist.wz * body.control_period)
    return (pose.x + 2.5) / min(5.0, 3.0 * body.limits.vx_max)


def _measure_true_progress(planner: Planner, body: Robot) -> float:
    """Return how much nearer 3 s bring a robot to the goal of the world whose truth its planner sees, as a part of the
    possible.
    """
    loop, slot, problem = samples.driven_room(body)
    planner.see(WorldTruth(loop, slot, problem))
    planner.reset(samples.episode_start(body))
    before, steps = float(loop.goal_distances()[slot]), round(3.0 / body.control_period)
    for k in range(steps):
        state = loop.snapshot.state(slot)
        view = samples.observation(
            state.pose, problem.goal, problem.goal, state.twist, body, stamp=k * body.control_period
        )
        loop.drive((_ask_planner(planner, view) or Twist(0.0)).array()[None])
    return (before - float(loop.goal_distances()[slot])) / min(before, 3.0 * body.limits.vx_max)


def _run_localizer(localizer: Localizer, body: Robot, truth: Sequence[Pose]) -> list[Any]:
    localizer.reset(samples.room(), truth[0], random_generator(0, "sample/0", "localizer"))
    return [localizer.update(samples.sensors(pose, body, 0.1 * k, Twist(0.5))) for k, pose in enumerate(truth)]


def _walk_people(model: PedestrianModel, scenarios: Sequence[Scenario]) -> list[Pedestrians]:
    """Return the people of each world after 4 s."""
    n = len(scenarios)
    crowd = _walk_on(model, model.reset(np.arange(n), scenarios, n), range(100))
    return [crowd.world(k) for k in range(n)]


def _walk_on(model: PedestrianModel, crowd: Crowd, ticks: range) -> Crowd:
    """Return the crowd after so many steps of 0.04 s, beside robots that stand."""
    n = len(crowd.counts)
    robots = RobotBatch(np.tile((4.0, -4.0, 0.0), (n, 1)), np.zeros((n, 2)), 0.2)
    for k in ticks:
        crowd = model.step(crowd, robots, np.full(n, k, np.int64), 0.04)
    return crowd


def _forked_people_walk_alike(model: PedestrianModel, problem: Scenario) -> bool:
    """Return whether two forks of a walk, driven one after the other, end where the walk itself ends."""
    crowd = _walk_on(model, model.reset(SLOT, [problem], 1), range(50))
    models = [model.fork(Branches.of([0])), model.fork(Branches.of([0])), model]
    first, second, own = (_walk_on(one, crowd, range(50, 100)).world(0) for one in models)
    return _same_people(first, own) and _same_people(second, own)


def _fork_drives_alike(simulator: Simulator, problem: Scenario, ticks: int) -> bool:
    """Return whether a fork of two branches, driven first, is where the original is then."""
    simulator.reset([problem])
    command = np.array(((0.1, 0.0, 0.2),))
    for _ in range(5):
        simulator.advance(command, ticks)
    fork = simulator.fork(Branches.of([0, 0]))
    pair = [fork.advance(command.repeat(2, axis=0), ticks) for _ in range(5)][-1]
    last = [simulator.advance(command, ticks) for _ in range(5)][-1]
    return all(
        pair.state(k).pose == last.state(0).pose
        and _same_people(pair.state(k).pedestrians, last.state(0).pedestrians)
        and bool((pair.ranges[k] == last.ranges[0]).all())
        for k in range(2)
    )


def _same_people(one: Pedestrians, other: Pedestrians) -> bool:
    return bool(np.array_equal(one.ids, other.ids) and np.array_equal(one.positions, other.positions, equal_nan=True))


def _same_scenario(one: Scenario, other: Scenario) -> bool:
    people = zip(one.pedestrians, other.pedestrians, strict=True)
    same_people = all(
        (a.position_xy == b.position_xy).all() and np.array_equal(a.waypoints_xy, b.waypoints_xy) for a, b in people
    )
    return (one.name, one.start, one.goal) == (other.name, other.start, other.goal) and same_people

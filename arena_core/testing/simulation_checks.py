"""The contracts of what is simulated: robots, worlds, tasks, people, simulators."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arena_core.contracts.simulation import Branches, PedestrianModel, RobotBatch, Simulator, TaskMode, WorldSource
from arena_core.testing import samples
from arena_core.testing.facts import Facts
from arena_core.values.doors import Door
from arena_core.values.episode import Scenario
from arena_core.values.geometry import Footprint
from arena_core.values.robot import Robot
from arena_core.values.world import ABSENT, Crowd, Pedestrians

SLOT = np.zeros(1, np.int64)


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


def _same_scenario(one: Scenario, other: Scenario) -> bool:
    people = zip(one.pedestrians, other.pedestrians, strict=True)
    same_people = all(
        (a.position_xy == b.position_xy).all() and np.array_equal(a.waypoints_xy, b.waypoints_xy) for a, b in people
    )
    return (one.name, one.start, one.goal) == (other.name, other.start, other.goal) and same_people


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
    leaf = Door(np.array([[3.0, 3.0], [4.0, 3.0], [4.0, 3.1]]), np.array([[0.0, 0.5 * ticks * simulator.inner_step]]))
    opened = simulator.reset([replace(problem, doors=(leaf,))]).doors_open
    if opened is not None:
        closed = simulator.advance(command, ticks).doors_open
        yield (
            "a door is open by its timetable, then closed",
            bool(opened[0, 0] and closed is not None and not closed[0, 0]),
        )
    share = 0.5 * body.limits.vx_max
    yield "a robot keeps to the scenario's share of its speed limits, within a hundredth", 0.0 < fastest <= 1.01 * share


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

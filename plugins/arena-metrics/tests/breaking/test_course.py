"""From numbers to problems: whatever the numbers, common sense holds."""

import numpy as np
import pytest

from arena_break.course import without_person
from arena_core import ConfigurationError
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.scenario_files.feasibility import Feasibility


@pytest.fixture(scope="module")
def course(course_of):
    return course_of()


@pytest.fixture(scope="module")
def drafts(course):
    random = np.random.default_rng(1)
    found = [course.draft(random.random(course.bounds.genes), f"p{i}") for i in range(60)]
    return [one for one in found if one is not None]


def ends_of(problem):
    return np.array([(problem.start.x, problem.start.y), (problem.goal.x, problem.goal.y)])


def test_most_numbers_make_a_problem_that_can_be_run(course, drafts):
    assert len(drafts) >= 40
    for one in drafts:
        assert Feasibility("f.json", one.problem, course.robot, 0.3)(course.world.grid)


def test_start_and_goal_are_as_far_apart_as_the_bounds_want(course, drafts):
    limits = course.bounds.robot
    away = [float(np.hypot(*np.diff(ends_of(one.problem), axis=0)[0])) for one in drafts]
    assert min(away) >= limits.min_distance - 1e-3
    assert max(away) <= limits.max_distance + 1e-3


def test_people_walk_on_free_ground_at_a_walk_and_keep_off_start_and_goal(course, drafts):
    limits, space = course.bounds.people, course.world.grid.derive(FreeSpace)
    for one in drafts:
        people = one.problem.pedestrians
        assert 1 <= len(people) <= limits.most
        for person in people:
            way = np.linspace(*person.waypoints_xy, 200)
            assert limits.slowest <= person.desired_speed <= limits.fastest
            assert space.has_room(way, limits.clearance - 0.01).all()
            away = np.hypot(*(way[:, None] - ends_of(one.problem)).transpose(2, 0, 1))
            assert away.min() >= limits.keep_off - 0.06  # places are looked at every .05 m
            assert np.hypot(*np.diff(person.waypoints_xy, axis=0)[0]) >= 2.0 * limits.reach_min - 0.01
            assert np.hypot(*(person.position_xy - ends_of(one.problem)[0])) >= limits.spawn_distance
        positions = np.array([person.position_xy for person in people])
        gaps = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1)) + 9.0 * np.eye(len(people))
        assert gaps.min() >= limits.apart - 1e-3


def test_a_person_comes_to_the_robots_way_when_its_numbers_say(course):
    """Half-way along, at a right angle, no sooner and no later than the robot: worked out by hand."""
    genes = np.full(course.bounds.genes, 0.5)
    genes[:6] = 0.1, 0.5, 0.0, 0.2, 0.0, 0.5  # start on the left, goal to the right, one person, half-way
    genes[6] = 0.75  # a quarter turn to the left
    draft = course.draft(genes, "one")
    (person,) = draft.problem.pedestrians
    middle = draft.route[len(draft.route) // 2]
    moment = 0.5 * np.hypot(*np.diff(draft.route, axis=0).T).sum() / (0.6 * course.robot.limits.vx_max)
    first = person.waypoints_xy[0]
    path = [person.position_xy]
    for _ in range(round(moment / 0.001)):  # walk to and fro in steps of a millisecond
        step = first - path[-1]
        if np.hypot(*step) <= 0.001 * person.desired_speed:
            first = person.waypoints_xy[1] if np.allclose(first, person.waypoints_xy[0]) else person.waypoints_xy[0]
            step = first - path[-1]
        path.append(path[-1] + 0.001 * person.desired_speed * step / np.hypot(*step))
    assert np.hypot(*(path[-1] - middle)) < 0.15
    assert abs(np.diff(person.waypoints_xy, axis=0)[0] @ (draft.route[-1] - draft.route[0])) < 1.0


def test_the_same_numbers_are_the_same_problem(course):
    random = np.random.default_rng(3)
    many = random.random((20, course.bounds.genes))
    pairs = [(course.draft(genes, "p"), course.draft(genes, "p")) for genes in many]
    one, other = next(pair for pair in pairs if pair[0] is not None)
    assert (one.problem.start, one.problem.goal) == (other.problem.start, other.problem.goal)
    for mine, theirs in zip(one.problem.pedestrians, other.problem.pedestrians, strict=True):
        assert np.array_equal(mine.waypoints_xy, theirs.waypoints_xy)


def test_a_world_without_room_is_refused_in_one_line(course_of):
    with pytest.raises(ConfigurationError, match="world is room, in which jackal has no start and goal 8 m apart"):
        course_of(4.0, 4.0)
    with pytest.raises(ConfigurationError, match="allowed: a larger world"):
        course_of(0.3, 0.3)


def test_a_problem_without_one_of_its_people_has_the_others(drafts):
    problem = next(one.problem for one in drafts if len(one.problem.pedestrians) > 1)
    less = without_person(problem, 0, "less")
    assert [person.id for person in less.pedestrians] == list(range(len(problem.pedestrians) - 1))
    assert np.array_equal(less.pedestrians[0].position_xy, problem.pedestrians[1].position_xy)
    assert (less.name, less.start, less.goal) == ("less", problem.start, problem.goal)

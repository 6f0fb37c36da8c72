import numpy as np
import pytest

from arena_core import Crowd


def gaps(crowd, robots):
    """Return the gaps between people (radius 0.3 m) and the robot of their world, (N, P)."""
    return np.hypot(*(crowd.positions - robots.poses[:, None, :2]).transpose(2, 0, 1)) - 0.3 - robots.radius


def as_simulated(crowd, robots):
    """Return the crowd with people moved out of the robot, as a simulator does."""
    gap = gaps(crowd, robots)
    away = crowd.positions - robots.poses[:, None, :2]
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    positions = crowd.positions + np.maximum(-gap, 0.0)[..., None] * away
    return Crowd(crowd.counts, crowd.ids, positions, crowd.velocities, crowd.radii, crowd.states)


def crowds_among_racks(stage, robot_radius):
    """Return eight worlds of ten people and a robot that stands on free ground, at
    least half a metre from all of them.
    """
    hall = stage.hall(20, 20, stage.racks)
    scenarios = [stage.crowded(hall, 10, seed) for seed in range(8)]
    poses = []
    for seed, scenario in enumerate(scenarios):
        starts = np.array([spec.position_xy for spec in scenario.pedestrians])
        for place in stage.free_places(hall, 100, np.random.default_rng(seed), 0.0):
            if np.hypot(*(starts - place).T).min() > 0.3 + robot_radius + 0.5:
                poses.append((*place, 0.0))
                break
    return scenarios, stage.robots(poses, radius=robot_radius, worlds=8)


@pytest.mark.parametrize("radius", [0.113, 0.27])
def test_a_standing_robot_among_ten_people_is_never_touched_in_three_minutes(stage, make_model, radius):
    scenarios, robots = crowds_among_racks(stage, radius)
    least = np.full(8, np.inf)
    for crowd in stage.walk(make_model(reaction="yield"), scenarios, 180.0, robots):
        least = np.minimum(least, gaps(crowd, robots).min(axis=1))
    assert (least > 0.0).all()
    assert (least < 0.5).sum() >= 4  # people did come by


def test_the_same_robot_is_walked_into_by_people_who_ignore_it(stage, make_model):
    scenarios, robots = crowds_among_racks(stage, 0.27)
    touched = np.zeros(8, bool)
    for crowd in stage.walk(make_model(reaction="ignore"), scenarios, 180.0, robots):
        touched |= (gaps(crowd, robots) < 0.0).any(axis=1)
    assert touched.sum() >= 4


@pytest.mark.parametrize("preset", ["social_force", "social_force_as_released"])
def test_people_who_ignore_robots_walk_alike_whatever_these_do(stage, make_model, preset):
    scenario = stage.crowded(stage.hall(12, 12, [(5, 5, 7, 7)]), 12, 5)
    quiet, busy = make_model(preset), make_model(preset)
    one = quiet.reset(np.zeros(1, int), [scenario], 1)
    other = busy.reset(np.zeros(1, int), [scenario], 1)
    random = np.random.default_rng(0)
    for tick in range(600):
        one = quiet.step(one, stage.robots(), np.full(1, tick), 0.05)
        other = busy.step(
            other, stage.robots(random.uniform(0, 12, 3), random.normal(size=2), 0.3), np.full(1, tick), 0.05
        )
        assert one.positions.tobytes() == other.positions.tobytes()
        assert one.velocities.tobytes() == other.velocities.tobytes()


@pytest.mark.parametrize("aside", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("speed", [0.3, 1.3])
def test_people_go_round_a_robot_that_stands_in_their_way(stage, make_model, speed, aside):
    scenario = stage.scenario(stage.hall(12, 6), [stage.person(0, (2, 3), (10, 3), (2, 3), speed=speed)])
    robots = stage.robots((6.0, 3.0 + aside, 0.0), radius=0.25)
    walk = list(stage.walk(make_model(reaction="yield"), scenario, 10.0 / speed, robots))
    positions = np.array([crowd.positions[0, 0] for crowd in walk])
    assert min(gaps(crowd, robots).min() for crowd in walk) > 0.1
    assert np.hypot(*(positions - (10.0, 3.0)).T).min() < 0.5
    passing = positions[np.argmin(np.abs(positions[:, 0] - 6.0)), 1] - robots.poses[0, 1]
    # on the free side, on the right if there is no difference
    assert passing * aside < 0.0 or (aside == 0.0 and passing < 0.0)


def test_people_stop_before_a_robot_that_fills_an_aisle_and_then_turn_back(stage, make_model):
    scenario = stage.scenario(stage.hall(12, 1.1), [stage.person(0, (2, 0.55), (10, 0.55), (1, 0.55), speed=1.0)])
    robots = stage.robots((6.0, 0.55, 0.0), radius=0.25)
    walk = list(stage.walk(make_model(reaction="yield"), scenario, 20.0, robots))
    assert 0.0 < min(gaps(crowd, robots).min() for crowd in walk) < 0.3
    positions = np.array([crowd.positions[0, 0, 0] for crowd in walk])
    assert positions[positions.argmax() :].min() < 2.0


def test_people_step_back_from_a_robot_that_comes_slowly(stage, make_model):
    scenario = stage.scenario(stage.hall(12, 6), [stage.person(0, (6, 3), speed=0.5)])
    model = make_model(reaction="yield")
    crowd = model.reset(np.zeros(1, int), [scenario], 1)
    for tick in range(300):
        robots = stage.robots((3.0 + 0.2 * 0.05 * tick, 3.0, 0.0), (0.2, 0.0), 0.25)
        crowd = model.step(crowd, robots, np.full(1, tick), 0.05)
        assert gaps(crowd, robots).min() > 0.05
    assert crowd.positions[0, 0, 0] > 6.2


def test_a_robot_that_drives_blindly_meets_fewer_people_who_yield(stage, make_model):
    def contacts(reaction: str) -> int:
        hall = stage.hall(20, 20)
        scenarios = [stage.crowded(hall, 10, seed, speed=1.0) for seed in range(8)]
        model = make_model(reaction=reaction)
        crowd, touching, events = model.reset(np.arange(8), scenarios, 8), np.ones(8, bool), 0
        for tick in range(1200):
            robots = stage.robots((2.0 + 0.5 * 0.05 * (tick % 640), 10.0, 0.0), (0.5, 0.0), 0.25, worlds=8)
            crowd = model.step(crowd, robots, np.full(8, tick), 0.05)
            now = (gaps(crowd, robots) < 0.0).any(axis=1)
            crowd = as_simulated(crowd, robots)
            events += int((now & ~touching).sum())
            touching = now
        return events

    assert contacts("ignore") >= 10
    assert contacts("yield") <= 1


def test_the_robot_factor_of_the_scenario_file_counts(stage, make_model):
    def nearest(**behaviour: float) -> float:
        scenario = stage.scenario(stage.hall(12, 8), [stage.person(0, (2, 3), (10, 3), (2, 3), **behaviour)])
        robots = stage.robots((6.0, 4.2, 0.0), radius=0.25)
        return min(
            gaps(crowd, robots).min() for crowd in stage.walk(make_model(reaction="yield"), scenario, 8.0, robots)
        )

    assert nearest(force_factor_robot=10.0) > nearest(force_factor_robot=0.0) + 0.1

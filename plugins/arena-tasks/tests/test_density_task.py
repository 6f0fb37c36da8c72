"""Random problems of a density: so many people as the free ground has room for, on the same map, start and goal."""

import pytest

from arena_core import ConfigurationError, ImpossibleScenario, World, WorldSource, testing
from arena_core.scenes import free_area
from arena_core.testing import component
from arena_tasks.random.density_task import DensityTask


class Halls(WorldSource):
    """Give a larger room each time."""

    def world(self, seed: int, index: int) -> World:
        return World("hall", testing.room(12.0 + 4.0 * index))


def task(density: float, **changes: object) -> DensityTask:
    words = [f"task.random.{key}={value}" for key, value in changes.items()]
    found = component("task", "density", [f"task.density={density}", *words], robot=testing.robot(), world=Halls())
    assert isinstance(found, DensityTask)
    return found


@pytest.mark.parametrize("density", [0.0, 1.0, 4.0, 8.0])
@pytest.mark.parametrize("index", [0, 2])
def test_people_follow_from_the_free_ground(density, index):
    scenario = task(density).scenario(0, index)
    area = scenario.world.grid.derive(free_area)
    assert len(scenario.pedestrians) == round(density * area / 100.0)


def test_map_start_and_goal_are_the_same_at_every_density():
    few, many = task(1.0).scenario(3, 1), task(6.0).scenario(3, 1)
    assert (few.start, few.goal) == (many.start, many.goal)
    assert few.name == many.name == "density/0001"
    assert len(few.pedestrians) < len(many.pedestrians)


def test_more_people_than_have_room_are_impossible():
    with pytest.raises(ImpossibleScenario, match="density/0000"):
        task(300.0, tries=1).scenario(0, 0)


def test_it_is_made_of_random_problems_alone():
    with pytest.raises(ConfigurationError, match="allowed: random"):
        DensityTask(Halls(), 1.0, None, task(1.0))


def test_rung_of_a_ladder_is_a_stage_so_that_its_episodes_have_no_pairs():
    assert task(1.0).scenario(0, 0).stage == -1
    rung = component("task", "density", ["task.rung=3"], robot=testing.robot(), world=Halls())
    assert rung.scenario(0, 0).stage == 3

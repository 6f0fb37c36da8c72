"""The paper's experiment and its variants compose, and are what docs/claims.md says of them."""

import math
from functools import cache
from itertools import zip_longest

import pytest

from arena_core.hosting import compose, to_plain

EXPERIMENTS = {
    "paper": (7, 3, 3, 2),
    "paper_presets": (4, 3, 3, 2),
    "paper_worlds": (7, 3, 2, 2),
    "paper_lifelike": (7, 3, 3, 2),
    "paper_lab": (3, 2),
    "paper_real": (3, 2),
}


@cache
def composed(experiment):
    return compose([f"experiment={experiment}"], hydra=True)


def settings(experiment):
    return to_plain(compose([f"experiment={experiment}"]))


@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_a_multirun_of_so_many_cells(experiment):
    config = composed(experiment)
    assert config.hydra.mode.name == "MULTIRUN"
    lists = [len(str(values).split(",")) for values in config.hydra.sweeper.params.values()]
    assert sorted(lists) == sorted(EXPERIMENTS[experiment])


def test_the_papers_own_has_as_many_episodes_as_the_paper():
    config = composed("paper")
    assert math.prod(EXPERIMENTS["paper"]) * config.episodes == 1890
    assert config.localizer.name == "amcl"
    assert config.task.people.speed == 0.3


def test_variants_differ_in_what_they_are_named_for():
    assert settings("paper_lifelike")["task"]["people"]["speed"] == 1.34
    assert settings("paper_lifelike")["pedestrians"]["reaction"] == "yield"
    lab, real = settings("paper_lab"), settings("paper_real")
    assert (lab["timing"]["mode"], real["timing"]["mode"]) == ("ideal", "latency")
    assert real["robot"]["lidar"]["noise_std"] > lab["robot"]["lidar"]["noise_std"]
    assert (lab["pedestrians"]["reaction"], real["pedestrians"]["reaction"]) == ("ignore", "yield")
    assert lab["world"]["name"] == "lab"


@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_every_planner_world_and_robot_of_it_is_installed(experiment):
    params = composed(experiment).hydra.sweeper.params
    groups = [group for group in ("planner", "robot", "world") if group in params]
    columns = [str(params[group]).split(",") for group in groups]
    for options in zip_longest(*columns):  # each in one composition, beside one of each other group
        words = [f"{group}={option}" for group, option in zip(groups, options, strict=True) if option]
        compose([f"experiment={experiment}", *words])

"""Worlds of several kinds in turn."""

import pytest

from arena_core import ConfigurationError, World, WorldSource
from arena_core.testing import component, room
from arena_worlds.generators.mixed import MixedWorlds


class Numbered(WorldSource):
    def __init__(self, name, difficulty=0.5):
        self.name, self.difficulty = name, difficulty

    def world(self, seed, index):
        return World(f"{self.name}/{index}/{self.difficulty}", room())

    def at(self, difficulty):
        return Numbered(self.name, difficulty)


def mixture(regenerate=1, known=True):
    return MixedWorlds({"a": Numbered("a"), "b": Numbered("b"), "c": Numbered("c")}, regenerate, known=known)


def test_every_member_gets_about_its_share_of_the_worlds():
    names = [mixture().world(3, i).name[0] for i in range(300)]
    assert all(70 <= names.count(member) <= 130 for member in "abc")


def test_same_seed_gives_the_same_worlds_and_another_seed_others():
    worlds = [[mixture().world(seed, i).name for i in range(20)] for seed in (1, 1, 2)]
    assert worlds[0] == worlds[1] != worlds[2]


def test_world_stays_for_as_many_scenarios_as_asked():
    names = [mixture(regenerate=5).world(0, i).name for i in range(15)]
    assert [len(set(names[k : k + 5])) for k in (0, 5, 10)] == [1, 1, 1]
    assert len(set(names)) == 3
    assert len({mixture(regenerate=None).world(0, i).name for i in range(10)}) == 1


def test_difficulty_is_that_of_all_members():
    assert all(mixture().at(0.9).world(0, i).name.endswith("/0.9") for i in range(9))


def test_member_without_difficulty_is_refused_when_asked_for_one():
    source = component("world", "mixed", ["+world@world.members.warehouse=warehouse"])
    with pytest.raises(ConfigurationError, match="has none"):
        source.at(0.3)


def test_mixture_of_nothing_is_refused():
    with pytest.raises(ConfigurationError, match=r"world\.members is empty"):
        MixedWorlds({}, None, known=True)


def test_unknown_mixture_is_not_told_to_the_robot():
    assert not mixture(known=False).world(0, 0).known


def test_installed_mixture_draws_a_new_world_for_each_number_of_scenarios():
    source = component("world", "mixed", ["world.regenerate=2"])
    worlds = [source.world(0, i) for i in range(8)]
    assert len({id(world.grid) for world in worlds}) == 4
    assert {world.name for world in worlds} <= {"indoor", "outdoor", "rooms"}

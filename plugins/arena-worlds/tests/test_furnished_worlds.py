"""Another world with furniture in it."""

from xml.etree import ElementTree

import numpy as np
import pytest
from scipy import ndimage

from arena_core import ConfigurationError, ImpossibleScenario, World
from arena_core.scenes import add_furniture
from arena_core.testing import component, furniture, robot, room
from arena_worlds.commands.generate import GenerateCommand
from arena_worlds.formats.site_file import write_world
from arena_worlds.reachable import free_places


def source(*overrides):
    return component("world", "furnished", overrides)


def poses(world):
    return [(piece.kind, piece.pose) for piece in world.furniture]


def test_same_seed_gives_the_same_furniture_and_another_seed_other():
    one, other = (
        source("world@world.room=lab", "world.furniture=6"),
        source("world@world.room=lab", "world.furniture=6"),
    )
    assert poses(one.world(3, 0)) == poses(other.world(3, 7)) != poses(one.world(4, 0))
    assert len(one.world(3, 0).furniture) == 6
    assert one.world(3, 0).furniture == one.world(3, 7).furniture
    assert one.world(3, 0).grid is one.world(4, 0).grid


def test_furniture_changes_as_often_as_asked():
    drawn = source("world@world.room=empty", "world.furniture=3", "world.regenerate=2")
    assert poses(drawn.world(0, 0)) == poses(drawn.world(0, 1)) != poses(drawn.world(0, 2))


@pytest.mark.slow
@pytest.mark.parametrize("room", ["rooms", "indoor", "warehouse"])
def test_furniture_stands_on_free_ground_and_parts_nothing(room):
    world = source(f"world@world.room={room}").world(1, 0)
    grid = world.grid
    free, left = ~grid.occupied, ~add_furniture(world).occupied
    assert left.sum() < free.sum()
    before, _ = ndimage.label(free_places(free, grid.resolution, 0.35))
    after, _ = ndimage.label(free_places(left, grid.resolution, 0.35))
    assert len(np.unique(after[after > 0])) <= len(np.unique(before[before > 0]))


def test_pieces_do_not_stand_in_each_other():
    world = source("world@world.room=lab", "world.furniture=8").world(0, 0)
    alone = [
        (add_furniture(type(world)("", world.grid, furniture=(piece,))).occupied & ~world.grid.occupied)
        for piece in world.furniture
    ]
    assert np.sum(alone, axis=0).max() == 1


def test_more_furniture_than_there_is_room_for_is_refused():
    with pytest.raises(
        ImpossibleScenario,
        match=r"piece \d+ of world.furniture \(200\) found no place in 5 tries; allowed: fewer pieces",
    ):
        source("world@world.room=lab", "world.furniture=200", "world.tries=5").world(0, 0)


@pytest.mark.parametrize("shares", ["{sofa:1}", "{table:0}"])
def test_share_of_a_kind_that_is_not_there_is_refused(shares):
    with pytest.raises(
        ConfigurationError, match=r"world.shares is .*allowed: numbers >= 0, not all 0, of chair, shelf, table"
    ):
        source("~world.shares", f"+world.shares={shares}")


@pytest.mark.slow
def test_difficulty_is_that_of_the_room():
    hard, easy = source().at(1.0).world(0, 0), source().at(0.0).world(0, 0)
    assert hard.grid.occupied.sum() > easy.grid.occupied.sum()
    assert len(hard.furniture) == len(easy.furniture) == 12


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["sdf", "world"])
def test_gazebo_world_has_the_tops_and_the_legs(tmp_path, ending):
    target = tmp_path / f"hall.{ending}"
    assert (
        GenerateCommand().run(
            ["kind=furnished", "room=empty", "furniture=3", f"out={target}", "wall_height=1.5", "seed=2"]
        )
        == 0
    )
    found = [element.findtext("pose").split() for element in ElementTree.parse(target).iter("collision")]
    pieces = source("world@world.room=empty", "world.furniture=3").world(2, 0).furniture
    # the ground, four walls
    assert len(found) == 1 + 4 + sum(len(piece.boxes) + len(piece.cylinders) for piece in pieces)
    # the middle of walls that are 1.5 m high, of tops and legs besides
    assert {float(pose[2]) for pose in found} > {0.0, 0.75}


def test_mujoco_meets_a_table_at_its_legs_and_at_its_top(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "hall.xml"
    table = furniture("table", 1.0, 0.0)
    write_world(path, World("room", room(), furniture=(table,)), 2.0)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)

    def ahead(y, height):
        return mujoco.mj_ray(
            model, data, np.array((-1.0, y, height)), np.array((1.0, 0.0, 0.0)), None, 1, -1, np.zeros(1, np.int32)
        )

    assert ahead(0.33, 0.2) == pytest.approx(1.27 - 0.025)
    assert ahead(0.0, 0.2) == pytest.approx(5.95)
    assert ahead(0.0, 0.725) == pytest.approx(1.2)


def test_furniture_in_the_way_of_a_random_trip_is_gone_round():
    task = component(
        "task",
        "random",
        ["task.pedestrians=2"],
        robot=robot(),
        world=source("world@world.room=lab", "world.furniture=6"),
    )
    for index in range(3):
        drive = task.scenario(0, index)
        standing = add_furniture(drive.world)
        ends = [
            (drive.start.x, drive.start.y),
            (drive.goal.x, drive.goal.y),
            *(one.position_xy for one in drive.pedestrians),
        ]
        assert not standing.occupied[tuple(standing.cells(ends).T)].any()

"""DynaBARN's worlds: files as they were published are read, and drawn ones are what their levels say."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import yaml

from arena_core import ConfigurationError, InputFileError, PedestrianSpec, World, testing
from arena_core.hosting import load_registry
from arena_worlds.commands.command import WorldCommand
from arena_worlds.formats.animation import read_animation
from arena_worlds.generators.dynabarn import DynabarnWorlds

MODEL = """
    <model name='{name}'>
      <static>1</static>
      <pose frame=''>-0.225000 0.075000 0.000000 0.000000 0.000000 0.000000</pose>
      <link name='link'>
        <collision name='collision'>
           <geometry>{shape}</geometry>
        </collision>
        <visual name='visual'><geometry>{shape}</geometry></visual>
      </link>
      <plugin name='{name}' filename='{name}.so'/>
    </model>
"""
CYLINDER = "<cylinder><radius>0.5000</radius><length> 1 </length></cylinder>"
WALLS = """
      <model name="back_wall">
      <static>1</static>\\   <pose frame=>-10 0 .5 0 0 0</pose>        <link name="box_link">
	<collision name='collision'><geometry><box><size>.5 20 1</size></box></geometry></collision>
        </link>
      </model>
      <model name="top_wall">
      <static>1</static>
       <pose frame=>0 10 .5 0 0 0</pose>        <link name="box_link">
	<collision name='collision'><geometry><box><size>20 .5 1</size></box></geometry></collision>
        </link>
      </model>
"""  # attributes without values and a stray backslash: so they were published
SOURCE = """
#include <gazebo/gazebo.hh>
namespace gazebo
{{
  class {name} : public ModelPlugin
  {{
    public: void Load(physics::ModelPtr _parent, sdf::ElementPtr /*_sdf*/)
    {{
        // make it last 10 seconds,
        gazebo::common::PoseAnimationPtr anim(
              new gazebo::common::PoseAnimation("{name}", {length}, {again}));
        gazebo::common::PoseKeyFrame *key;
{frames}
        _parent->SetAnimation(anim);
    }}
  }};
  GZ_REGISTER_MODEL_PLUGIN({name})
}}
"""
FRAME = """
        key = anim->CreateKeyFrame({t});
        key->Translation(ignition::math::Vector3d({x}, {y}, 0));
        key->Rotation(ignition::math::Quaterniond(0, 0, 0));
"""
KEYS = (("0.00", "-10.00", "3.00"), ("4.50", "-7.78", "2.10"), ("9.25", "10.00", "-4.00"))


def source(keys=KEYS, length="9.25", again="true", name="easylibobs_51"):
    return SOURCE.format(
        name=name, length=length, again=again, frames="".join(FRAME.format(t=t, x=x, y=y) for t, x, y in keys)
    )


@pytest.fixture
def published(tmp_path):
    """Return a folder with one world and its plugin's source, both as DynaBARN's generator writes them."""
    (tmp_path / "worlds").mkdir()
    (tmp_path / "plugins").mkdir()
    include = "<include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include>"
    text = f'<?xml version="1.0" ?>\n<sdf version="1.6"><world name="default">{include}{{}}{WALLS}</world></sdf>'
    (tmp_path / "worlds" / "world_7.world").write_text(text.format(MODEL.format(name="easylibobs_51", shape=CYLINDER)))
    (tmp_path / "plugins" / "easylibobs_51.cc").write_text(source())
    return tmp_path


def worlds(*overrides: str) -> DynabarnWorlds:
    return testing.component("world", "dynabarn", [f"world.{override}" for override in overrides])


def test_published_world_is_read_with_its_walls_and_the_motions_of_its_plugins(published: Path) -> None:
    world = worlds(f"path={published / 'worlds'}").world(0, 3)
    (mover,) = world.movers
    assert world.name == "dynabarn/world_7"
    assert not world.known
    assert mover.radius == 0.5
    assert mover.stamps is not None
    assert mover.stamps.tolist() == [0.0, 4.5, 9.25]
    assert mover.waypoints_xy.tolist() == [[-10.0, 3.0], [-7.78, 2.1], [10.0, -4.0]]
    walls = world.grid.cells(
        [(-10.0, 0.0), (-9.8, 9.0), (0.0, 10.0), (9.9, 9.8), (-0.225, 0.075), (10.0, 0.0), (-9.7, 0.0)]
    )
    assert world.grid.occupied[walls[:, 0], walls[:, 1]].tolist() == [True, True, True, True, False, False, False]


def test_place_of_the_sources_may_be_given(published: Path) -> None:
    moved = (published / "plugins").rename(published / "elsewhere")
    assert len(worlds(f"path={published / 'worlds'}", f"plugins={moved}").world(0, 0).movers) == 1


def test_compiled_plugin_without_its_source_is_refused_with_what_is_allowed(published: Path) -> None:
    (published / "plugins" / "easylibobs_51.cc").rename(published / "plugins" / "easylibobs_51.so")
    with pytest.raises(
        InputFileError, match=r"world_7\.world: model 'easylibobs_51' is moved by .* allowed: world\.plugins=FOLDER"
    ):
        worlds(f"path={published / 'worlds'}")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (source(length="12.00"), "PoseAnimation is 12.00, true; allowed: 9.25"),
        (source(again="false"), "PoseAnimation is 9.25, false"),
        (source(keys=KEYS[:1], length="0.00"), "has 1 CreateKeyFrame"),
        (source(keys=(KEYS[0], KEYS[2], KEYS[1]), length="4.50"), "allowed: 0 first, then rising"),
        (source(keys=(KEYS[0], ("1e9", "1e9", "0"))), "allowed: numbers within 10 km"),
        ("int main() {}", "has 0 CreateKeyFrame"),
    ],
)
def test_source_that_is_no_pose_animation_is_refused_in_one_line(published: Path, text: str, says: str) -> None:
    path = published / "plugins" / "easylibobs_51.cc"
    path.write_text(text)
    with pytest.raises(InputFileError) as caught:
        read_animation(path)
    assert says in str(caught.value)
    assert "easylibobs_51.cc" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_moving_box_and_world_in_which_nothing_moves_are_refused(published: Path) -> None:
    path = published / "worlds" / "world_7.world"
    whole = path.read_text()
    path.write_text(whole.replace(CYLINDER, "<box><size>1 1 1</size></box>"))
    with pytest.raises(InputFileError, match="allowed: one, a cylinder"):
        worlds(f"path={path}")
    path.write_text(whole.replace(MODEL.format(name="easylibobs_51", shape=CYLINDER), ""))
    with pytest.raises(InputFileError, match="world=barn"):
        worlds(f"path={path}")


@pytest.fixture(scope="module")
def drawn() -> list[World]:
    source = worlds()
    return [source.world(0, index) for index in range(30)]


def preset() -> dict[str, dict[str, float]]:
    return yaml.safe_load((files("arena_worlds.conf") / "world" / "dynabarn.yaml").read_text())


def test_thirty_worlds_are_drawn_whatever_the_seed_and_another_set_differs(drawn: list[World]) -> None:
    again, other = worlds(), worlds("draw=1")
    for index, world in enumerate(drawn):
        for same in (again.world(5, index), again.world(0, index + 30)):
            assert same.name == world.name == f"dynabarn/world_{index}"
            assert all(_alike(a, b) for a, b in zip(same.movers, world.movers, strict=True))
        assert not all(_alike(a, b) for a, b in zip(other.world(0, index).movers, world.movers, strict=False))


def _alike(one: PedestrianSpec, other: PedestrianSpec) -> bool:
    assert one.stamps is not None
    assert other.stamps is not None
    return (
        one.id == other.id
        and np.array_equal(one.stamps, other.stamps)
        and np.array_equal(one.waypoints_xy, other.waypoints_xy)
    )


def test_number_and_speed_of_obstacles_are_those_of_their_level(drawn: list[World]) -> None:
    for index, world in enumerate(drawn):
        level = preset()[("easy", "medium", "hard")[index // 10]]
        assert level["obstacles_min"] <= len(world.movers) <= level["obstacles_max"]
        for mover in world.movers:
            assert mover.stamps is not None
            pieces = np.hypot(*np.diff(mover.waypoints_xy, axis=0).T)
            speeds = pieces / np.diff(mover.stamps)
            assert level["speed_min"] - 0.03 <= speeds.min()
            assert speeds.max() <= level["speed_max"] + 0.03
            assert speeds.std() <= 2.5 * level["std_max"]


def test_motions_cross_the_field_from_border_to_border(drawn: list[World]) -> None:
    for world in drawn:
        for mover in world.movers:
            ends = np.abs(mover.waypoints_xy[[0, -1]])
            assert np.abs(mover.waypoints_xy).max() <= 10.0
            assert ends.max(axis=1) == pytest.approx((10.0, 10.0))
            assert np.hypot(*np.diff(mover.waypoints_xy, axis=0).T).sum() > 4.8


def test_motions_of_a_first_order_are_straight_and_higher_ones_bend() -> None:
    def bend(mover: PedestrianSpec) -> float:
        """Return how far key places lie off the line through the ends, m."""
        x, y = (mover.waypoints_xy - mover.waypoints_xy[0]).T
        along = np.array((x[-1], y[-1])) / np.hypot(x[-1], y[-1])
        return float(np.abs(along[0] * y - along[1] * x).max())

    orders = [
        f"{level}.{key}={order}"
        for level in ("easy", "medium", "hard")
        for key, order in (("order_min", 1), ("order_max", 1))
    ]
    straight = [mover for index in range(30) for mover in worlds(*orders).world(0, index).movers]
    assert max(map(bend, straight)) < 0.02
    curved = [mover for index in range(10, 30) for mover in worlds().world(0, index).movers]
    assert np.median([bend(mover) for mover in curved]) > 0.5


@pytest.mark.slow
def test_written_set_is_read_back_as_it_was_drawn(
    tmp_path: Path, drawn: list[World], capsys: pytest.CaptureFixture[str]
) -> None:
    assert WorldCommand().run(["generate", "kind=dynabarn", f"out={tmp_path}"]) == 0
    assert "written" in capsys.readouterr().out
    read = worlds(f"path={tmp_path / 'worlds'}")
    for index, world in enumerate(drawn):
        other = read.world(0, index)
        assert other.name == world.name
        assert np.array_equal(other.grid.data, world.grid.data)
        assert all(_alike(a, b) and a.radius == b.radius for a, b in zip(world.movers, other.movers, strict=True))


def test_level_whose_ends_are_exchanged_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"world\.easy\.speed_min is 3; allowed: up to speed_max, 1"):
        worlds("easy.speed_min=3.0")


def test_folder_of_sources_that_is_none_is_refused(published: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"world\.plugins is nowhere"):
        load_registry().build("world", {**preset(), "path": str(published / "worlds"), "plugins": "nowhere"})

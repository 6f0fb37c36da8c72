"""A team of simulated robots: each in a namespace of its own, all in one world."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from arena_core import ConfigurationError, Twist
from arena_core.hosting import build_benchmark, compose, load_registry
from arena_ros import conversions as to
from arena_ros.codec import Ros, get_codec
from arena_ros.live.simulated_world import SimulatedWorld
from arena_ros.testing.site import PAIR_Y, START, world_overrides, write_site
from arena_ros.transport import MessageCallback, Publish, Transport

PERIOD = 0.05  # s
STEPS = 10


class Air(Transport):
    """What is said within one process."""

    ros: ClassVar[Ros] = 2

    def __init__(self, node: str) -> None:
        self.said: dict[str, list[bytes]] = {}
        self.callbacks: dict[str, MessageCallback] = {}

    def publisher(self, topic: str, type: str, *, latched: bool = False) -> Publish:
        return self.said.setdefault(topic, []).append

    def subscribe(self, topic: str, type: str, heard: MessageCallback, *, latched: bool = False) -> None:
        self.callbacks[topic] = heard

    def topics(self) -> Mapping[str, str]:
        return dict.fromkeys(self.said, "*")

    def rivals(self, topic: str) -> list[str]:
        return []

    def close(self) -> None:
        pass


def simulate(*words: str, command: Callable[[Air], None] = lambda air: None, lock_step: bool = False) -> Air:
    """Have a world on the air for some steps, with ``command`` given before each."""
    air, left = Air("simulate"), iter(range(STEPS))
    world = SimulatedWorld(air, build_benchmark(compose(["planner=pure_pursuit", *words]), load_registry()), PERIOD)

    def is_over() -> str:
        command(air)
        return "" if next(left, None) is not None else "over"

    world.run(0, 1000.0, is_over, lock_step=lock_step)
    return air


def say(air: Air, topic: str, vx: float) -> None:
    air.callbacks[topic](get_codec(2).encode(to.twist_msg(get_codec(2), Twist(vx)), to.TWIST))


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Air:
    """Two robots on the air, of which the second one is told to drive."""
    site = write_site(tmp_path_factory.mktemp("site"))
    return simulate(*world_overrides(site, "pair"), command=lambda air: say(air, "/robot1/cmd_vel", 0.5))


def last(air: Air, topic: str, kind: str) -> object:
    return get_codec(2).decode(air.said[topic][-1], kind)


def test_each_robot_has_its_topics_and_all_share_map_clock_people_and_transforms(pair: Air) -> None:
    own = {f"/robot{k}/{name}" for k in (0, 1) for name in ("scan", "odom", "ground_truth", "arena/scenario_goal")}
    assert set(pair.said) == own | {"/clock", "/map", "/people", "/people_markers", "/tf", "/tf_static"}
    assert set(pair.callbacks) == {"/robot0/cmd_vel", "/robot1/cmd_vel", "/arena/reset"}


def test_frames_have_the_name_of_their_robot(pair: Air) -> None:
    links = {
        link[:2] for content in pair.said["/tf"] for link in to.links_from_msg(get_codec(2).decode(content, to.TF))
    }
    assert links == {(f"robot{k}/odom", f"robot{k}/base_link") for k in (0, 1)}
    static = to.links_from_msg(last(pair, "/tf_static", to.TF))
    assert [link[:2] for link in static] == [(f"robot{k}/base_link", f"robot{k}/laser") for k in (0, 1)]
    scan, odometry = last(pair, "/robot1/scan", to.SCAN), last(pair, "/robot1/odom", to.ODOMETRY)
    assert scan.header.frame_id == "robot1/laser"
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("robot1/odom", "robot1/base_link")


def test_a_command_moves_the_robot_whose_it_is(pair: Air) -> None:
    poses = [to.pose_from_msg(last(pair, f"/robot{k}/ground_truth", to.ODOMETRY).pose.pose) for k in (0, 1)]
    assert (poses[0].x, poses[0].y) == (START[0], PAIR_Y[0])
    assert poses[1].x > START[0] + 0.05
    assert poses[1].y == pytest.approx(PAIR_Y[1])


def test_robots_see_each_other(pair: Air) -> None:
    ranges = np.array(last(pair, "/robot0/scan", to.SCAN).ranges)
    assert ranges.min() == pytest.approx(START[0], abs=0.6)  # the wall behind is nearest
    ways = last(pair, "/robot0/scan", to.SCAN)
    beam = round((np.pi / 2 - ways.angle_min) / ways.angle_increment)  # to the left, where the other one stands
    assert ranges[beam - 3 : beam + 4].min() < PAIR_Y[1] - PAIR_Y[0]


def test_in_lock_step_a_team_waits_for_all_its_commands(tmp_path: Path) -> None:
    site = world_overrides(write_site(tmp_path), "pair")
    waits = simulate(*site, command=lambda air: say(air, "/robot1/cmd_vel", 0.5), lock_step=True)
    assert to.pose_from_msg(last(waits, "/robot1/ground_truth", to.ODOMETRY).pose.pose).x == START[0]


def test_a_robot_alone_has_the_usual_names(tmp_path: Path) -> None:
    air = simulate(*world_overrides(write_site(tmp_path)), command=lambda air: say(air, "/cmd_vel", 0.5))
    assert {"/scan", "/odom", "/ground_truth", "/arena/scenario_goal"} < set(air.said)
    assert to.links_from_msg(last(air, "/tf", to.TF))[0][:2] == ("odom", "base_link")


def test_a_team_that_is_sent_on_from_goal_to_goal_is_not_put_on_the_air() -> None:
    with pytest.raises(ConfigurationError, match="task patrol sends robots on from goal to goal; allowed with arena"):
        simulate("task=patrol", "task.team=2", "world=empty")


def test_nodes_tell_each_other_what_they_want_themselves() -> None:
    with pytest.raises(ConfigurationError, match="communication is broadcast; allowed with arena ros simulate: none"):
        simulate("task=antipodal", "task.team=2", "world=empty", "communication=broadcast")

"""What the controller recalls: alike in one world and in many, in training and on the robot, bit for bit."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, ObservationBatch, Pose, Twist, testing
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.loop.execution import mission_of
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_gym.environment import NavigationEnv
from arena_gym.vector_environment import NavigationVectorEnv
from arena_navrep.world_model import load_part
from arena_policies.encoding import field_columns
from arena_policies.policy import load_policy

SMALL = [
    "world.width=12",
    "world.height=12",
    "task.pedestrians=3",
    "environment.worlds=2",
    "environment.problems_per_world=3",
]
BRAIN = [
    "localizer=ground_truth",
    "waypoints=spatial_horizon",
    "replan.on_request=false",
    "replan.blocked_for=null",
    "recoveries.behaviours=[]",
]


@pytest.mark.parametrize("part", ["vision", "memory"])
def test_row_of_a_network_is_what_it_is_alone(made, part):
    network = load_part(str(made.world / f"{part}.onnx"), part)
    rows = np.random.default_rng(0).normal(size=(67, network.card.reads)).astype(np.float32)
    together = network.run(rows)
    for size in (1, 2, 5, 32):
        assert all((network.run(rows[k : k + size]) == together[k : k + size]).all() for k in range(0, 66, size))


@pytest.mark.parametrize("memory", [True, False])
def test_encoder_holds_its_contract(made, memory):
    encoder = testing.component("observation_encoder", "navrep", made.words(made.world, memory), robot=made.robot)
    assert testing.check("observation_encoder", encoder, made.robot)
    assert encoder.recurrent == memory
    assert [f.name for f in encoder.layout()][: 1 + memory] == ["z", "h"][: 1 + memory]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["turtlebot3", "robotino"])
def test_encoder_of_other_robots_holds_its_contract(made, name, tmp_path):
    body = testing.component("robot", name)
    made.write_world_model(tmp_path, body)
    encoder = testing.component("observation_encoder", "navrep", made.words(tmp_path), robot=body)
    assert testing.check("observation_encoder", encoder, body)


def test_slot_of_many_worlds_recalls_what_it_recalls_alone(made):
    words = [*SMALL, "task.time_limit=2.0", *made.words(made.world)]
    envs = NavigationVectorEnv(5, robot="jackal", observation="navrep", overrides=words)
    alone = NavigationEnv(robot="jackal", observation="navrep", overrides=words)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (45, 5, 2)).astype(np.float32)
    together, ended = [envs.reset(seed=3)[0].copy()], 0
    for action in actions:
        seen, _, terminated, truncated, _ = envs.step(action)
        together.append(seen.copy())
        ended += int((terminated | truncated).sum())
    assert ended >= 10, "episodes end and begin again on the way"
    for slot in (0, 4):
        single = [alone.reset(seed=3 + slot)[0]]
        for action in actions[:, slot]:
            seen, _, terminated, truncated, _ = alone.step(action)
            single.append(alone.reset()[0] if terminated or truncated else seen)
        assert all((a[slot] == b).all() for a, b in zip(together, single, strict=True))


def test_episode_begins_without_memory_of_the_one_before(made):
    env = NavigationEnv(robot="jackal", observation="navrep", overrides=[*SMALL, *made.words(made.world)])
    hidden = field_columns(env.batch.parts.encoder.layout(), "h")
    first = env.reset(seed=0)[0][hidden].copy()
    for _ in range(5):
        later = env.step(np.array((0.5, 0.3), np.float32))[0][hidden].copy()
    assert (later != first).all()
    assert (env.reset()[0][hidden] == first).all()
    assert np.abs(first).max() < 1.0


def test_controller_recalls_on_the_robot_what_it_recalled_in_training(made):
    policy = load_policy(str(made.policy), "navrep", made.robot)
    common = ["world.width=12", "world.height=12", "task.pedestrians=3"]
    env = NavigationEnv(
        robot="jackal",
        observation="navrep",
        overrides=[*common, *made.words(made.world), "environment.collisions_to_end=null"],
    )
    shown = [env.reset(seed=0)[0].copy()]
    for _ in range(30):
        action = policy.run(shown[-1][None])[0]
        shown.append(env.step(action)[0].copy())
    problem = env.batch.episodes[0].problem

    words = ["robot=jackal", "world=indoor", "planner=navrep", f"planner.policy={made.policy}", *common, *BRAIN]
    benchmark = build_benchmark(to_plain(compose(words)), load_registry())
    navigator, simulator, policy = benchmark.navigator, benchmark.simulator, benchmark.navigator.planner._policy
    for _ in range(2):  # the second time with another episode in its past
        snapshot, recalled = simulator.reset([problem.scenario]), []
        navigator.reset(mission_of(problem.scenario))
        for _ in range(30):
            command = navigator.command(snapshot.sensors(0))
            recalled.append(policy._recalled[0].copy())
            snapshot = simulator.advance(command.array()[None], round(navigator.control_period / simulator.inner_step))
        assert all((seen == before).all() for seen, before in zip(recalled, shown, strict=False))


def test_memory_is_of_the_code_the_motion_and_the_command_before(made):
    encoder = testing.component("observation_encoder", "navrep", made.words(made.world), robot=made.robot)
    view = testing.observation(pose=Pose(0.3, 0.2), body=made.robot, twist=Twist(0.4, 0.0, 0.2))
    first = encoder.encode(ObservationBatch.of(view, Twist(0.0), recalled=encoder.blank(1)))
    hidden = field_columns(encoder.layout(), "h")

    def remembered(recalled, command):
        return encoder.encode(ObservationBatch.of(view, command, recalled=recalled))[0, hidden]

    base = remembered(first, Twist(0.2))
    assert (remembered(first, Twist(0.3)) != base).any(), "the command counts"
    for name in ("z", "h", "vx", "wz"):
        changed = first.copy()
        changed[0, field_columns(encoder.layout(), name)] += 0.1
        assert (remembered(changed, Twist(0.2)) != base).any(), name
    changed = first.copy()
    changed[0, field_columns(encoder.layout(), "waypoint_distance")] += 0.1
    assert (remembered(changed, Twist(0.2)) == base).all(), "the way does not"


def test_observation_that_is_no_number_leaves_the_memory_as_it_was(made):
    policy = load_policy(str(made.policy), "navrep", made.robot)
    view = testing.observation(body=made.robot)
    policy.command(view, Twist(0.0))
    before = policy._recalled.copy()
    blind = testing.observation(body=made.robot)
    blind = replace(blind, scan=replace(blind.scan, ranges=np.full_like(blind.scan.ranges, np.nan)))
    with pytest.raises(Exception, match="not finite"):
        policy.command(blind, Twist(0.0))
    assert (policy._recalled == before).all()
    policy.command(view, Twist(0.0))


def test_controller_that_looks_on_recalls_what_it_would_if_it_drove(made):
    driving, looking = (load_policy(str(made.policy), "navrep", made.robot) for _ in range(2))
    for x, command in ((0.0, Twist(0.0)), (0.1, Twist(0.2)), (0.3, Twist(0.4))):
        view = testing.observation(pose=Pose(x, 0.2), body=made.robot)
        driving.command(view, command)
        looking.observe(view, command)
    assert (looking._recalled == driving._recalled).all()
    assert looking._recalled.any()


@pytest.mark.parametrize("preset", ["navrep", "navrep_v_only"])
def test_planner_drives_without_torch(made, preset):
    policy = made.policy if preset == "navrep" else made.v_only
    code = (
        "import sys\nfrom arena_core import testing\n"
        "robot = testing.component('robot', 'jackal')\n"
        f"planner = testing.planner({preset!r}, robot, {f'planner.policy={policy}'!r})\n"
        "view = testing.observation(body=robot)\nprint(planner.compute_velocity(view))\n"
        "assert not {'torch', 'stable_baselines3', 'gymnasium'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, timeout=600)


def test_encoder_without_a_world_model_says_how_to_make_one():
    with pytest.raises(ConfigurationError, match="arena navrep all"):
        testing.component(
            "observation_encoder", "navrep", ["observation_encoder.vision=nothing.onnx"], robot=testing.robot()
        )

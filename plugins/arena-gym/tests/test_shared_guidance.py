"""Robots that are led together know what each would know alone, bit for bit."""

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_gym.batch import NavigationBatch
from arena_gym.building import build_parts, compose_environment
from arena_gym.guidance import NavigatorGuidance
from arena_gym.shared_guidance import SharedGuidance

WORLDS = 5
RULES = {
    "as in a run": [],
    "on request alone": ["guide.replan.blocked_for=null"],
    "every so often": ["guide.replan.period=0.7", "guide.replan.gain=0"],
    "never": ["guide.replan.blocked_for=null", "guide.replan.on_request=false"],
}


def batch_of(rules, encoder="gring"):
    overrides = [
        "guide=driving",
        "world.width=10",
        "world.height=10",
        "task.pedestrians=6",
        "task.time_limit=15",
        *rules,
    ]
    overrides += ["environment.worlds=2", "environment.problems_per_world=4", "environment.collisions_to_end=null"]
    overrides += ["randomization.lidar_noise.high=0.05"]
    config = compose_environment(overrides, robot="turtlebot3", observation_encoder=encoder, reward="progress")
    return NavigationBatch(build_parts(config), WORLDS)


def driven(batch, steps):
    """Yield what all robots know at each step: one stands, the others wander, and who comes to an end begins again."""
    rows, random = batch.reset(range(WORLDS)), np.random.default_rng(0)
    for _ in range(steps):
        yield rows
        actions = np.zeros((WORLDS, 2), np.float32)
        actions[1:, 0], actions[1:, 1] = 0.6, random.uniform(-0.6, 0.6, WORLDS - 1)
        step = batch.step(actions)
        rows, ended = step.observations, np.flatnonzero(step.terminated | step.truncated)
        if len(ended):
            rows[ended] = batch.restart(ended)


@pytest.mark.slow
@pytest.mark.parametrize("rules", RULES, ids=str)
def test_robots_led_together_know_what_each_would_alone(rules):
    together, apart = batch_of(RULES[rules]), batch_of(RULES[rules])
    assert isinstance(together._guidance, SharedGuidance)
    apart._guidance = NavigatorGuidance(apart.parts.make_guide, apart.loop, tracked=apart.parts.encoder.tracked)
    replanned = False
    for here, there in zip(driven(together, 180), driven(apart, 180), strict=True):
        assert (here == there).all()
        replanned = replanned or any(guide._planned_at > 0.0 for guide in together._guidance._guides)
    assert replanned == (rules != "never")


@pytest.mark.slow
def test_robots_led_together_track_whom_each_would_alone():
    rules = ["observation_encoder.foreseen=[1.0,3.0]", "tracker@guide.tracker=kalman"]
    together, apart = (batch_of(rules, "rosnav_sectors") for _ in range(2))
    apart._guidance = NavigatorGuidance(apart.parts.make_guide, apart.loop, tracked=True)
    tracks = 0
    for here, there in zip(driven(together, 120), driven(apart, 120), strict=True):
        assert (here == there).all()
        tracks += sum(len(seen.ids) for seen in together.seen.tracks)
    assert tracks > 100


def test_tracks_need_a_guide_with_a_tracker():
    with pytest.raises(ConfigurationError, match=r"guide is null; allowed: a guide"):
        NavigationBatch(
            build_parts(
                compose_environment(["observation_encoder.foreseen=[1.0]"], observation_encoder="rosnav_sectors")
            ),
            1,
        )
    with pytest.raises(ConfigurationError, match=r"guide.tracker is none; allowed: .*tracker@guide.tracker=kalman"):
        batch_of(["observation_encoder.foreseen=[1.0]"], "rosnav_sectors")


def test_a_filter_of_its_own_needs_a_guide_of_its_own():
    assert isinstance(batch_of(["localizer@guide.localizer=amcl"])._guidance, NavigatorGuidance)
    assert isinstance(batch_of(["recoveries@guide.recoveries=default"])._guidance, NavigatorGuidance)

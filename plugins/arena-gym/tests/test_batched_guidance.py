"""Robots led by a model of their guides see what the real parts would show, in statistics, and train on it."""

import math

import numpy as np
import pytest

from arena_core import ConfigurationError, OccupancyGrid, Path, PathBatch, Pose
from arena_gym.batch import NavigationBatch
from arena_gym.batched_guidance import BatchedGuidance
from arena_gym.building import build_parts, compose_environment
from arena_gym.detours import DetourRules, Detours, LocalGround
from arena_gym.guidance_parity import compare_guidances
from arena_gym.modelled_tracks import ScanNumbers
from arena_gym.shared_guidance import SharedGuidance

TRACKED = ("tracker@guide.tracker=kalman", "observation_encoder.foreseen=[1.0,3.0]")
SMALL = ("world.width=10", "world.height=10", "environment.worlds=2", "environment.problems_per_world=3")


def config_of(*words, guide="batched", robot="turtlebot3"):
    """Return the configuration of a small environment whose encoder looks at tracks."""
    overrides = [f"guide={guide}", "task.pedestrians=6", "task.time_limit=15", *SMALL, *TRACKED, *words]
    return compose_environment(overrides, robot=robot, observation_encoder="rosnav_sectors", reward="progress")


def rows_of(batch, worlds, steps):
    """Return what all robots observe at each step; they wander, and who comes to an end begins again."""
    rows, random = batch.reset(range(worlds)), np.random.default_rng(0)
    actions, seen = random.uniform(-1.0, 1.0, (steps, 8, 2)).astype(np.float32), [rows.copy()]
    for action in actions:
        step = batch.step(action[:worlds])
        rows, ended = step.observations, np.flatnonzero(step.terminated | step.truncated)
        if len(ended):
            rows[ended] = batch.restart(ended)
        seen.append(rows.copy())
    return np.array(seen)


def test_observations_have_one_shape_whoever_guides():
    model, real = (NavigationBatch(build_parts(config_of(guide=guide)), 3) for guide in ("batched", "driving"))
    assert model.led_by_model
    assert not real.led_by_model
    assert isinstance(model._guidance, BatchedGuidance)
    assert isinstance(real._guidance, SharedGuidance)
    assert model.reset(range(3)).shape == real.reset(range(3)).shape


def test_same_seeds_give_the_same_bits_and_a_world_is_what_it_is_alone():
    together, again, alone = (rows_of(NavigationBatch(build_parts(config_of()), n), n, 60) for n in (4, 4, 1))
    assert (together == again).all()
    assert (together[:, :1] == alone).all()


def test_robots_get_their_real_guides_when_they_are_due():
    batch = NavigationBatch(build_parts(config_of()), 2)
    batch.reset(range(2))
    batch.lead_by_real_parts()
    assert not batch.led_by_model
    batch.restart(np.arange(2))
    batch.step(np.zeros((2, 2), np.float32))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("tracker@guide.tracker=kalman_legs",), r"guide.tracker is .*; allowed with guide.model: kalman"),
        (("guide.model.tracks.noise=[0.1]",), r"guide.model.tracks.noise has 1 numbers; allowed: 4"),
        (("localizer@guide.localizer=amcl",), r"guide.localizer filters scans; allowed with guide.model: gauss_markov"),
    ],
    ids=["tracker", "rings", "localizer"],
)
def test_what_the_model_does_not_stand_for_is_reported_in_one_line(words, message):
    with pytest.raises(ConfigurationError, match=message):
        NavigationBatch(build_parts(config_of(*words)), 1)


RULES = DetourRules(size=6.0, resolution=0.1, hits_within=3.0, margin=0.0, room=0.3, crowding=4.0)
STRAIGHT = Path(np.column_stack((np.arange(0.0, 8.0, 0.05), np.zeros(160), np.zeros(160))))


def scan_of(discs):
    """Return 360 beams from the origin that end on discs (x, y, radius), else nowhere."""
    angles = -math.pi + np.arange(360) * math.radians(1.0)
    ranges = np.full(360, np.inf)
    for x, y, radius in discs:
        along, beside = x * np.cos(angles) + y * np.sin(angles), y * np.cos(angles) - x * np.sin(angles)
        hits = (np.abs(beside) < radius) & (along > 0.0)
        ranges[hits] = np.minimum(ranges[hits], along[hits] - np.sqrt(radius**2 - beside[hits] ** 2))
    return ScanNumbers(ranges[None].astype(np.float32), np.zeros(1), -math.pi, math.radians(1.0), 10.0, (0.0, 0.0, 0.0))


def blocked_by(*discs):
    """Return whether these block a straight path along x of a robot with a radius of 0.2 m."""
    return bool(Detours(RULES, 0.2).blocked(PathBatch.of([STRAIGHT]), np.zeros((1, 3)), scan_of(discs))[0])


def test_a_path_is_blocked_by_what_lies_on_it_and_by_nothing_beside_it():
    assert not blocked_by()
    assert blocked_by((1.5, 0.0, 0.3))
    assert blocked_by((1.5, 0.45, 0.3))
    assert not blocked_by((1.5, 0.6, 0.3))
    assert not blocked_by((-1.5, 0.0, 0.3))
    assert not blocked_by((3.5, 0.0, 0.2))  # beyond 3 m hits do not count


def test_a_detour_keeps_off_what_blocks_the_path_and_joins_it_again():
    detours, scan = Detours(RULES, 0.2), scan_of([(1.5, 0.0, 0.3)])
    found = detours.way_round(STRAIGHT, np.zeros(3), 0, scan, LocalGround.of(None))
    assert found is not None
    assert np.hypot(found.poses[:, 0] - 1.5, found.poses[:, 1]).min() > 0.3 + 0.2 - 0.1
    assert (found.poses[0, :2] == 0.0).all()
    assert (found.poses[-1] == STRAIGHT.poses[-1]).all()
    ways = np.hypot(*np.diff(found.poses[:, :2], axis=0).T)
    assert ways.max() < 0.2
    assert ways.sum() < 8.0 * 1.1


def test_no_detour_leads_through_a_closed_row():
    detours, scan = Detours(RULES, 0.2), scan_of([(1.5, y, 0.3) for y in np.arange(-2.7, 2.8, 0.3)])
    walls = np.zeros((80, 160), np.int8)
    walls[:2], walls[-2:] = 100, 100
    ground = LocalGround.of(OccupancyGrid(walls, 0.05, Pose(-2.0, -2.0)))
    assert detours.way_round(STRAIGHT, np.zeros(3), 0, scan, ground) is None


# What the model and the real parts may differ by in the same episodes: a share of the real figure, and so much more.
TOLERANCES = {
    "pose error": (0.0, 0.0),
    "found up to": (0.05, 0.02),
    "delay until told, mean": (0.3, 0.05),
    "hidden people still told of": (0.3, 0.03),
    "position error": (0.4, 0.01),
    "velocity error": (0.4, 0.03),
    "radius error": (0.0, 0.02),
    "tracks that are no person": (0.3, 0.1),
    "path ahead": (0.1, 0.2),
    "distance to the path": (0.4, 0.05),
    "new paths": (0.5, 2.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("robot", [pytest.param("turtlebot3", marks=pytest.mark.long), "jackal"])
def test_model_and_real_parts_are_alike_in_the_same_episodes(robot):
    worlds = ["environment.worlds=8", "task.trip.min_distance=3", "task.time_limit=40"]
    model, real = (config_of(*worlds, guide=guide, robot=robot) for guide in ("batched", "driving"))
    real_rows, model_rows = compare_guidances((real, model), 12, 250)
    compared = 0
    for name, expected in real_rows.items():
        kind = next((kind for kind in TOLERANCES if name.startswith(kind)), None)
        if kind is not None and not math.isnan(expected):
            share, more = TOLERANCES[kind]
            assert abs(model_rows[name] - expected) <= share * abs(expected) + more, (name, expected, model_rows[name])
            compared += 1
    assert compared >= 15

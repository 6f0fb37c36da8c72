import math
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError, Path, PathBatch, WaypointGenerator, Waypoints
from arena_core.hosting import OFF_PATH, WAYPOINT_FOUND, WAYPOINT_TIMEOUT
from arena_core.testing import component
from arena_navigation.planning.waypoints import SpatialHorizon, Subsample

Generator = TypeVar("Generator", bound=WaypointGenerator)


def horizon(t_lim: float | None = 4.0, **changes: Any) -> SpatialHorizon:
    return begun(SpatialHorizon(**({"d_ahead": 2.0, "tolerance": 0.2, "t_lim": t_lim, "min_progress": 0.1} | changes)))


def subsample(spacing: float = 1.5, t_lim: float | None = 4.0) -> Subsample:
    return begun(Subsample(spacing, 0.3, 2.0, t_lim, 0.1))


def begun(generator: Generator, total: int = 1) -> Generator:
    generator.reset(np.arange(total), total)
    return generator


def path_through(*corners: tuple[float, float], spacing: float = 0.1) -> Path:
    points = [corners[0]]
    for a, b in pairwise(corners):
        number = max(1, round(math.dist(a, b) / spacing))
        points += [(a[0] + (b[0] - a[0]) * k / number, a[1] + (b[1] - a[1]) * k / number) for k in range(1, number + 1)]
    steps = np.diff(points, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    return Path(np.column_stack((points, np.append(headings, headings[-1]))))


def ask(generator: WaypointGenerator, path: Path, x: float, y: float, stamp: float = 0.0) -> tuple[float, float, int]:
    found = generator.next(PathBatch.of([path]), np.array(((x, y, 0.0),)), np.array((stamp,)))
    return float(found.poses[0, 0]), float(found.poses[0, 1]), int(found.status[0])


STRAIGHT = path_through((0.0, 0.0), (10.0, 0.0))


def test_the_horizon_takes_the_pose_furthest_along_the_path_inside_the_band() -> None:
    # the pose at 5.2 m is not within 2.2 m
    assert ask(horizon(), STRAIGHT, 3.0, 0.0) == (pytest.approx(5.1), 0.0, WAYPOINT_FOUND)


def test_a_goal_nearer_than_the_horizon_is_the_waypoint() -> None:
    assert ask(horizon(), STRAIGHT, 9.0, 0.5) == (10.0, 0.0, WAYPOINT_FOUND)


def test_a_goal_behind_a_detour_is_not_taken_through_the_wall() -> None:
    detour = path_through((0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0))
    x, y, status = ask(horizon(), detour, 0.0, 0.0)
    assert (x, y, status) == (pytest.approx(2.1), 0.0, WAYPOINT_FOUND)


def test_a_robot_far_from_its_path_needs_a_new_one() -> None:
    assert ask(horizon(), STRAIGHT, 3.0, 2.1)[2] == WAYPOINT_FOUND
    x, y, status = ask(horizon(), STRAIGHT, 3.0, 2.3)
    assert (x, y, status) == (pytest.approx(3.0), 0.0, OFF_PATH)


def test_poses_too_coarse_for_the_band_are_off_path() -> None:
    assert ask(horizon(), path_through((0.0, 0.0), (10.0, 0.0), spacing=5.0), 0.0, 0.0)[2] == OFF_PATH


def test_the_waypoint_never_leaps_to_where_the_path_comes_near_again() -> None:
    hairpin = path_through((0.0, 0.0), (8.0, 0.0), (8.0, 0.4), (0.0, 0.4))
    for generator in (horizon(), subsample()):
        for k in range(60):
            x, y, status = ask(generator, hairpin, 0.1 * k, 0.3, 0.1 * k)  # nearer to the way back
            assert status == WAYPOINT_FOUND
            if k < 55:
                assert y == 0.0
                assert x > 0.1 * k


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_a_robot_that_shakes_along_its_path_always_has_a_waypoint_ahead(seed: int) -> None:
    random = np.random.default_rng(seed)
    corners = np.cumsum(random.uniform(-1.5, 2.5, (6, 2)), axis=0)
    path = path_through(*[(float(x), float(y)) for x, y in corners])
    last = -1
    for generator in (horizon(), subsample()):
        for k in range(0, len(path.poses), 2):
            x, y = path.poses[k, :2] + random.normal(0.0, 0.03, 2)
            found = generator.next(PathBatch.of([path]), np.array(((x, y, 0.0),)), np.array((0.1 * k,)))
            place = int(np.flatnonzero((path.poses == found.poses[0]).all(axis=1))[-1])
            assert found.status[0] == WAYPOINT_FOUND
            assert place >= min(k + 1, len(path.poses) - 1)
            assert place >= last or isinstance(generator, SpatialHorizon)
            last = place
        assert last == len(path.poses) - 1
        last = -1


def test_a_standing_robot_times_out_every_t_lim_and_a_slow_one_never() -> None:
    for generator in (horizon(), subsample()):
        late = [ask(generator, STRAIGHT, 1.0, 0.2, 0.1 * k)[2] == WAYPOINT_TIMEOUT for k in range(100)]
        assert np.flatnonzero(late).tolist() == [40, 80]
        begun(generator)
        assert all(ask(generator, STRAIGHT, 1.0 + 0.003 * k, 0.0, 0.1 * k)[2] == WAYPOINT_FOUND for k in range(300))


def test_without_t_lim_nothing_times_out() -> None:
    for generator in (horizon(None), subsample(t_lim=None)):
        assert all(ask(generator, STRAIGHT, 1.0, 0.0, 10.0 * k)[2] == WAYPOINT_FOUND for k in range(10))


def test_coming_back_to_the_path_counts_as_progress() -> None:
    generator = horizon()
    assert all(ask(generator, STRAIGHT, 3.0, 2.0 - 0.03 * k, 0.1 * k)[2] == WAYPOINT_FOUND for k in range(60))


def test_subsample_puts_waypoints_at_even_distances_and_ends_at_the_goal() -> None:
    generator = subsample()
    seen = [ask(generator, STRAIGHT, 0.05 * k, 0.0, 0.1 * k)[0] for k in range(201)]
    assert sorted(set(np.round(seen, 6))) == pytest.approx([1.5, 3.0, 4.5, 6.0, 7.5, 9.0, 10.0])
    assert seen == sorted(seen)


def test_subsample_goes_on_when_a_waypoint_is_reached_or_passed() -> None:
    generator = subsample()
    assert ask(generator, STRAIGHT, 1.1, 0.0)[0] == pytest.approx(1.5)
    assert ask(generator, STRAIGHT, 1.25, 0.0)[0] == pytest.approx(3.0)
    generator = subsample()
    ask(generator, STRAIGHT, 1.0, 0.0)
    assert ask(generator, STRAIGHT, 1.6, 0.8)[0] == pytest.approx(3.0)


def test_subsample_beside_the_path_needs_a_new_one() -> None:
    assert ask(subsample(), STRAIGHT, 3.0, 1.9)[2] == WAYPOINT_FOUND
    assert ask(subsample(), STRAIGHT, 3.0, 2.1)[2] == OFF_PATH


def test_a_new_path_and_a_reset_begin_anew() -> None:
    generator = horizon()
    ask(generator, STRAIGHT, 8.0, 0.0)
    assert ask(generator, path_through((0.0, 0.1), (10.0, 0.1)), 1.0, 0.0)[0] == pytest.approx(3.1)
    ask(generator, STRAIGHT, 8.0, 0.0)
    begun(generator)
    assert ask(generator, STRAIGHT, 1.0, 0.0)[0] == pytest.approx(3.1)


def test_the_nearest_pose_is_looked_for_on_the_whole_of_a_new_path() -> None:
    assert ask(horizon(), STRAIGHT, 6.05, 0.0)[0] == pytest.approx(8.2)


@pytest.mark.parametrize("make", [horizon, subsample])
def test_slots_of_a_batch_are_batches_of_one(make: Any) -> None:
    random = np.random.default_rng(5)
    paths = [
        path_through(*[(float(x), float(y)) for x, y in np.cumsum(random.uniform(-1.0, 3.0, (4, 2)), axis=0)])
        for _ in range(7)
    ]
    batch, alone = begun(make(), 7), [make() for _ in paths]
    poses = np.array([path.poses[0] for path in paths])
    for step in range(60):
        stamps = np.full(7, 0.5 * step)
        together = batch.next(PathBatch.of(paths), poses, stamps)
        single = zip(alone, paths, poses, strict=True)
        apart: list[Waypoints] = [
            generator.next(PathBatch.of([path]), pose[None], stamps[:1]) for generator, path, pose in single
        ]
        assert (together.poses == np.concatenate([w.poses for w in apart])).all()
        assert (together.status == np.concatenate([w.status for w in apart])).all()
        toward = together.poses[:, :2] - poses[:, :2]
        poses[:, :2] += 0.1 * toward + random.normal(0.0, 0.02, (7, 2))
        if step == 30:
            batch.reset(np.array((2, 5)), 7)
            alone[2].reset(np.zeros(1, np.int64), 1)
            alone[5].reset(np.zeros(1, np.int64), 1)


def test_a_band_wider_than_the_horizon_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"tolerance is 2.0; allowed: less than d_ahead, 2.0 \(m\)"):
        horizon(tolerance=2.0)


@pytest.mark.parametrize(("preset", "kind"), [("spatial_horizon", SpatialHorizon), ("subsample", Subsample)])
def test_the_presets_build_their_generators(preset: str, kind: type) -> None:
    assert isinstance(component("waypoints", preset), kind)

"""What a network is told of tracks: in a frame of their own, wherever and whichever way round the world lies."""

from __future__ import annotations

import numpy as np
import pytest

from arena_core import OccupancyGrid, Pose, Tracks, testing
from arena_prediction.features import (
    AGES,
    BODY_SIZE,
    HISTORY_SIZE,
    NEIGHBOUR_SIZE,
    NEIGHBOURS,
    OWN_SIZE,
    RAYS,
    SIZE,
    TrackMemory,
)

HISTORY = slice(BODY_SIZE, BODY_SIZE + HISTORY_SIZE)
WALLS = slice(BODY_SIZE + HISTORY_SIZE, OWN_SIZE)
PLACES = np.array(((0.5, 0.2), (-0.6, 0.9), (1.5, -1.2)))
VELOCITIES = np.array(((0.6, 0.1), (-0.2, -0.5), (-0.7, 0.4)))


def tracks_at(places, velocities, ids=None):
    count = len(places)
    covariances = np.tile(np.diag((0.01, 0.01, 0.04, 0.04)), (count, 1, 1))
    numbers = np.arange(count) if ids is None else np.array(ids)
    return Tracks(numbers.astype(np.int32), np.array(places), np.array(velocities), np.full(count, 0.3), covariances)


def walk(memory, turn=0.0, shift=(0.0, 0.0), mirror=1.0, steps=25):
    """Return numbers and frames after people walked, each bending to the left, in a world that is turned, shifted and
    mirrored.
    """
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array(((c, -s), (s, c))) @ np.diag((1.0, mirror))
    for k in range(steps):
        t = 0.1 * k - 0.1 * (steps - 1)
        bend = 0.3 * t
        rotation = np.array(((np.cos(bend), -np.sin(bend)), (np.sin(bend), np.cos(bend))))
        velocities = VELOCITIES @ rotation.T
        places = PLACES + t * velocities
        told = memory.encode(tracks_at(places @ turned.T + shift, velocities @ turned.T), 0.1 * k)
    return told


def memory_of(grid):
    memory = TrackMemory()
    memory.reset(grid)
    return memory


def test_there_are_as_many_numbers_as_the_layout_says():
    numbers, frames = walk(memory_of(None))
    assert numbers.shape == (3, SIZE)
    assert SIZE == OWN_SIZE + NEIGHBOURS * NEIGHBOUR_SIZE
    assert frames.shape == (3, 4)
    assert np.isfinite(numbers).all()


@pytest.mark.parametrize("turn", [0.7, np.pi / 2, -2.5])
def test_a_turned_and_shifted_world_gives_the_same_numbers(turn):
    plain, frames = walk(memory_of(None))
    turned, other = walk(memory_of(None), turn, (3.0, -7.0))
    np.testing.assert_allclose(turned, plain, atol=1e-5)
    c, s = np.cos(turn), np.sin(turn)
    np.testing.assert_allclose(other[:, 0], c * frames[:, 0] - s * frames[:, 1], atol=1e-9)
    np.testing.assert_allclose(other[:, 1], s * frames[:, 0] + c * frames[:, 1], atol=1e-9)
    np.testing.assert_allclose(other[:, 2:], frames[:, 2:], atol=1e-9)


def test_walls_turn_with_the_world():
    room = testing.room(6.0)
    turn, c, s = 1.1, np.cos(1.1), np.sin(1.1)
    x, y = room.origin.x, room.origin.y
    turned = OccupancyGrid(
        room.data, room.resolution, Pose(c * x - s * y + 2.0, s * x + c * y, room.origin.theta + turn)
    )
    plain, _ = walk(memory_of(room))
    other, _ = walk(memory_of(turned), turn, (2.0, 0.0))
    assert plain[:, WALLS].max() > 0.1
    np.testing.assert_allclose(other, plain, atol=0.02)  # a ray may end a cell earlier or later


def test_a_mirrored_world_gives_mirrored_numbers():
    plain, _ = walk(memory_of(None))
    mirrored, _ = walk(memory_of(None), mirror=-1.0)
    signs = np.ones(SIZE)
    signs[6] = -1.0  # the sideways velocity
    signs[HISTORY] = np.tile((1.0, -1.0, 1.0, -1.0), len(AGES))
    for k in range(NEIGHBOURS):
        signs[[OWN_SIZE + k * NEIGHBOUR_SIZE + sideways for sideways in (2, 4, 6)]] = -1.0
    np.testing.assert_allclose(mirrored, plain * signs, atol=1e-5)


def test_who_walks_straight_has_come_straight_from_behind():
    memory = memory_of(None)
    for k in range(25):
        numbers, frames = memory.encode(tracks_at([(0.1 * k, 0.0)], [(1.0, 0.0)]), 0.1 * k)
    history = numbers[0, HISTORY].reshape(-1, 4)
    np.testing.assert_allclose(history, np.tile((1.0, 0.0, 1.0, 0.0), (len(AGES), 1)), atol=1e-5)
    assert frames[0].tolist() == pytest.approx([1.0, 0.0, 1.0, 1.0])


def test_the_past_of_a_new_track_is_taken_as_straight():
    numbers, _ = memory_of(None).encode(tracks_at([(2.0, 3.0)], [(0.0, 0.8)]), 5.0)
    np.testing.assert_allclose(numbers[0, HISTORY].reshape(-1, 4), np.tile((1.0, 0.0, 1.0, 0.0), (len(AGES), 1)))


def test_who_has_turned_is_seen_to_have_come_from_the_side():
    memory = memory_of(None)
    for k in range(21):
        x, y = min(0.1 * k, 1.0), max(0.1 * (k - 10), 0.0)
        going = (1.0, 0.0) if k < 10 else (0.0, 1.0)
        numbers, frames = memory.encode(tracks_at([(x, y)], [going]), 0.1 * k)
    c, s, *_ = frames[0]
    dx, dy = 1.0, 1.0  # of the whole way, within 2 s at 1 m/s
    assert numbers[0, HISTORY][-4:-2].tolist() == pytest.approx(
        [(c * dx + s * dy) / 2, (c * dy - s * dx) / 2], abs=1e-5
    )


def test_rays_measure_how_far_the_body_is_from_walls():
    memory = memory_of(testing.room(6.0))
    numbers, _ = memory.encode(tracks_at([(1.0, 0.0)], [(1.0, 0.0)]), 0.0)
    ahead, behind = (-np.log(numbers[0, WALLS][2 * i]) for i in (0, RAYS // 2))
    assert ahead == pytest.approx(3.0 - 1.0 - 0.3, abs=0.1)
    assert behind == pytest.approx(3.0 + 1.0 - 0.3, abs=0.1)


def test_the_nearest_neighbour_comes_first():
    numbers, _ = memory_of(None).encode(
        tracks_at([(0.0, 0.0), (3.0, 0.0), (0.0, 1.5)], [(1.0, 0.0), (-1.0, 0.0), (1.0, 0.0)]), 0.0
    )
    nearest, second, third = (numbers[0, OWN_SIZE + k * NEIGHBOUR_SIZE :][:NEIGHBOUR_SIZE] for k in range(3))
    assert nearest[:5].tolist() == pytest.approx([1.0, 0.0, 0.5, 0.0, 0.0])
    assert second[:5].tolist() == pytest.approx([1.0, 1.0, 0.0, -2.0, 0.0])
    assert second[8:10].tolist() == pytest.approx([1.0, 0.75])  # they meet, in 1.5 s
    assert not third.any()


def test_a_track_that_returns_under_another_number_has_no_past():
    memory = memory_of(None)
    for k in range(20):
        memory.encode(tracks_at([(0.1 * k, 0.0)], [(1.0, 0.0)], [4]), 0.1 * k)
    bent, _ = memory.encode(tracks_at([(2.0, 0.0)], [(0.0, 1.0)], [4]), 2.0)
    fresh, _ = memory.encode(tracks_at([(2.0, 0.0)], [(0.0, 1.0)], [5]), 2.0)
    assert abs(bent[0, HISTORY] - fresh[0, HISTORY]).max() > 0.5


def test_more_tracks_than_there_was_room_for_are_remembered():
    memory, places = memory_of(None), np.array([(k % 10, k // 10) for k in range(90)], np.float64)
    going = np.tile((0.5, 0.0), (90, 1))
    for k in range(12):
        numbers, _ = memory.encode(tracks_at(places + 0.1 * k * going, going), 0.1 * k)
    assert numbers[:, 1].tolist() == pytest.approx([1.1 - 1.5] * 90)


@pytest.mark.parametrize("array", ["positions", "velocities"])
def test_a_track_that_is_no_number_changes_no_other_one(array):
    known = tracks_at(PLACES[:2], VELOCITIES[:2])
    strange = tracks_at(PLACES, VELOCITIES)
    getattr(strange, array)[2] = np.nan
    expected, _ = memory_of(None).encode(known, 0.0)
    numbers, frames = memory_of(None).encode(strange, 0.0)
    np.testing.assert_array_equal(numbers[:2], expected)
    assert frames[:, 3].tolist() == [1.0, 1.0, 0.0]
    assert not numbers[2].any()


def test_covariances_that_are_no_numbers_leave_numbers():
    tracks = tracks_at(PLACES, VELOCITIES)
    tracks.covariances[:] = np.nan
    numbers, _ = memory_of(None).encode(tracks, 0.0)
    assert np.isfinite(numbers).all()

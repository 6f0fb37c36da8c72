"""Times left by a clock of our own: what starts slowly, comes in bursts, or ends with the slowest of many."""

import numpy as np
import pytest

from arena_gym.training.time_left import EvaluationLength, ImitationPace, Pace, RewardsPace

FACTOR = 1.5  # of an estimate to what it took, once a fifth is over
SHARES = (0.2, 0.5, 0.8)


def within_factor(estimate, took):
    return took / FACTOR < estimate < took * FACTOR


def test_pace_says_nothing_before_two_stretches_and_forgets_what_compiled():
    pace = Pace()
    for seconds in (75.0, 2.0):
        assert pace.seconds(10.0) is None
        pace.add(seconds, 1.0)
    assert pace.seconds(10.0) is None
    pace.add(4.0, 1.0)
    assert pace.seconds(10.0) == pytest.approx(30.0)


@pytest.mark.parametrize("slow", [1, 3, 6])
def test_pace_of_work_that_begins_slowly_is_right_after_a_fifth(slow):
    taken = np.where(np.arange(100) < slow, 20.0, 1.0)
    pace = Pace()
    for done, seconds in enumerate(taken, 1):
        pace.add(seconds, 1.0)
        if done in (20, 50, 80):
            assert within_factor(pace.seconds(100 - done), taken[done:].sum())


def test_pace_of_work_in_bursts_is_right_after_a_fifth():
    taken = np.where(np.arange(100) % 10 == 3, 9.0, 0.5)
    pace = Pace()
    for done, seconds in enumerate(taken, 1):
        pace.add(seconds, 1.0)
        if done in (20, 50, 80):
            assert within_factor(pace.seconds(100 - done), taken[done:].sum())


def test_lessons_take_ever_longer_to_learn_from():
    pace, rounds, decisions = ImitationPace(8, 100), 8, 100
    learning = [3.0 * lesson for lesson in range(1, rounds + 1)]
    for lesson in range(1, rounds + 1):
        for decision in range(decisions):
            pace.drove(40.0 if lesson == 1 and decision == 0 else 0.1)
            if lesson == 1:
                assert pace.left(lesson, decision + 1) is None
        left = pace.left(lesson, decisions)
        if left is not None:
            assert left == pytest.approx(0.1 * decisions * (rounds - lesson) + sum(learning[lesson - 1 :]))
        pace.learned(learning[lesson - 1], lesson)


def rewards_times(rollouts, every):
    """Return how long each rollout and each validation takes, s, in the order in which they come."""
    return [("rollout", 60.0 if k == 0 else 10.0 + (k % 3)) for k in range(rollouts)], every, 45.0


@pytest.mark.parametrize(("rollouts", "every"), [(20, 2000), (60, 5000)])
def test_time_left_of_rewards_holds_validations_once_one_is_known(rollouts, every):
    parts, every, validation = rewards_times(rollouts, every)
    pace, clock, found = RewardsPace(0, rollouts * 1000, every), 0.0, []
    for k, (_, seconds) in enumerate(parts, 1):
        pace.begin_rollout(clock)
        clock += seconds
        pace.end_rollout(clock, 1000 * k)
        found.append((clock, pace.left(clock)))
        if k % (every // 1000) == 0:
            clock += validation
            pace.validate(validation)
    for share in SHARES:
        at, (left, whole) = next(one for one in found if one[0] >= share * clock)
        assert whole
        assert within_factor(left, clock - at)
    assert found[0][1] is None


def test_validation_under_way_counts_as_far_as_it_is():
    pace = RewardsPace(0, 4000, 2000)
    for k in range(2):
        pace.begin_rollout(10.0 * k)
        pace.end_rollout(10.0 * (k + 1), 1000 * (k + 1))
    assert pace.left(20.0) is None  # one rollout that compiles, another
    pace = RewardsPace(1000, 5000, 2000)
    for k in range(3):
        pace.begin_rollout(10.0 * k)
        pace.end_rollout(10.0 * (k + 1), 2000 + 1000 * k)
    assert pace.left(30.0) == (10.0, False)
    assert pace.left(30.0, (40.0, 15.0)) == (10.0 + 15.0 + 40.0, True)


LENGTHS = {
    "alike": lambda random, n: np.full(n, 300),
    "spread": lambda random, n: random.lognormal(5.5, 0.5, n).astype(int) + 5,
    "many crash early": lambda random, n: np.where(random.random(n) < 0.6, 40, 350) + random.integers(0, 60, n),
}


@pytest.mark.parametrize("name", list(LENGTHS))
def test_evaluation_in_worlds_in_step_is_told_right_after_a_fifth(name):
    right = {share: [] for share in SHARES}
    for seed in range(12):
        random = np.random.default_rng(seed)
        ends = [np.cumsum(LENGTHS[name](random, 10)) for _ in range(32)]
        whole = max(int(end[-1]) for end in ends)
        ended = np.zeros((whole + 1, 32), bool)
        for slot, end in enumerate(ends):
            ended[end, slot] = True
        length = EvaluationLength(np.full(32, 10))
        for step in range(1, whole + 1):
            length.step(ended[step])
            for share in SHARES:
                if step == round(share * whole) and (left := length.left()) is not None:
                    right[share].append(within_factor(left, whole - step))
        assert length.left() == 0.0
    assert all(len(found) > 10 for found in right.values())
    assert np.mean(right[0.2] + right[0.5]) > 0.9
    assert np.mean(right[0.8]) > 0.6  # what is left is the luck of the last few


def test_nothing_is_said_of_an_evaluation_in_which_nothing_has_ended_unless_there_was_one_before():
    first, second = EvaluationLength(np.full(8, 2)), EvaluationLength(np.full(8, 2), [200] * 16)
    for length in (first, second):
        for _ in range(100):
            length.step(np.zeros(8, bool))
    assert first.left() is None
    assert second.left() == pytest.approx(300.0)

"""What sees the truth in training is refused unless the recipe says so; where it may, it sees each world's own."""

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_gym.batch import NavigationBatch
from arena_gym.building import build_parts, compose_environment

WORDS = [
    "guide=driving",
    "observation_encoder.foreseen=[1.0]",
    "environment.worlds=2",
    "environment.problems_per_world=2",
]
TRACKED = [*WORDS, "tracker@guide.tracker=ground_truth"]


def parts_of(*words):
    return build_parts(compose_environment(list(words), observation_encoder="rosnav_sectors"))


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (TRACKED, "tracker ground_truth"),
        ([*WORDS, "tracker@guide.tracker=kalman", "predictor@guide.predictor=truth"], "predictor truth"),
    ],
)
def test_what_sees_the_truth_is_refused_in_one_line(words, named):
    with pytest.raises(
        ConfigurationError, match=f"^{named} would see the truth in training; allowed: .* privileged=true"
    ):
        parts_of(*words)


def test_a_recipe_that_says_so_shows_each_robot_the_truth_of_its_own_world():
    batch = NavigationBatch(parts_of(*TRACKED, "predictor@guide.predictor=truth", "privileged=true"), 3)
    batch.reset([0, 1, 2])
    batch.drive(np.zeros((3, 3)))
    seen = 0
    for slot, (tracks, ahead) in enumerate(zip(batch.seen.tracks, batch.seen.predictions, strict=True)):
        people = batch.snapshot.crowd.world(slot)
        for track, number in enumerate(tracks.ids):
            (row,) = np.flatnonzero(people.ids == number)
            off = np.hypot(*(tracks.positions[track] - people.positions[row]))
            assert off < 0.5  # the error of the robot's pose
            assert len(ahead.times) > 2
            seen += 1
    assert seen > 0


def test_predictions_of_one_world_are_those_it_has_alone():
    words = [*WORDS, "tracker@guide.tracker=kalman", "predictor@guide.predictor=social_force"]
    together, alone = NavigationBatch(parts_of(*words), 3), NavigationBatch(parts_of(*words), 1)
    together.reset([4, 5, 6])
    alone.reset([5])
    for _ in range(25):
        together.drive(np.tile((0.2, 0.0, 0.1), (3, 1)))
        alone.drive(np.array(((0.2, 0.0, 0.1),)))
        assert (together.seen.predictions[1].means == alone.seen.predictions[0].means).all()

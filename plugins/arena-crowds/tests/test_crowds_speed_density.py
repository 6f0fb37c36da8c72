from pathlib import Path

import numpy as np
import pytest

from arena_crowds.replay.recordings import read_recording
from arena_crowds.validation.command import build_model
from arena_crowds.validation.floor_plan import Area
from arena_crowds.validation.fundamental_diagram import bin_speeds, measure_density_speed, weidmann_speed
from arena_crowds.validation.speed_density import FRAME_RATE, RECORDED, simulated_curve

JUELICH = Path(__file__).resolve().parents[4] / "shared" / "data" / "pedestrians" / "juelich"


@pytest.fixture(scope="module")
def recorded():
    """Return binned density and speed of both recordings together."""
    if not JUELICH.is_dir():
        pytest.skip("the recorded trajectories are not beside the repository")
    walks = [read_recording(path, "juelich").sample_positions(FRAME_RATE) for path in sorted(JUELICH.glob("uo-*.txt*"))]
    densities, speeds = zip(*(measure_density_speed(walk, FRAME_RATE, RECORDED) for walk in walks), strict=True)
    return bin_speeds(np.concatenate(densities), np.concatenate(speeds), 0.25, 16)


def test_speed_and_density_of_a_made_up_flow():
    times = np.arange(0.0, 10.0, 0.1)
    positions = np.stack((np.stack([2.0 * times - k for k in range(20)], axis=1), np.full((100, 20), 0.5)), axis=-1)
    density, speed = measure_density_speed(positions, 10.0, Area(2.25, 6.25, 0.0, 1.0))
    assert speed == pytest.approx(2.0)
    assert density[50] == 1.0
    assert density.max() == 1.0


def test_absent_people_do_not_count():
    positions = np.full((20, 3, 2), np.nan)
    positions[:, 1] = np.stack((np.linspace(0.0, 1.9, 20), np.ones(20)), axis=1)
    density, speed = measure_density_speed(positions, 10.0, Area(0.5, 1.5, 0.0, 2.0))
    assert density == pytest.approx(0.5)
    assert speed == pytest.approx(1.0)


def test_weidmann_gives_his_own_figures():
    assert weidmann_speed(np.array([0.5, 1.0, 2.0, 3.0, 4.0])) == pytest.approx(
        [1.30, 1.06, 0.61, 0.33, 0.16], abs=0.006
    )


def test_recorded_speed_falls_with_density(recorded):
    densities, speeds = recorded
    assert densities[-1] > 1.2
    assert speeds[0] - speeds[-1] > 0.25


@pytest.mark.slow
def test_simulated_speed_falls_with_density_as_recorded(recorded):
    densities, speeds = simulated_curve(build_model("social_force", []))
    assert densities[-1] > 2.0
    assert (np.diff(speeds[densities > 0.5]) < 0.0).all()
    assert np.abs(np.interp(recorded[0], densities, speeds) - recorded[1]).max() < 0.14
    assert np.abs(np.interp(recorded[0], densities, speeds) - recorded[1]).mean() < 0.09
    beyond = densities > 1.3  # where nothing was recorded, Weidmann's curve for the same free speed
    assert np.abs(speeds - weidmann_speed(densities, 1.48))[beyond].max() < 0.13


@pytest.mark.slow
def test_without_sight_people_would_not_slow_down_as_recorded():
    """Pushed from behind as much as from ahead, a queue does not brake: the reason for ``rear_weight``."""
    densities, speeds = simulated_curve(build_model("social_force", ["pedestrians.social.rear_weight=1.0"]), (15, 105))
    assert speeds[-1] - weidmann_speed(densities[-1:], 1.48)[0] > 0.3

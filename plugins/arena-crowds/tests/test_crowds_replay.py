import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ABSENT, ConfigurationError, ImpossibleScenario, InputFileError, local_path
from arena_core.testing import component
from arena_crowds.replay.recordings import read_recording


def replay(*overrides):
    return component("pedestrians", "replay", [f"pedestrians.{override}" for override in overrides])


@pytest.fixture
def two_walks(tmp_path):
    """Return a recording: person 4 is there from 0 to 2 s along x, person 9 from 1 to 3 s along a bend."""
    rows = [(25 * k, 4, 1.0 * k, 0.0) for k in range(3)] + [(25 * k, 9, 5.0, float(k * k)) for k in (1, 2, 3)]
    path = tmp_path / "walks.txt"
    path.write_text("# framerate: 25\n# frame id x/m y/m\n" + "".join(" ".join(map(str, row)) + "\n" for row in rows))
    return path


def test_people_are_where_they_were_recorded(stage, street):
    rows = np.loadtxt(street)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    model = replay(f"path={street}", "format=obsmat", "start_time=0.0")
    crowd = model.reset(np.zeros(1, np.int64), [stage.scenario(stage.hall(20, 20))], 1)
    frame, seen = rows[0, 0], 0
    for tick in range(1201):
        if tick % 8 == 0:
            there = {int(row[1]): row[[2, 4]] for row in rows if row[0] == frame}
            people = crowd.world(0)
            present = people.states != ABSENT
            assert set(people.ids[present].tolist()) == set(there)
            assert all((people.positions[k] == there[int(people.ids[k])]).all() for k in np.flatnonzero(present))
            assert np.isnan(people.positions[~present]).all()
            frame, seen = frame + 10, seen + len(there)
        crowd = model.step(crowd, stage.robots(), np.full(1, tick), 0.05)
    assert seen > 300


@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
def test_walks_have_no_jumps_and_velocities_are_theirs(interpolation):
    recording = read_recording(local_path("pkg://arena_crowds/recordings/crossing.txt"), "frames")
    walk, cubic = 3, interpolation == "cubic"
    times = np.arange(recording.begins[walk] + 0.01, recording.ends[walk] - 0.01, 0.002)
    positions, velocities = recording.at(np.full(len(times), walk), times, cubic)
    steps = np.diff(positions, axis=0) / 0.002
    assert np.hypot(*steps.T).max() < 2.5
    if cubic:
        assert np.abs(steps - 0.5 * (velocities[1:] + velocities[:-1])).max() < 0.02
        assert np.hypot(*np.diff(velocities, axis=0).T).max() < 0.05


def test_between_samples_the_cubic_follows_a_bend(two_walks):
    recording = read_recording(two_walks, "frames")
    positions, velocities = recording.at(np.array([1, 0, 0]), np.array([2.5, 0.5, 0.5]), True)
    assert positions[0] == pytest.approx((5.0, 6.375))
    assert positions[1] == pytest.approx((0.5, 0.0))
    assert velocities[1] == pytest.approx((1.0, 0.0))
    linear, _ = recording.at(np.array([1]), np.array([2.5]), False)
    assert linear[0] == pytest.approx((5.0, 6.5))


def test_people_appear_and_vanish_as_recorded(stage, two_walks):
    model = replay(f"path={two_walks}", "start_time=0.0")
    states = [crowd.states[0].tolist() for crowd in stage.walk(model, [stage.scenario(stage.hall(9, 9))], 3.5, dt=0.5)]
    assert [[state != ABSENT for state in row] for row in states] == [
        [True, False],
        [True, True],
        [True, True],
        [True, True],
        [False, True],
        [False, True],
        [False, False],
    ]


def test_only_those_are_in_a_world_who_come_within_the_time_limit(stage, two_walks):
    short = stage.scenario(stage.hall(9, 9), limit=0.5)
    assert replay(f"path={two_walks}", "start_time=0.0").reset(np.zeros(1, np.int64), [short], 1).world(0).ids.tolist() == [4]
    assert replay(f"path={two_walks}", "start_time=2.5").reset(np.zeros(1, np.int64), [short], 1).world(0).ids.tolist() == [9]


@settings(max_examples=15)
@given(st.floats(-3.2, 3.2), st.floats(-9.0, 9.0), st.floats(0.3, 3.0))
def test_a_recording_is_turned_shifted_and_sped_up(stage, two_walks, turn, shift, speed):
    model = replay(f"path={two_walks}", "start_time=0.0", f"rotation={turn}", f"offset_xy=[{shift},2.0]", f"speed={speed}")
    crowd = model.reset(np.zeros(1, np.int64), [stage.scenario(stage.hall(9, 9))], 1)
    crowd = model.step(crowd, stage.robots(), np.zeros(1, np.int64), 0.5 / speed)
    assert crowd.positions[0, 0] == pytest.approx((shift + 0.5 * np.cos(turn), 2.0 + 0.5 * np.sin(turn)))
    assert crowd.velocities[0, 0] == pytest.approx((speed * np.cos(turn), speed * np.sin(turn)))


def test_start_times_are_drawn_from_the_scenario_and_leave_its_start_clear(stage):
    model = replay()
    scenarios = [stage.scenario(stage.hall(9, 9), name=f"stage/{k}", limit=10.0) for k in range(30)]
    first, again = (model.reset(np.arange(30), scenarios, 30) for _ in range(2))
    assert np.array_equal(first.positions, again.positions, equal_nan=True)
    assert len({tuple(world.positions.ravel().tolist()) for world in map(first.world, range(30))}) > 20
    assert not (np.hypot(*(first.positions - (1.0, 1.0)).transpose(2, 0, 1)) < 1.0).any()


def test_a_start_that_is_never_clear_is_one_line(stage):
    model = replay("clear_start=50.0")
    with pytest.raises(ImpossibleScenario, match="at 100 times of the recording somebody was within 50 m"):
        model.reset(np.zeros(1, np.int64), [stage.scenario(stage.hall(9, 9), limit=1.0)], 1)


def test_recorded_people_go_on_from_where_the_robot_held_them_up(stage, two_walks):
    model = replay(f"path={two_walks}", "start_time=0.0")
    crowd = model.reset(np.zeros(1, np.int64), [stage.scenario(stage.hall(9, 9))], 1)
    crowd.positions[0, 0] -= 0.3
    crowd = model.step(crowd, stage.robots((0.5, 0.0, 0.0)), np.zeros(1, np.int64), 0.5)
    assert crowd.positions[0, 0] == pytest.approx((0.5, 0.0))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("1 2 3\n", "row 1 has 3 numbers; allowed: rows of 4 numbers for format frames"),
        ("0 1 0 0\n\n10 1 x 0\n", "could not convert"),
        ("0 1 0 0\n0 1 1 1\n", "person 1 is twice in frame 0"),
        ("0 1 nan 0\n", "a number is not finite"),
        ("# nobody\n", "no row"),
    ],
)
def test_a_bad_recording_is_one_line(tmp_path, content, says):
    path = tmp_path / "bad.txt"
    path.write_text(content)
    with pytest.raises(InputFileError) as error:
        replay(f"path={path}")
    assert says in str(error.value)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("path=/nowhere/walks.txt", "/nowhere/walks.txt: .*No such file"),
        ("start_time=1e6", "pedestrians.start_time is 1e\\+06; allowed: below"),
        ("offset_xy=[1.0]", "pedestrians.offset_xy has 1 numbers; allowed: 2"),
        ("format=csv", "pedestrians.format is 'csv'; allowed: one of frames, obsmat, juelich"),
    ],
)
def test_bad_settings_are_one_line(override, says):
    with pytest.raises((InputFileError, ConfigurationError), match=says):
        replay(override)

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ABSENT, ConfigurationError, ImpossibleScenario, InputFileError, Obstacle
from arena_core.files import local_path
from arena_core.testing import component, robot
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
    positions, velocities = recording.at(np.full(len(times), walk), times, cubic=cubic)
    steps = np.diff(positions, axis=0) / 0.002
    assert np.hypot(*steps.T).max() < 2.5
    if cubic:
        assert np.abs(steps - 0.5 * (velocities[1:] + velocities[:-1])).max() < 0.02
        assert np.hypot(*np.diff(velocities, axis=0).T).max() < 0.05


def test_between_samples_the_cubic_follows_a_bend(two_walks):
    recording = read_recording(two_walks, "frames")
    positions, velocities = recording.at(np.array([1, 0, 0]), np.array([2.5, 0.5, 0.5]), cubic=True)
    assert positions[0] == pytest.approx((5.0, 6.375))
    assert positions[1] == pytest.approx((0.5, 0.0))
    assert velocities[1] == pytest.approx((1.0, 0.0))
    linear, _ = recording.at(np.array([1]), np.array([2.5]), cubic=False)
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
    assert replay(f"path={two_walks}", "start_time=0.0").reset(np.zeros(1, np.int64), [short], 1).world(
        0
    ).ids.tolist() == [4]
    assert replay(f"path={two_walks}", "start_time=2.5").reset(np.zeros(1, np.int64), [short], 1).world(
        0
    ).ids.tolist() == [9]


@pytest.mark.slow
@settings(max_examples=15)
@given(st.floats(-3.2, 3.2), st.floats(-9.0, 9.0), st.floats(0.3, 3.0))
def test_a_recording_is_turned_shifted_and_sped_up(stage, two_walks, turn, shift, speed):
    model = replay(
        f"path={two_walks}", "start_time=0.0", f"rotation={turn}", f"offset_xy=[{shift},2.0]", f"speed={speed}"
    )
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
    with pytest.raises(ImpossibleScenario, match="at 100 times of the recording a person was within 50 m"):
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
        ("# no one\n", "no row"),
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


@pytest.fixture
def straight(tmp_path):
    """Return a recording: person 3 walks from x = 1 to 9 at y = 5 in 8 s, through whatever is there."""
    path = tmp_path / "straight.txt"
    path.write_text(
        "# framerate: 5\n# frame id x/m y/m\n" + "".join(f"{k} 3 {1.0 + 0.2 * k:.1f} 5\n" for k in range(41))
    )
    return path


@pytest.mark.parametrize(
    "walls", [(), ((4.0, 3.0, 4.05, 9.0),), ((3.0, 2.0, 7.0, 9.0),)], ids=["open", "thin", "thick"]
)
def test_a_recorded_person_walks_through_walls_and_obstacles_in_a_run(stage, straight, walls, capsys):
    grid = stage.hall(10, 10, walls)
    obstacle = Obstacle(np.array([[8.0, 5.0]]), 0.3)
    scenario = replace(stage.scenario(grid), obstacles=(obstacle,))
    people = replay(f"path={straight}", "start_time=0.0")
    simulator = component("simulator", "sim2d", robot=robot(), pedestrians=people)
    snapshot = simulator.reset([scenario])
    for _ in range(70):
        snapshot = simulator.advance(np.zeros((1, 3)), round(0.1 / simulator.inner_step))
        assert snapshot.crowd.positions[0, 0] == pytest.approx((1.0 + float(snapshot.stamps[0]), 5.0), abs=1e-6)
    told = f"{straight}: person 3, and maybe others, walk through walls of hall"
    assert (told in capsys.readouterr().err) == bool(walls)


def test_a_person_who_left_for_a_while_was_not_there(stage, tmp_path):
    path = tmp_path / "absence.txt"
    seen = [*range(11), *range(50, 61)]  # at 5 frames a second: two seconds, eight seconds away, two seconds
    path.write_text(
        "# framerate: 5\n# frame id x/m y/m\n"
        + "".join(f"{k} 3 {0.2 * k:.1f} {5.0 if k < 20 else 7.0}\n" for k in seen)
    )
    model = replay(f"path={path}", "start_time=0.0")
    crowds = list(stage.walk(model, [stage.scenario(stage.hall(20, 20))], 11.9, dt=0.1))
    there = [crowd.states[0, 0] != ABSENT for crowd in crowds]
    assert [k for k in range(1, 119) if there[k] != there[k - 1]] == [20, 99]
    assert {
        tuple(np.round(crowd.velocities[0, 0], 6)) for crowd, is_there in zip(crowds, there, strict=True) if is_there
    } == {(1.0, 0.0)}
    recording = read_recording(path, "frames")
    assert recording.longest_gap == pytest.approx(1.0)


def test_rare_samples_are_no_absences(tmp_path):
    path = tmp_path / "rare.txt"
    path.write_text(
        "# framerate: 1\n# frame id x/m y/m\n" + "".join(f"{3 * k} 3 {3.0 * k} 0\n" for k in (0, 1, 2, 4, 5, 6))
    )
    recording = read_recording(path, "frames")
    positions, _ = recording.at(np.zeros(7, np.int64), np.arange(7.0, 14.0))
    assert np.isfinite(positions).all()

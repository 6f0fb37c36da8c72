"""What of a planner is searched when it is tuned: files that planners ship, read, checked, tried by `arena check`."""

from pathlib import Path

import pytest

from arena_core import ConfigurationError, InputFileError
from arena_core.config.search_spaces import read_search_space
from arena_core.files import option_files
from arena_core.hosting import check_search_space, compose, load_registry, search_space_of, to_plain, values_of

PLANNERS = ("dwa", "teb", "mpc", "mppi", "orca", "cadrl", "sarl")
ROBOTS = ("turtlebot3", "jackal", "robotino", "jackal_ackermann")


def planner_of(preset, robot):
    return to_plain(compose([f"planner={preset}", f"robot={robot}"], "component"))["planner"]


@pytest.mark.parametrize("preset", PLANNERS)
def test_values_of_every_robot_lie_inside_the_ranges_of_a_planner(preset):
    registry = load_registry()
    space = search_space_of(preset, preset, registry)
    assert all(one.why and one.unit for one in space.parameters.values())
    for robot in ROBOTS:
        check_search_space(space, planner_of(preset, robot), registry)


def test_a_preset_is_searched_as_the_planner_that_it_is_of():
    registry = load_registry()
    assert search_space_of("mpc_quadratic", "mpc", registry) == search_space_of("mpc", "mpc", registry)
    assert search_space_of("mppi", "mppi", registry).sampler == "cmaes"


def test_a_planner_without_a_space_is_refused_with_those_that_have_one():
    with pytest.raises(ConfigurationError, match=r"pure_pursuit has no search space, tune/pure_pursuit.yaml .* teb"):
        search_space_of("pure_pursuit", "pure_pursuit", load_registry())


SIM_TIME = "{low: 0.6, high: 3.0, unit: s, why: it looks so far ahead}"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "lacks parameters"),
        ("parameters: {}", "parameters is empty"),
        ("parameters: [a]", "parameters is ..a..; allowed: a mapping"),
        ("parameters: {a: {low: 1, unit: s, why: x}}", "parameters.a lacks low or high"),
        ("parameters: {a: {low: 2, high: 1, unit: s, why: x}}", "parameters.a is 2 .. 1, which holds no value"),
        ("parameters: {a: {low: 0, high: 1, log: true, unit: s, why: x}}", "parameters.a begins at 0 and is log"),
        ("parameters: {a: {low: 0.5, high: 2, integer: true, unit: s, why: x}}", "whole numbers"),
        ("parameters: {a: {choices: [one], unit: s, why: x}}", "parameters.a has no two choices"),
        ("parameters: {a: {low: 0, high: 1, unit: s}}", "parameters.a lacks why"),
        (f"parameters: {{a: {SIM_TIME}}}\nsampler: best", "sampler is 'best'; allowed: one of tpe, cmaes, random"),
        ("parameters: {a: {low: 1", "is no YAML"),
    ],
)
def test_a_file_that_is_no_search_space_is_refused_in_one_line(tmp_path, text, fault):
    file = tmp_path / "dwa.yaml"
    file.write_text(text)
    with pytest.raises(InputFileError, match=fault) as refusal:
        read_search_space(file)
    assert str(file) in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("key", "limits", "fault"),
    [
        ("roll_out.sim_tim", "low: 0.6, high: 3.0", "no parameter roll_out.sim_tim, which is searched; did you mean"),
        ("roll_out", "low: 0.6, high: 3.0", "outside of what is searched"),
        ("roll_out.sim_time", "low: 5.0, high: 6.0", "planner.roll_out.sim_time is 1.5, outside of what is searched"),
        ("approach.time", "low: -3.0, high: 3.0", ""),
    ],
)
def test_a_space_that_does_not_fit_its_planner_is_refused(tmp_path, key, limits, fault):
    file = tmp_path / "dwa.yaml"
    file.write_text(f"parameters: {{{key}: {{{limits}, unit: s, why: it looks so far ahead}}}}")
    planner = planner_of("dwa", "turtlebot3")
    if not fault:
        check_search_space(read_search_space(file), planner, load_registry())
        return
    with pytest.raises(ConfigurationError, match=fault):
        check_search_space(read_search_space(file), planner, load_registry())


def test_a_range_without_a_value_that_the_planner_takes_is_refused(tmp_path):
    file = tmp_path / "pure_pursuit.yaml"
    file.write_text("parameters: {gain: {choices: [fast, slow], unit: '-', why: it takes numbers}}")
    planner = {**planner_of("pure_pursuit", "turtlebot3"), "gain": "fast"}
    with pytest.raises(ConfigurationError, match=r"planner.gain, fast, slow, holds no valid value: planner.gain is"):
        check_search_space(read_search_space(file), planner, load_registry())


def test_arena_check_tries_the_space_of_a_stack_on_every_robot(arena):
    answer = arena("check", "tune=stack")
    assert (answer.status, answer.out.strip()) == (
        0,
        "ok tune=stack: its ranges are valid and hold the stack's values",
    )
    answer = arena("check", "tune=stack", "localizer.laser.z_rand=0.6", "robot=jackal")
    assert answer.status == 1
    assert answer.out.startswith("BROKEN tune=stack (robot=jackal): localizer.laser.z_rand is 0.6, outside of what is")


def test_the_values_of_a_planner_are_those_that_are_searched():
    planner = planner_of("dwa", "turtlebot3")
    values = values_of(search_space_of("dwa", "dwa", load_registry()), planner)
    assert values["critics.path_distance_bias"] == planner["critics"]["path_distance_bias"]
    assert "limits.vx_max" not in values


def test_users_add_spaces_in_a_folder_of_their_own_and_arena_check_tests_them(arena):
    file = Path("conf/tune/pure_pursuit.yaml")
    file.parent.mkdir(parents=True)
    file.write_text("parameters: {gain: {low: 0.5, high: 5.0, log: true, unit: '-', why: how sharply it turns}}")
    assert "pure_pursuit" in option_files("tune", load_registry().manager)
    answer = arena("check", "planner=pure_pursuit")
    assert (answer.status, answer.out.splitlines()[-1]) == (
        0,
        "ok tune=pure_pursuit: its ranges are valid and hold the planner's values",
    )
    file.write_text("parameters: {gane: {low: 0.5, high: 5.0, log: true, unit: '-', why: how sharply it turns}}")
    answer = arena("check", "planner=pure_pursuit")
    assert answer.status == 1
    assert answer.out.splitlines()[-1].startswith("BROKEN tune=pure_pursuit (robot=")

"""`arena check` tries everything that is installed."""

import pytest

CHOOSY = """
    from arena_core import ConfigurationError, Robot, hookimpl
    from arena_pure_pursuit import PurePursuit

    class Choosy(PurePursuit):
        def __init__(self, robot: Robot, gain: float) -> None:
            if (robot.name, gain) not in (("jackal", 2.0), ("robotino", 1.0)):
                raise ConfigurationError(f"choosy: gain is {gain} on {robot.name}; allowed: as trained")
            super().__init__(robot, None, 1.0, 2.0)

    @hookimpl
    def register_planners(register):
        register("choosy", Choosy)

    @hookimpl
    def config_package():
        return "choosy.conf"
"""
PRESET = """
    defaults:
      - _self_
      - optional choosy_tuning@_here_: ${robot}
    name: choosy
    gain: 1.0
"""


@pytest.mark.slow
def test_everything_installed_holds_its_contract_or_needs_a_file(arena):
    answer = arena("check", "all")
    lines = answer.out.splitlines()
    assert answer.status == 0, [line for line in lines if line.startswith("BROKEN")]
    assert {line.split()[1] for line in lines if line.startswith("--")} == {
        "executor=slurm",
        "world=barn",
        "world=file",
        "metrics=survey",
        "world=ros_map",
        "world=scenario_map",
        "task=barn",
        "task=dynabarn",
        "task=replace",
        "task=scenario",
        "planner=ros_external",
        "observation_encoder=navrep",
        "observation_encoder=navrep_v_only",
    }


@pytest.fixture
def choosy(third_party):
    third_party.package("choosy", CHOOSY, {"planner/choosy": PRESET, "planner/choosy_tuning/jackal": "gain: 2.0\n"})


def test_planner_that_knows_robots_by_name_is_checked_tuned_for_each(choosy, arena):
    answer = arena("check", "planner=choosy")
    assert (answer.status, answer.errors) == (0, [])
    assert [line.split(" on ")[1] for line in answer.out.splitlines()] == [
        "jackal with differential drive",
        "robotino with omnidirectional drive",
    ]


def test_robot_that_was_checked_is_said_even_where_it_is_the_only_one(choosy, arena):
    answer = arena("check", "planner=choosy", "robot=jackal")
    assert answer.out.splitlines()[0].endswith("facts hold on jackal with differential drive")
    assert len(answer.out.splitlines()) == 1


def test_planner_that_no_robot_fits_says_what_the_first_one_lacks(choosy, arena):
    answer = arena("check", "planner=choosy", "planner.gain=3.0")
    assert answer.status == 2
    assert "choosy: gain is 3.0 on jackal" in answer.errors[0]


@pytest.mark.parametrize("word", ["world=warehouse", "metrics=si", "dwa.gain=1", "planner=dwa"])
def test_a_word_that_says_nothing_of_the_component_is_refused(word, arena):
    answer = arena("check", "planner=pure_pursuit", word)
    assert (answer.status, answer.line) == (
        2,
        f"arena: {word} says nothing of planner=pure_pursuit; allowed: planner.KEY=VALUE, robot=NAME",
    )


SIDEWAYS = """
    from arena_core import ConfigurationError, Robot, hookimpl
    from arena_pure_pursuit import PurePursuit

    class Sideways(PurePursuit):
        def __init__(self, robot: Robot) -> None:
            if robot.kinematics == "ackermann":
                raise ConfigurationError("sideways: robot has ackermann drive; allowed: differential, omnidirectional")
            super().__init__(robot, None, 1.0, 2.0)

    @hookimpl
    def register_planners(register):
        register("sideways", Sideways)

    @hookimpl
    def config_package():
        return "sideways.conf"
"""


def test_a_drive_that_a_planner_refuses_is_named_and_the_others_are_tried(third_party, arena):
    third_party.package("sideways", SIDEWAYS, {"planner/sideways": "name: sideways\n"})
    answer = arena("check", "planner=sideways")
    first, *held = answer.out.splitlines()
    assert answer.status == 0
    assert first.startswith(
        "-- planner=sideways drives no robot with ackermann drive: sideways: robot has ackermann drive"
    )
    assert [line.split(" with ")[1] for line in held] == ["differential drive", "omnidirectional drive"]


WISHFUL = """
    from arena_core import Metric, MetricPack, hookimpl

    class Wishful(MetricPack):
        def metrics(self):
            return [Metric("steps", "-", "less", "control steps", lambda record: float(len(record["stamp"]) - 1))]

    @hookimpl
    def register_metrics(register):
        register("wishful", Wishful)

    @hookimpl
    def config_package():
        return "wishful.conf"
"""


def test_a_wish_that_no_table_knows_breaks_the_contract(third_party, arena):
    third_party.package("wishful", WISHFUL, {"metrics/wishful": "# @package metrics.wishful\nname: wishful\n"})
    answer = arena("check", "metrics=wishful")
    assert answer.status == 1
    assert "not so: better is higher, lower, neither" in answer.out


TALES = """
    from arena_core import hookimpl
    from arena_core.commands import Command

    class Tell(Command):
        help = "tell a tale"
        checks = "tale"

        def run(self, arguments):
            return 0

        def check(self, name, overrides):
            print(name, *overrides)
            return 3

    @hookimpl
    def register_commands(register):
        register("tell", Tell)
"""


def test_a_command_checks_options_that_no_component_is_of(third_party, arena):
    third_party.package("tales", TALES, {})
    answer = arena("check", "tale=short", "tale.end=good")
    assert (answer.status, answer.out) == (3, "short tale.end=good\n")
    assert "tale" in arena("check", "tail=short").line

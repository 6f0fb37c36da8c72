import pytest

from arena_core.listing import _parameters

PLUGIN = """
    from arena_core import hookimpl

    @hookimpl
    def register_planners(register):
        register("steady", "steady.planner:Steady")

    @hookimpl
    def config_package():
        return "steady.conf"
"""
NUMBERS = """\
# A planner that does one thing.
name: steady
defaults:
  - _self_
speed: 0.5     # [m/s] how fast (Someone 1999, table 2)
limit: null    # [rad/s] turning; null: the robot's own
mode: "a b"    # [-] which way
plain: 3
remark: 4      # no unit here
weights:
  path: 32.0   # [-] nearness to the path
"""


@pytest.fixture
def steady(third_party):
    third_party.package("steady", PLUGIN, {"planner/steady": NUMBERS, "planner/steady_slow": "name: steady\nspeed: 0.1  # [m/s] slow\n"})


def test_defaults_units_and_sources_are_read_from_the_comments():
    assert list(_parameters(NUMBERS)) == [
        ("speed", "0.5", "m/s", "how fast (Someone 1999, table 2)"),
        ("limit", "null", "rad/s", "turning; null: the robot's own"),
        ("mode", '"a b"', "-", "which way"),
        ("plain", "3", "", ""),
        ("remark", "4", "", "no unit here"),
        ("weights", "", "", ""),
        ("  path", "32.0", "-", "nearness to the path"),
    ]


def test_one_kind_is_listed_with_distribution_presets_parameters_and_units(steady, arena):
    answer = arena("list", "planner")
    assert answer.status == 0
    assert "  steady                 steady 1.2.3   presets: steady_slow\n" in answer.out
    line = next(line for line in answer.out.splitlines() if "how fast" in line)
    assert line.split(maxsplit=3) == ["speed", "0.5", "m/s", "how fast (Someone 1999, table 2)"]


def test_names_alone_come_one_a_line(steady, arena):
    assert arena("list", "executor", "--names").out == "processes\nserial\n"
    assert "steady" in arena("list", "planner", "--names").out.split()


def test_all_kinds_are_listed_in_short(steady, arena):
    out = arena("list").out
    assert "executor\n" in out
    assert "how fast" not in out


def test_an_unknown_kind_is_one_line_with_the_possible_kinds(arena):
    answer = arena("list", "planers")
    assert answer.status == 2
    assert answer.line.startswith("arena: unknown kind 'planers'; did you mean planner? (possible: simulator, robot, ")


def test_a_kind_of_which_nothing_is_installed_says_so(arena, monkeypatch):
    monkeypatch.setenv("ARENA_DISABLED_PLUGINS", "gym")
    assert arena("list", "reward").out == "reward: none installed\n"

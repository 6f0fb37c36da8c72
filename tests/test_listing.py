from collections import Counter
from importlib.metadata import PathDistribution
from pathlib import Path

import pytest
import yaml

from arena_core import InputFileError
from arena_core.config.plugins import _read_distributions
from arena_core.config.presets import _parse_yaml, read_preset

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
mode: "a #b"   # [-] which way
plain: 3
remark: 4      # no unit here
weights:       # of the critics
  path: 32.0   # [-] nearness to the path
body: {corners: [[0, 1], [2, 3]]}  # [m] an outline
"""


@pytest.fixture
def steady(third_party):
    third_party.package(
        "steady", PLUGIN, {"planner/steady": NUMBERS, "planner/steady_slow": "name: steady\nspeed: 0.1  # [m/s] slow\n"}
    )


def parameters(preset):
    return [(".".join(p.path), p.value, p.unit, p.text) for p in preset.parameters.values()]


def write(folder, **texts):
    for name, text in texts.items():
        (folder / f"{name}.yaml").write_text(text)
    return {name: folder / f"{name}.yaml" for name in texts}


def test_defaults_units_and_sources_are_read_from_values_and_comments(tmp_path):
    preset = read_preset("steady", write(tmp_path, steady=NUMBERS))
    assert (preset.about, preset.component) == ("A planner that does one thing.", "steady")
    assert parameters(preset) == [
        ("speed", "0.5", "m/s", "how fast (Someone 1999, table 2)"),
        ("limit", "null", "rad/s", "turning; null: the robot's own"),
        ("mode", '"a #b"', "-", "which way"),
        ("plain", "3", "", ""),
        ("remark", "4", "", "no unit here"),
        ("weights", "", "", "of the critics"),
        ("weights.path", "32.0", "-", "nearness to the path"),
        ("body", "", "m", "an outline"),
        ("body.corners", "[[0, 1], [2, 3]]", "", ""),
    ]


def test_a_preset_has_what_it_inherits_with_the_texts_of_its_base(tmp_path):
    careful = "# Slower.\ndefaults: [steady, _self_]\nspeed: 0.1\nweights: {path: 40.0}\nmode: c  # [-] another\n"
    hasty = "defaults:\n  - _self_\n  - careful\nspeed: 9.0\n"
    files = write(tmp_path, steady=NUMBERS, careful=careful, hasty=hasty)
    preset = read_preset("careful", files)
    assert (preset.about, preset.component) == ("Slower.", "steady")
    values = {name: (value, text) for name, value, _, text in parameters(preset)}
    assert values["speed"] == ("0.1", "how fast (Someone 1999, table 2)")
    assert values["weights.path"] == ("40.0", "nearness to the path")
    assert values["mode"] == ("c", "another")
    assert values["plain"] == ("3", "")
    assert {p.path: p.value for p in read_preset("hasty", files).parameters.values()}[("speed",)] == "0.1"


def test_a_list_is_told_on_one_line_without_the_comments_inside_it(tmp_path):
    ways = "ways: # [m] in turn\n  - near: 1.0  # [m] of the first\n    wide: [1, 2]\n  - {near: 2.0}\n"
    text = f"name: x\n{ways}speed: 1  # [m/s] x\n"
    assert parameters(read_preset("listed", write(tmp_path, listed=text))) == [
        ("ways", "[{near: 1.0, wide: [1, 2]}, {near: 2.0}]", "m", "in turn"),
        ("speed", "1", "m/s", "x"),
    ]


def test_options_that_inherit_from_each_other_have_an_end(tmp_path):
    files = write(tmp_path, a="defaults: [b]\nx: 1\n", b="defaults: [a]\ny: 2\n")
    assert parameters(read_preset("a", files)) == [("y", "2", "", ""), ("x", "1", "", "")]


@pytest.mark.parametrize(("text", "said"), [("a: [", "is no YAML"), ("- a\n", "is no mapping")])
def test_a_file_that_is_no_mapping_is_named(tmp_path, text, said):
    with pytest.raises(InputFileError, match=rf"broken.yaml: {said}.*; allowed: a mapping of keys and values"):
        read_preset("broken", write(tmp_path, broken=text))


def test_one_kind_is_listed_with_distribution_presets_parameters_and_units(steady, arena):
    answer = arena("list", "planner")
    assert answer.status == 0
    assert ["steady", "steady", "1.2.3", "presets:", "steady_slow"] in [
        line.split() for line in answer.out.splitlines()
    ]
    assert "    steady: A planner that does one thing.\n" in answer.out
    line = next(line for line in answer.out.splitlines() if "how fast" in line)
    assert line.split(maxsplit=3) == ["speed", "0.5", "m/s", "how fast (Someone 1999, table 2)"]


def test_experiments_are_listed_with_what_they_are(arena):
    Path("conf/experiment").mkdir(parents=True)
    Path("conf/experiment/ours.yaml").write_text("# @package _global_\n# What our paper cites.\nepisodes: 3\n")
    answer = arena("list", "experiment")
    assert answer.status == 0
    lines = dict(line.split(maxsplit=1) for line in answer.out.splitlines())
    assert lines["experiment=ours"] == "What our paper cites."
    assert lines["experiment=smoke"].startswith("A first look")
    assert "ours" in arena("list", "experiment", "--names").out.split()


def test_every_option_of_every_group_says_what_it_is(arena):
    lines = arena("list", "preset").out.splitlines()
    assert [line for line in lines if len(line.split()) < 3] == []
    named = {line.split()[0] for line in lines}
    assert {
        "planner=teb_as_released",
        "robot=jackal",
        "people=lifelike",
        "experiment=smoke",
        "scenario=arena/crossing_low",
    } <= named
    assert not any("_tuning" in name for name in named)


def test_listing_parses_each_file_once_and_by_the_compiled_parser(arena, monkeypatch):
    parsed, compose = [], yaml.compose
    _parse_yaml.cache_clear()

    def counted(text, loader):
        parsed.append((text, loader))
        return compose(text, loader)

    monkeypatch.setattr(yaml, "compose", counted)
    assert arena("list").status == 0
    assert len({text for text, _ in parsed}) > 50
    assert len(parsed) == len({text for text, _ in parsed})
    assert {loader for _, loader in parsed} == {yaml.CSafeLoader}


def test_metadata_of_each_distribution_is_read_once(arena, monkeypatch):
    read, read_text = Counter(), PathDistribution.read_text

    def counted(distribution, name):
        if name == "METADATA":
            read[distribution._path] += 1
        return read_text(distribution, name)

    monkeypatch.setattr(PathDistribution, "read_text", counted)
    _read_distributions.cache_clear()
    assert arena("list").status == 0
    assert len(read) > 10
    assert max(read.values()) == 1


def test_names_alone_come_one_a_line(steady, arena):
    assert arena("list", "executor", "--names").out == "processes\nray\nserial\nslurm\n"
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
    monkeypatch.setenv("ARENA_DISABLED_PLUGINS", "cadrl,gring,gym")
    assert arena("list", "reward").out == "reward: none installed\n"

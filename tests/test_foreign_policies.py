"""A package adds a preset with a policy of its own to a planner of another distribution."""

import json
from importlib.resources import files
from pathlib import Path

from arena_core import testing
from arena_core.hosting import compose, digest_code, load_registry, to_plain

HOOKS = """
from arena_core import hookimpl

@hookimpl
def register_policies(register):
    register("rosnav/rosnav_of_theirs", "pkg://theirs/policies")

@hookimpl
def config_package():
    return "theirs.conf"
"""
PRESET = "defaults:\n  - rosnav\n  - _self_\nname: rosnav\nrecipe: rosnav_of_theirs  # [-] what it was trained by\n"


def parts(*words):
    config = to_plain(compose(["robot=jackal", *words]))
    return digest_code(config, load_registry()).parts


def test_a_stranger_adds_a_policy_to_a_planner_that_is_not_its_own(third_party, tmp_path):
    third_party.package("theirs", HOOKS, {"planner/rosnav_of_theirs": PRESET})
    shipped, folder = files("arena_rosnav") / "policies", Path(tmp_path, "site", "theirs", "policies")
    folder.mkdir()
    (folder / "jackal.onnx").write_bytes((shipped / "jackal.onnx").read_bytes())
    card = json.loads((shipped / "jackal.json").read_text("utf-8"))
    (folder / "jackal.json").write_text(json.dumps({**card, "planner": "rosnav_of_theirs"}))
    robot = testing.component("robot", "jackal")
    planner = testing.component("planner", "rosnav_of_theirs", robot=robot)
    assert planner.card.planner == "rosnav_of_theirs"
    assert testing.check("planner", planner, robot)
    assert "theirs" in parts("planner=rosnav_of_theirs")
    assert "theirs" not in parts("planner=rosnav")


def test_who_brings_the_policy_is_code_of_the_run_and_who_brings_numbers_alone_is_not():
    assert "arena-replication" in parts("planner=gring_as_released")
    assert "arena-replication" in parts("planner=aio_as_released"), "its member ROSNAV has a policy of it, too"
    assert "arena-replication" not in parts("planner=gring")
    assert "arena-replication" not in parts("planner=dwa_as_released"), "its numbers are in the configuration"

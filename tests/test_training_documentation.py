"""The examples of docs/training.md run, and its tables say what the components have."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from arena_core.testing import check, component, robot

TOP = Path(__file__).resolve().parents[1]
TEXT = (TOP / "docs" / "training.md").read_text()
EXAMPLES = re.findall(r"^```python\n(.*?)^```$", TEXT, re.M | re.S)
SMALL = '"environment.worlds=1", "environment.problems_per_world=2", '


def test_first_example_drives_100_random_steps():
    names = {}
    exec(EXAMPLES[0], names)
    assert names["observation"] in names["env"].observation_space
    assert np.isfinite(names["reward"])


def test_examples_of_overrides_can_be_made():
    names = {}
    smaller = EXAMPLES[1].replace("num_envs=64", "num_envs=2").replace('"environment.worlds=32"', SMALL)
    exec(f"import gymnasium, arena_gym.envs\n{smaller}{EXAMPLES[3].replace('[', '[' + SMALL, 1)}", names)
    assert names["envs"].reset(seed=0)[0].shape == (2, names["envs"].single_observation_space.shape[0])
    names["env"].reset(seed=0)


def test_the_example_of_a_picture_is_one():
    names = {}
    exec(f"import gymnasium, arena_gym.envs\n{EXAMPLES[2]}", names)
    assert names["picture"].shape[2] == 3


def test_own_reward_and_encoder_hold_their_contracts():
    names = {}
    exec(next(example for example in EXAMPLES if "class Hurry" in example), names)
    body = robot()
    assert check("reward", names["Hurry"](10.0, 0.1), body)
    assert check("observation_encoder", names["Compass"](body), body)


def test_tables_of_settings_are_complete():
    config = yaml.safe_load((TOP / "plugins/arena-gym/src/arena_gym/conf/environment.yaml").read_text())
    defaults = {key: json.dumps(value) for key, value in config["environment"].items()}
    assert dict(re.findall(r"^\| `environment\.(\w+)` \| (\w+) \|", TEXT, re.M)) == defaults
    assert set(re.findall(r"^\| `randomization\.(\w+)` \|", TEXT, re.M)) == set(config["randomization"])


@pytest.mark.parametrize("preset", ["rosnav", "rosnav_sectors", "gring", "gring_as_released", "aio"])
def test_every_encoder_has_a_row(preset):
    assert f"| `{preset}` |" in TEXT
    assert component("observation_encoder", preset, robot=robot()).layout()

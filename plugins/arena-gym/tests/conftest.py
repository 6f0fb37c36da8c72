"""A folder whose conf/ holds a recipe that takes no time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from omegaconf import OmegaConf

HEAD = """# @package _global_
defaults:
  - override /observation_encoder: rosnav_sectors
  - override /reward: progress
  - override /world: empty
  - override /pedestrians: {pedestrians}

"""
TINY: dict[str, Any] = {
    "world": {"width": 6.0, "height": 6.0},
    "environment": {"worlds": 1, "problems_per_world": 8},
    "observation_encoder": {"sectors": 16},
    "training": {
        "network": {"beams_field": None, "convolutions": [], "features": None, "heads": [8], "log_std_init": -0.5},
        "optimization": {
            "environments": 4,
            "steps": 64,
            "minibatch": 64,
            "epochs": 2,
            "learning_rate": 0.002,
            "gamma": 0.97,
        },
        "validation": {"every": 600, "episodes": 4},
        "test": {"episodes": 4},
    },
}


@pytest.fixture
def write_recipe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """Give a function that writes the recipe for a planner of this name, with ``changes``, and
    works in its folder from then on.
    """

    def _write(planner: str, pedestrians: str = "none", **changes: Any) -> Path:
        (tmp_path / "conf" / "recipe").mkdir(parents=True)
        body = OmegaConf.to_yaml(OmegaConf.merge({"planner": planner, **TINY}, changes))
        (tmp_path / "conf" / "recipe" / f"{planner}.yaml").write_text(HEAD.format(pedestrians=pedestrians) + body)
        monkeypatch.chdir(tmp_path)
        return tmp_path

    return _write

"""The shapes of models that many scenario files name and seldom bring with them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import yaml


@cache
def published_models() -> Mapping[str, Mapping[str, Any]]:
    """Return Flatland models by name, as ``published_models.yaml`` states them, in the form of a Flatland file."""
    stated = yaml.safe_load(files("arena_tasks").joinpath("published_models.yaml").read_text("utf-8"))
    return {name: {"bodies": [{"footprints": [_model_footprint(said)]}]} for name, said in stated.items()}


def _model_footprint(said: Mapping[str, Any]) -> dict[str, Any]:
    shape = {"type": "polygon", "points": said["polygon"]} if "polygon" in said else _disc_footprint(*said["disc"])
    return {**shape, "collision": said.get("collision", True)}


def _disc_footprint(x: float, y: float, radius: float) -> dict[str, Any]:
    return {"type": "circle", "center": [x, y], "radius": radius}

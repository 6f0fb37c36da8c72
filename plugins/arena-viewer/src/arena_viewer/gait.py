"""How people of a record walk on their legs, as far as the record says it: the gait, and how everybody began."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, random_generator

GAIT = ("leg_radius", "stance_width", "step_width", "step_width_from", "walk_ratio", "apart", "settling")


def gait_of(meta: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the gait of a record's people, None where lidars see them as discs."""
    crowd = meta["config"].get("pedestrians")
    gait = crowd.get("gait") if isinstance(crowd, Mapping) and crowd.get("body") == "legs" else None
    if not isinstance(gait, Mapping) or not all(
        isinstance(gait.get(name), int | float) and gait[name] > 0 for name in GAIT
    ):
        return None
    return {name: float(gait[name]) for name in GAIT}


def gait_begin(record: EpisodeRecord) -> NDArray[np.float64]:
    """Return (P, 2) how far in two steps everybody began, and which way who stands looks, rad; NaN for who has no legs.

    The simulators draw it from the scenario's stream ``gait``: the same figures are drawn here.
    """
    scenario, people = record.meta["scenario"], len(record["pedestrian_ids"])
    random = random_generator(int(scenario["seed"]), str(scenario["name"]), "gait")
    drawn: NDArray[np.float64] = random.uniform((0.0, -math.pi), (2.0, math.pi), (people, 2))
    drawn[[not _has_legs(record.meta, number) for number in record["pedestrian_ids"].tolist()]] = np.nan
    return drawn


def _has_legs(meta: Mapping[str, Any], number: int) -> bool:
    """Return whether a person walks on legs: all do but those whose type takes no part
    in social states, forklifts say.
    """
    kind = (meta["scenario"].get("pedestrian_types") or {}).get(str(number))
    types = meta["config"]["pedestrians"].get("types")
    said = types.get(kind) if isinstance(types, Mapping) else None
    return not isinstance(said, Mapping) or said.get("sociable") is not False

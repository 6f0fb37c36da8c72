"""What holds for both packs: composition, documentation, speed of thought."""

import math
import re
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from arena_core.hosting import load_registry
from arena_core.records import build_metrics

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(scope="module")
def packs(preset_of):
    nodes = {name: {"name": name, **preset_of(name)} for name in ("si", "paper_legacy", "social")}
    return build_metrics({"metrics": nodes}, load_registry())


def test_packs_are_built_from_their_presets(packs):
    assert list(packs) == ["", "paper_legacy", "social"]
    assert {len(metrics) for metrics in packs.values()} == {53, 13, 42}


def test_every_metric_is_documented_with_its_formula(packs):
    text = (DOCS / "metrics.md").read_text() + (DOCS / "social_metrics.md").read_text()
    documented = {name for row in re.findall(r"^\| (`[^|]*)\|", text, re.M) for name in re.findall(r"`(\w+)`", row)}
    families = {f"{family}{part}" for family in ("curvature", "clearance") for part in ("_max", "_min")}
    assert {metric.name for metrics in packs.values() for metric in metrics} <= documented | families


def test_units_and_wishes_are_given(packs):
    for metric in [metric for metrics in packs.values() for metric in metrics]:
        assert metric.unit
        assert metric.description
        assert metric.better in ("higher", "lower", "neither")


def test_every_value_lies_within_its_bounds(packs, record_of, straight_line, round_trip):
    random = np.random.default_rng(0)
    people = np.cumsum(random.normal(0.0, 0.1, (81, 3, 2)), axis=0).astype(np.float32)
    poses = np.cumsum(random.normal(0.05, 0.1, (81, 3)), axis=0)
    records = [record_of(straight_line()), record_of(round_trip()), record_of(poses, pedestrian_positions=people)]
    for record, metric in product(records, [metric for metrics in packs.values() for metric in metrics]):
        value = metric.compute(record)
        assert math.isnan(value) or metric.bounds[0] <= value <= metric.bounds[1], metric.name


def test_shares_and_times_have_bounds_and_signed_changes_have_none(packs):
    bounds = {metric.name: metric.bounds for metric in (*packs[""], *packs["social"])}
    assert bounds["spl"] == bounds["success"] == bounds["personal_share"] == (0.0, 1.0)
    assert bounds["contact_time"] == bounds["planning_time_mean"] == (0.0, math.inf)
    assert bounds["acceleration_min"] == (-math.inf, math.inf)


def test_every_array_of_a_record_is_documented(record_of, straight_line):
    text = (DOCS / "records.md").read_text()
    documented = set(re.findall(r"^\| `(\w+)` \|", text, re.M))
    assert set(record_of(straight_line()).arrays) <= documented

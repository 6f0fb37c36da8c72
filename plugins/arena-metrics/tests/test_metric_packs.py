"""What holds for both packs: composition, documentation, speed of thought."""

import re
from pathlib import Path

import pytest

from arena_core.hosting import load_registry
from arena_core.records import build_metrics

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(scope="module")
def packs(preset_of):
    nodes = {name: {"name": name, **preset_of(name)} for name in ("si", "paper_legacy")}
    return build_metrics({"metrics": nodes}, load_registry())


def test_packs_are_built_from_their_presets(packs):
    assert list(packs) == ["", "paper_legacy"]
    assert {len(metrics) for metrics in packs.values()} == {53, 13}


def test_every_metric_is_documented_with_its_formula(packs):
    text = (DOCS / "metrics.md").read_text()
    documented = {name for row in re.findall(r"^\| (`[^|]*)\|", text, re.M) for name in re.findall(r"`(\w+)`", row)}
    families = {f"{family}{part}" for family in ("curvature", "clearance") for part in ("_max", "_min")}
    assert {metric.name for metrics in packs.values() for metric in metrics} <= documented | families


def test_units_and_wishes_are_given(packs):
    for metric in [metric for metrics in packs.values() for metric in metrics]:
        assert metric.unit
        assert metric.description
        assert metric.better in ("higher", "lower", "neither")


def test_every_array_of_a_record_is_documented(record_of, straight_line):
    text = (DOCS / "records.md").read_text()
    documented = set(re.findall(r"^\| `(\w+)` \|", text, re.M))
    assert set(record_of(straight_line()).arrays) <= documented

"""The Jackal of the release: its accelerations, and all that is tuned for the suite's Jackal or was trained in it."""

from dataclasses import asdict
from pathlib import Path

import pytest

from arena_core.hosting import compose, to_plain
from arena_core.testing import component

PLUGINS = Path(__file__).resolve().parents[2]
TUNED = {
    (path.parents[1].name, path.parent.name.removesuffix("_tuning"))
    for path in PLUGINS.glob("*/src/*/conf/*/*_tuning/jackal.yaml")
    if path.parents[1].name in ("planner", "simulator")
}


def test_released_jackal_is_the_suites_with_greater_accelerations():
    ours, released = (asdict(component("robot", name)) for name in ("jackal", "jackal_as_released"))
    assert (released["limits"].pop("ax_max"), released["limits"].pop("alpha_max")) == (10.0, 20.0)
    assert ours["limits"].pop("ax_max") < 0.5 * 9.81, "what rubber holds on a smooth floor"
    assert ours["limits"].pop("alpha_max") < 20.0
    assert repr(released) == repr(ours)


@pytest.mark.parametrize(("kind", "name"), sorted(TUNED))
def test_all_that_is_tuned_for_the_jackal_is_tuned_for_the_released_one(kind, name):
    ours, released = (
        to_plain(compose([f"{kind}={name}", f"robot={robot}"]))[kind] for robot in ("jackal", "jackal_as_released")
    )
    kept = {"dwa": ("roll_out", "sim_period"), "mpc": ("limits", "ax_max")}
    if name in kept:  # chosen for the accelerations of either
        section, key = kept[name]
        assert ours[section].pop(key) != released[section].pop(key)
        ours["limits"].pop("alpha_max"), released["limits"].pop("alpha_max")
    assert released == ours


def test_policies_that_were_trained_with_the_releases_accelerations_take_it_without_a_word():
    released, ours = (component("robot", name) for name in ("jackal_as_released", "jackal"))
    assert component("planner", "rosnav", [], "jackal_as_released", robot=released).untuned == ()
    (note,) = component("planner", "rosnav", [], "jackal", robot=ours).untuned
    assert note.startswith("rosnav: trained with accelerations of 10 m/s2, 20 rad/s2, drives with accelerations of 2.5")

"""A door's timetable is checked, and says when it is open."""

import math

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_core.loop.record_layout import fault_of
from arena_core.scenes import Door, is_open
from arena_core.testing.samples import record

LEAF = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [0.0, 0.1]])


def door(*intervals, period=None):
    return Door(LEAF, np.array(intervals), period)


def test_a_door_is_open_from_its_first_instant_to_before_its_last():
    leaf = door((5.0, 12.0), (20.0, math.inf))
    at = {0.0: False, 4.99: False, 5.0: True, 11.99: True, 12.0: False, 19.99: False, 20.0: True, 1e6: True}
    assert {stamp: is_open(leaf, stamp) for stamp in at} == at


def test_a_door_with_a_period_opens_again_in_each():
    leaf = door((5.0, 12.0), period=24.0)
    for turn in range(0, 5000, 7):
        begin = 24.0 * turn
        assert [is_open(leaf, begin + t) for t in (4.99, 5.0, 11.99, 12.0, 23.99)] == [False, True, True, False, False]


def test_times_that_are_a_rounding_apart_are_the_same():
    leaf = door((0.3, 0.7))
    assert is_open(leaf, 0.1 * 3)
    assert is_open(leaf, 0.3 - 1e-12)
    assert not is_open(leaf, 0.7 - 1e-12)


@pytest.mark.parametrize(
    ("intervals", "period", "said"),
    [
        ([], None, r"open is \[\]; allowed: one or more \[from, to\] \(s\) in their order, 0 <= from < to$"),
        ([(2.0, 2.0)], None, r"open is \[\[2.0, 2.0\]\]"),
        ([(3.0, 4.0), (1.0, 2.0)], None, "in their order"),
        ([(3.0, 5.0), (4.0, 6.0)], None, "in their order"),
        ([(-1.0, 5.0)], None, "0 <= from"),
        ([(1.0, math.inf), (3.0, 4.0)], None, "in their order"),
        ([(math.nan, 3.0)], None, "in their order"),
        ([(1.0, 5.0)], 4.0, r"0 <= from < to <= period, 4$"),
        ([(1.0, math.inf)], 4.0, "period, 4"),
        ([(1.0, 5.0)], 0.0, r"period is 0; allowed: a number > 0 \(s\), or none"),
    ],
)
def test_a_timetable_that_is_none_is_one_line(intervals, period, said):
    with pytest.raises(ConfigurationError, match=said):
        door(*intervals, period=period)


@pytest.mark.parametrize(
    ("doors", "states", "said"),
    [
        ([{"vertices_xy": LEAF.tolist(), "open": [[1.0, None]], "period": None}], True, ""),
        ([{"vertices_xy": LEAF.tolist(), "open": [[1.0, 3.0]], "period": 4.0}], False, "doors_open is bool"),
        ([{"vertices_xy": LEAF.tolist(), "open": [[1.0]], "period": 4.0}], True, "meta.scenario.doors are none"),
        ([{"vertices_xy": LEAF.tolist(), "open": [[1.0, "x"]], "period": 4.0}], True, "meta.scenario.doors are none"),
        ([{"vertices_xy": [], "open": [[1.0, 2.0]], "period": None}], True, "meta.scenario.doors are none"),
        ([{"open": [[1.0, 2.0]]}], True, "meta.scenario.doors are none"),
        (3, True, "meta.scenario.doors are none"),
        ([], True, "doors_open is bool"),
    ],
)
def test_a_record_whose_doors_are_none_is_no_record(doors, states, said):
    written = record()
    arrays = {**written.arrays, **({"doors_open": np.ones((len(written["stamp"]), 1), bool)} if states else {})}
    meta = {**written.meta, "scenario": {**written.meta["scenario"], "doors": doors}}
    assert fault_of(arrays, meta).startswith(said)
    assert bool(fault_of(arrays, meta)) == bool(said)

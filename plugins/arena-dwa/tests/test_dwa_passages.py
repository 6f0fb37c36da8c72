"""The padding gives way in a passage, and nowhere else."""

import numpy as np
import pytest

from arena_core import Pose, Twist
from arena_dwa.passage import padding_along
from arena_dwa.settings import Body, BodyOnWindow
from arena_kernels.costmap_window import outline_of, window_of
from arena_kernels.passage import KEPT

BODY = Body(outline_of(None, 0.165, 0.165, 0.05), 0.03, 0.25, 0.2)
LEAST = 0.005
AHEAD = [(-1.0 + 0.05 * k, 0.0) for k in range(60)]
PATH = np.column_stack((AHEAD, np.zeros(60)))


def walls(costmap, cells, away=0.0):
    """Return two walls, 0.2 m deep, with a gap of an odd number of cells about the x axis."""
    edge = 0.05 * (cells // 2) + 0.04
    return costmap((away, away + 0.2, edge, 3.1), (away, away + 0.2, -3.1, -edge))


@pytest.mark.parametrize(("cells", "room"), [(7, 0.01), (9, 0.06), (11, 0.11)])
def test_padding_is_a_share_of_what_the_path_leaves(cells, room, costmap):
    found = padding_along(BodyOnWindow(window_of(walls(costmap, cells)), BODY), PATH, (-0.2, 0.0), 0.5, LEAST)
    assert found == pytest.approx(min(BODY.padding, max(LEAST, KEPT * room)), abs=1e-6)


def test_padding_gives_way_to_a_passage_within_reach_only(costmap):
    window = window_of(walls(costmap, 7, away=1.0))
    assert padding_along(BodyOnWindow(window, BODY), PATH, (0.0, 0.0), 0.5, LEAST) == BODY.padding
    assert padding_along(BodyOnWindow(window, BODY), PATH, (0.6, 0.0), 0.5, LEAST) == pytest.approx(
        KEPT * 0.01, abs=1e-6
    )


def test_padding_stays_where_the_path_leads_through_a_wall(costmap):
    assert (
        padding_along(BodyOnWindow(window_of(costmap((0.0, 0.2, -1.0, 1.0))), BODY), PATH, (-0.4, 0.0), 0.5, LEAST)
        == BODY.padding
    )


@pytest.mark.parametrize(
    ("cells", "name", "kept"), [(7, "dwa", False), (15, "dwa", True), (7, "dwa_as_released", True)]
)
def test_planner_eases_its_padding_in_a_narrow_passage_unless_it_is_the_released_one(
    cells, name, kept, build, observe, costmap
):
    planner = build("jackal", name, footprint={"padding": 0.03})
    planner.compute_velocity(observe(walls(costmap, cells), Pose(-0.5, 0.0), AHEAD, Twist(0.0), 0.0))
    assert (planner._settings.body.padding == planner._own.body.padding) == kept


def test_no_least_padding_means_that_it_gives_way_nowhere(build, observe, costmap):
    planner = build("jackal", footprint={"passage_padding": None})
    planner.compute_velocity(observe(walls(costmap, 7), Pose(-0.5, 0.0), AHEAD, Twist(0.0), 0.0))
    assert planner._settings.body.padding == planner._own.body.padding

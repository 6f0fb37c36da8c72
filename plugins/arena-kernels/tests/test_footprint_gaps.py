import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

from arena_kernels.footprint import NOTHING, gap_to_convex, gap_to_disc, gap_to_polygon, make_body, place_body
from arena_kernels.grids import stack_grids
from arena_kernels.walls import gap_to_cells

seeds = st.integers(0, 2**32 - 1)
BOX = np.array([[0.21, -0.165], [0.21, 0.165], [-0.21, 0.165], [-0.21, -0.165]])
WEDGE = np.array([[0.3, 0.0], [-0.2, 0.2], [-0.2, -0.2]])


def bodies():
    return (make_body(np.empty((0, 2)), 0.2), make_body(BOX, 0.2671), make_body(WEDGE, 0.3))


def outline(body):
    hull = body.points[1, : body.corners]
    return Polygon(hull) if len(hull) > 1 else Point(hull[0])


def sides(ring):
    return np.stack((ring, np.roll(ring, -1, axis=0)), axis=1)


def check(body, gap, other):
    """Hold a gap to shapely: its size, and that its point and normal lead from one outline to the other."""
    apart = outline(body).distance(other)
    if apart == 0.0:
        assert gap[0] <= 1e-9 - body.rounding
        return
    assert gap[0] == pytest.approx(apart - body.rounding, abs=1e-7)
    nearest = np.array(gap[3:])
    assert other.distance(Point(nearest)) < 1e-7
    assert outline(body).distance(Point(nearest - apart * np.array(gap[1:3]))) < 1e-6


@pytest.mark.slow
@given(seeds)
@settings(derandomize=True, deadline=None)
def test_gap_to_cells_is_the_distance_to_the_nearest_occupied_square(random_grid, seed):
    random = np.random.default_rng(seed)
    grid = random_grid(seed)
    stack, _ = stack_grids([random_grid(seed + 1), grid])
    squares = [
        Polygon(grid.positions([(c, r), (c + 1, r), (c + 1, r + 1), (c, r + 1)]))
        for r, c in np.argwhere(grid.occupied)[:400].tolist()
    ]
    if grid.occupied.sum() > 400:
        return
    for body in bodies():
        place_body(body, *grid.positions(random.uniform(-5.0, 55.0, 2)), random.uniform(-4.0, 4.0))
        gap = gap_to_cells(stack, 1, body, np.inf)
        if not squares:
            assert gap == NOTHING
            continue
        check(body, gap, min(squares, key=outline(body).distance))
        if outline(body).distance(unary_union(squares)) == 0.0:
            continue
        assert gap_to_cells(stack, 1, body, gap[0] + 1e-6)[0] == pytest.approx(gap[0], abs=1e-9)
        assert gap_to_cells(stack, 1, body, gap[0] - 1e-6) == NOTHING


@given(seeds)
@settings(derandomize=True, deadline=None)
def test_gaps_to_discs_segments_and_polygons_are_those_of_shapely(seed):
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0.0, 2 * np.pi, 7))
    star = np.stack((np.cos(angles), np.sin(angles)), axis=1) * random.uniform(0.2, 1.0, (7, 1))
    segment = random.uniform(-1.0, 1.0, (2, 2))
    for body in bodies():
        place_body(body, *random.uniform(-1.5, 1.5, 2), random.uniform(-4.0, 4.0))
        check(body, gap_to_convex(body, segment), LineString(segment))
        if Polygon(star).is_valid:
            check(body, gap_to_polygon(body, sides(star)), Polygon(star))
        apart = outline(body).distance(Point(0.0, 0.0))
        if apart > 0.0:
            assert gap_to_disc(body, 0.0, 0.0, 0.3)[0] == pytest.approx(apart - body.rounding - 0.3, abs=1e-9)
        else:
            assert gap_to_disc(body, 0.0, 0.0, 0.3)[0] <= -0.3 - body.rounding + 1e-9


def test_crossing_bars_overlap_although_no_corner_lies_in_the_other():
    bar = make_body(np.array([[1.0, -0.1], [1.0, 0.1], [-1.0, 0.1], [-1.0, -0.1]]), 1.01)
    upright = np.array([[0.1, -1.0], [0.1, 1.0], [-0.1, 1.0], [-0.1, -1.0]])
    assert gap_to_convex(bar, upright)[0] < 0.0


def test_body_deep_inside_a_polygon_overlaps_it():
    square = sides(np.array([[5.0, -5.0], [5.0, 5.0], [-5.0, 5.0], [-5.0, -5.0]]))
    for body in bodies():
        place_body(body, 0.3, 0.2, 1.0)
        assert gap_to_polygon(body, square)[0] < -4.0

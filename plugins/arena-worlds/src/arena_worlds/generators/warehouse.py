"""A warehouse of our own making: rows of racks, aisles between them, cross aisles through them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import numpy as np

from arena_core import ConfigurationError, OccupancyGrid, World, WorldSource, random_generator
from arena_core.parameters import Flat, NonNegative, NonNegativeInt, Positive
from arena_worlds.generators.canvas import Canvas


@dataclass(frozen=True, slots=True)
class WarehousePlan:
    """The measures of a warehouse, m."""

    width: Positive
    height: Positive
    resolution: Positive
    rack_length: Positive
    rack_depth: Positive
    aisle_width: Positive
    bay_length: Positive
    bay_recess: NonNegative
    open_places: NonNegativeInt


class Warehouse(WorldSource):
    """The same warehouse for every scenario and seed.

    Racks of ``rack_length`` (along y) by ``rack_depth`` m stand in as many rows as leave aisles of ``aisle_width`` m or
    more on all sides; what is left over widens the aisles evenly. Each bay of ``bay_length`` m stands back from the
    rack's front by up to ``bay_recess`` m, so that an aisle looks different along its length. ``open_places`` racks are
    left out.
    """

    def __init__(self, plan: Annotated[WarehousePlan, Flat()], *, known: bool) -> None:
        _check_plan(plan)
        self._world = World("warehouse", _warehouse_grid(plan), known)

    def world(self, seed: int, index: int) -> World:
        """Return the warehouse, whatever the scenario."""
        return self._world


def _check_plan(plan: WarehousePlan) -> None:
    for side, size, rack in (("width", plan.width, plan.rack_depth), ("height", plan.height, plan.rack_length)):
        if size < rack + 2 * plan.aisle_width:
            raise ConfigurationError(
                f"world.{side} is {size:g}; allowed: at least one rack and two aisles, "
                f"{rack + 2 * plan.aisle_width:g} m"
            )
    if plan.bay_recess * 2 >= plan.rack_depth:
        raise ConfigurationError(
            f"world.bay_recess is {plan.bay_recess:g}; allowed: below half of rack_depth, {plan.rack_depth / 2:g} m"
        )
    racks = len(_rack_positions(plan.width, plan.rack_depth, plan.aisle_width)) * len(
        _rack_positions(plan.height, plan.rack_length, plan.aisle_width)
    )
    if plan.open_places >= racks:
        raise ConfigurationError(
            f"world.open_places is {plan.open_places}; allowed: below the number of racks, {racks}"
        )


def _rack_positions(size: float, rack: float, aisle: float) -> list[float]:
    """Return where racks begin along a side of ``size`` m, with even aisles before, between and behind them."""
    count = int((size - aisle) / (rack + aisle) + 1e-9)
    gap = (size - count * rack) / (count + 1)
    return [gap + k * (rack + gap) for k in range(count)]


@lru_cache(maxsize=16)
def _warehouse_grid(plan: WarehousePlan) -> OccupancyGrid:
    canvas = Canvas(plan.width, plan.height, plan.resolution)
    corners = [
        (x, y)
        for x in _rack_positions(plan.width, plan.rack_depth, plan.aisle_width)
        for y in _rack_positions(plan.height, plan.rack_length, plan.aisle_width)
    ]
    random = random_generator(0, "warehouse", "layout")  # one layout for all seeds: results stay comparable
    left_out = set(random.permutation(len(corners))[: plan.open_places].tolist())
    for k, (x, y) in enumerate(corners):
        if k not in left_out:
            _fill_rack(canvas, plan, x, y, random)
    return canvas.grid()


def _fill_rack(canvas: Canvas, plan: WarehousePlan, x: float, y: float, random: np.random.Generator) -> None:
    bays = max(round(plan.rack_length / plan.bay_length), 1)
    edges = np.linspace(y, y + plan.rack_length, bays + 1).tolist()
    for recess, low, high in zip(
        random.uniform(0.0, plan.bay_recess, (bays, 2)).tolist(), edges[:-1], edges[1:], strict=True
    ):
        canvas.fill(x + recess[0], low, x + plan.rack_depth - recess[1], high)

"""The social-force crowd: N worlds of people, stepped in one compiled call."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, PedestrianModel, Positive, RobotBatch, Scenario, with_obstacles
from arena_kernels.terrain import Terrain
from arena_pedsim.crowd_step import step_crowds
from arena_pedsim.customs import Customs
from arena_pedsim.parameters import (
    ForceFactors,
    GivingWay,
    PersonTypes,
    Reactions,
    SocialInteraction,
    Spawning,
    WallForce,
    Wayfinding,
    parameter_record,
)
from arena_pedsim.population import Population
from arena_pedsim.presence import come_and_go
from arena_pedsim.trips import grant_wishes


class SocialForceModel(PedestrianModel):
    """People who walk from waypoint to waypoint, and whom other people, walls and (if they yield) robots push aside.

    Positions and velocities come from the crowd that ``step`` is given; only ways and clocks are remembered between steps.
    """

    def __init__(
        self,
        reaction: Literal["ignore", "yield", "curious", "scared", "threatening"],
        relaxation_time: Positive,
        longest_step: Positive,
        factors: ForceFactors,
        social: SocialInteraction,
        walls: WallForce,
        wayfinding: Wayfinding,
        giving_way: GivingWay,
        reactions: Reactions,
        types: PersonTypes,
        spawning: Spawning,
    ) -> None:
        self._customs = Customs(reaction, factors, reactions, types)
        self._cell = wayfinding.cell
        self._parameters = parameter_record(
            relaxation_time, longest_step, social=social, walls=walls, wayfinding=wayfinding, giving_way=giving_way, spawning=spawning
        )
        self._population = Population(0)
        self._terrain = Terrain(self._cell)

    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots; worlds in other slots are returned as ``step`` left them.

        Raises ImpossibleScenario for somebody who starts in a wall or off the map.
        """
        if total != len(self._population):
            self._population = Population(total)
            self._terrain = Terrain(self._cell)
        grids = [with_obstacles(scenario.world.grid, scenario.obstacles) for scenario in scenarios]
        self._terrain.replace(slots, grids, total)
        for slot, scenario, grid in zip(slots, scenarios, grids, strict=True):
            self._population.settle(int(slot), scenario, grid, self._customs)
        self._grant_wishes(self._population.crowd)
        return self._population.crowd

    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return the crowd ``dt`` seconds later; people who ignore robots are the same whatever ``robots`` do, unless they come or go."""
        population, terrain = self._population, self._terrain
        positions, velocities, states = crowd.positions.copy(), crowd.velocities.copy(), crowd.states.copy()
        wishes = step_crowds(
            crowd.counts,
            positions,
            velocities,
            crowd.radii,
            states,
            population.people,
            population.corners,
            terrain.index,
            terrain.distance,
            terrain.layouts,
            robots.poses,
            robots.velocities_xy,
            float(robots.radius),
            float(dt),
            self._parameters,
        )
        population.crowd = Crowd(crowd.counts, crowd.ids, positions, velocities, crowd.radii, states)
        if wishes:
            self._let_come_and_go(population.crowd, robots)
            self._grant_wishes(population.crowd)
        return population.crowd

    def _let_come_and_go(self, crowd: Crowd, robots: RobotBatch) -> None:
        terrain = self._terrain
        come_and_go(
            crowd.counts,
            crowd.positions,
            crowd.velocities,
            crowd.radii,
            crowd.states,
            self._population.people,
            self._population.waypoints,
            robots.poses,
            float(robots.radius),
            terrain.index,
            terrain.distance,
            terrain.layouts,
            self._parameters,
        )

    def _grant_wishes(self, crowd: Crowd) -> None:
        population, terrain = self._population, self._terrain
        grant_wishes(
            crowd.counts,
            crowd.positions,
            crowd.radii,
            population.people,
            population.waypoints,
            population.corners,
            population.legs,
            population.leg_corners,
            terrain.index,
            terrain.distance,
            terrain.layouts,
            terrain.rooms,
            terrain.nodes,
            self._parameters,
        )

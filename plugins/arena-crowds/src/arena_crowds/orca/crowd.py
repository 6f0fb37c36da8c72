"""People as ORCA agents: van den Berg, Guy, Lin, Manocha, Reciprocal n-body collision
avoidance, Robotics Research 2011.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, Crowd, Gait, PedestrianModel, RobotBatch, Scenario
from arena_core.parameters import NonNegative, Positive, PositiveInt
from arena_core.scenes import add_furniture, add_obstacles, close_doors, is_open
from arena_crowds.orca.orca_step import step_crowds
from arena_crowds.orca.parameters import OrcaRules, RobotRules, RouteRules, Wayfinding
from arena_crowds.orca.route_following import assign_routes
from arena_crowds.orca.walkers import Walkers
from arena_kernels.compiled import TypedDispatch
from arena_kernels.crowds import Crowds, robot_stack
from arena_kernels.doorways import Doorways, Site, await_doors, look_again
from arena_kernels.world_grids import WorldGrids


class OrcaCrowd(PedestrianModel):
    """People who choose, each step, the velocity nearest to the wanted one at which no one is met if all choose alike.

    Positions and velocities come from the crowd that ``step`` is given; only ways and clocks are remembered between
    steps.
    """

    meets_teams = True

    def __init__(
        self,
        reaction: Literal["ignore", "yield"],
        horizon: Positive,
        wall_horizon: Positive,
        overlap_time: Positive,
        range: Positive,
        neighbours: PositiveInt,
        side: NonNegative,
        robot: RobotRules,
        wayfinding: Wayfinding,
        body: Literal["discs", "legs"],
        gait: Gait,
    ) -> None:
        self.gait = gait if body == "legs" else None
        way = RouteRules(*(float(getattr(wayfinding, name)) for name in RouteRules._fields))
        distances = {
            "horizon": float(horizon),
            "wall_horizon": float(wall_horizon),
            "overlap_time": float(overlap_time),
            "range": float(range),
        }
        shares = {"side": float(side), "robot_share": float(robot.share), "robot_margin": float(robot.margin)}
        self._rules = OrcaRules(yields=reaction == "yield", neighbours=neighbours, way=way, **distances, **shares)
        self._cell = wayfinding.cell
        self._walkers = Walkers(0)
        self._terrain, self._doors = WorldGrids(self._cell), Doorways(self._cell)
        self._step_crowds, self._grant_wishes = TypedDispatch(step_crowds), TypedDispatch(assign_routes)

    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots; worlds in other slots are returned as ``step`` left them.

        Raises ImpossibleScenario for a person who starts in a wall or off the map.
        """
        if total != len(self._walkers):
            self._walkers, self._terrain, self._doors = Walkers(total), WorldGrids(self._cell), Doorways(self._cell)
        grids = [add_obstacles(add_furniture(scenario.world), scenario.obstacles) for scenario in scenarios]
        sites = [
            Site(tuple(is_open(door, 0.0) for door in each.doors), partial(close_doors, grid, each.doors), {})
            for each, grid in zip(scenarios, grids, strict=True)
        ]
        self._terrain.replace(slots, self._doors.begin(slots, grids, sites, total), total)
        self._walkers.begin_slots(dict(zip(slots.tolist(), scenarios, strict=True)), grids)
        self._plan_routes()
        return self._walkers.crowd

    def watch_doors(self, doors_open: NDArray[np.bool_]) -> None:
        """See which doors are open; closed ones are walls, and who waited before one looks for the way again."""
        for slot, grid in self._doors.changed(doors_open).items():
            self._terrain.replace(np.array([slot]), [grid], len(self._walkers))
            look_again(self._walkers.memory[slot])

    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return the crowd ``dt`` seconds later; with ``reaction: ignore`` nothing of ``robots`` is used."""
        walkers = self._walkers
        positions, velocities = (np.array(each, np.float64, order="C") for each in (crowd.positions, crowd.velocities))
        states = np.array(crowd.states, np.int8, order="C")
        wishes = self._step_crowds(
            Crowds(crowd.counts, positions, velocities, crowd.radii, states),
            walkers.memory,
            walkers.corners,
            self._terrain.land,
            robot_stack(robots.poses, robots.velocities_xy, robots.radius),
            float(dt),
            self._rules,
        )
        walkers.crowd = Crowd(crowd.counts, crowd.ids, positions, velocities, crowd.radii, states)
        if wishes:
            self._plan_routes()
        return walkers.crowd

    def fork(self, branches: Branches) -> OrcaCrowd:
        """Return a crowd of its own that goes on from this one."""
        forked = copy(self)
        vars(forked).update(
            _walkers=self._walkers.fork(branches),
            _terrain=self._terrain.fork(branches.slots),
            _doors=self._doors.fork(branches.slots),
        )
        return forked

    def _plan_routes(self) -> None:
        crowd, walkers, terrain = self._walkers.crowd, self._walkers, self._terrain
        people = Crowds(crowd.counts, crowd.positions, crowd.velocities, crowd.radii, crowd.states)
        memory = walkers.memory
        worth = self._rules.way.door_wait * memory["desired_speed"]
        seekers = self._doors.seekers(memory["wish"], walkers.corners, worth)
        self._grant_wishes(
            people, memory, walkers.waypoints, walkers.corners, terrain.land, terrain.rooms, terrain.nodes
        )
        if seekers is not None:
            await_doors(people, memory, seekers, self._doors.maps(terrain))

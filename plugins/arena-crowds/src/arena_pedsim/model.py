"""The social-force crowd: N worlds of people, stepped in one compiled call."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import partial
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, Crowd, PedestrianModel, RobotBatch, Scenario
from arena_core.parameters import Flat
from arena_core.scenes import add_furniture, add_obstacles, close_doors, is_open
from arena_kernels.compiled import TypedDispatch
from arena_kernels.crowds import Crowds, robot_stack
from arena_kernels.doorways import Doorways, Site, await_doors, look_again
from arena_kernels.world_grids import WorldGrids
from arena_pedsim.forces.crowd_step import step_crowds
from arena_pedsim.parameter_groups import Appearance, Forces, Persons, Walking, parameter_record
from arena_pedsim.routes.trips import assign_routes
from arena_pedsim.states.behaviour import check_behaviour
from arena_pedsim.states.person_defaults import CrowdDefaults
from arena_pedsim.states.population import Population
from arena_pedsim.states.social_state import SocialState
from arena_pedsim.states.spawning import spawn_and_despawn
from arena_pedsim.states.state_step import step_states
from arena_pedsim.states.state_table import state_table

Ticks = NDArray[np.int64]


class SocialForceModel(PedestrianModel):
    """People who walk from waypoint to waypoint, and whom other people, walls and (if they yield) robots push aside.

    Positions and velocities come from the crowd that ``step`` is given; only ways and clocks are remembered between
    steps. ``factors`` and ``parameters`` are the figures of the forces.
    """

    meets_teams = True

    def __init__(
        self,
        forces: Annotated[Forces, Flat()],
        ways: Annotated[Walking, Flat()],
        persons: Annotated[Persons, Flat()],
        looks: Annotated[Appearance, Flat()],
    ) -> None:
        self.gait = looks.gait if looks.body == "legs" else None
        self._customs = CrowdDefaults(persons.reaction, forces.factors, persons.reactions, persons.types)
        self._cell = ways.wayfinding.cell
        self._table = state_table()
        self.factors = forces.factors
        self.parameters = parameter_record(forces, ways, self._table.rules.states)
        self._behaviour = persons.behaviour
        self._population = Population(0)
        self._society = SocialState(0, self._behaviour)
        self._terrain, self._doors = WorldGrids(self._cell), Doorways(self._cell)
        self._door_wait, self._finds_ways = ways.wayfinding.door_wait, ways.wayfinding.routing == "around_walls"
        self._step_crowds = TypedDispatch(step_crowds)

    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots; worlds in other slots are returned as ``step`` left them.

        Raises ImpossibleScenario for a person who starts in a wall or off the map.
        """
        if total != len(self._population):
            self._population = Population(total)
            self._society = SocialState(total, self._behaviour)
            self._terrain, self._doors = WorldGrids(self._cell), Doorways(self._cell)
        grids = [add_obstacles(add_furniture(scenario.world), scenario.obstacles) for scenario in scenarios]
        sites = [
            Site(tuple(is_open(door, 0.0) for door in each.doors), partial(close_doors, grid, each.doors), {})
            for each, grid in zip(scenarios, grids, strict=True)
        ]
        self._terrain.replace(slots, self._doors.begin(slots, grids, sites, total), total)
        for slot, scenario, grid in zip(slots, scenarios, grids, strict=True):
            for spec in scenario.pedestrians:
                check_behaviour(spec)
            self._population.begin_slots(int(slot), scenario, grid, self._customs)
            self._society.begin_slots(int(slot), scenario, self._population.crowd, self._population.people[slot])
        self._grant_wishes(self._population.crowd)
        return self._population.crowd

    def walks(self, crowd: Crowd) -> NDArray[np.bool_]:
        """Tell who walks on two legs (N, P): all who take part in social states, which forklifts
        and service robots do not.
        """
        return np.asarray(self._population.people["sociable"] == 1)

    def watch_doors(self, doors_open: NDArray[np.bool_]) -> None:
        """See which doors are open; closed ones are walls, and who waited before one looks for the way again."""
        for slot, grid in self._doors.changed(doors_open).items():
            self._terrain.replace(np.array([slot]), [grid], len(self._population))
            look_again(self._population.people[slot])

    def step(self, crowd: Crowd, robots: RobotBatch, ticks: Ticks, dt: float) -> Crowd:
        """Return the crowd ``dt`` seconds later.

        People who ignore robots are the same whatever ``robots`` do, unless they come or go, or wait for a robot, or
        want a guide.
        """
        population = self._population
        crowds = Crowds(
            np.ascontiguousarray(crowd.counts, np.int32),
            np.array(crowd.positions, np.float64, order="C"),
            np.array(crowd.velocities, np.float64, order="C"),
            np.ascontiguousarray(crowd.radii, np.float64),
            np.array(crowd.states, np.int8, order="C"),
        )
        moving, land = robot_stack(robots.poses, robots.velocities_xy, robots.radius), self._terrain.land
        if self._society.lively:
            social, rules = self._society.social, self._table.rules
            step_states(crowds, population.people, social, moving, ticks, float(dt), land, rules, self.parameters)
        wishes = self._step_crowds(
            crowds, population.people, population.corners, land, moving, float(dt), self.parameters
        )
        population.crowd = Crowd(
            crowd.counts, crowd.ids, crowds.positions, crowds.velocities, crowd.radii, crowds.states
        )
        if wishes:
            spawn_and_despawn(crowds, population.people, population.waypoints, moving, land, self.parameters)
            self._grant_wishes(population.crowd)
        return population.crowd

    def fork(self, branches: Branches) -> SocialForceModel:
        """Return a crowd of its own that goes on from this one."""
        forked = copy(self)
        vars(forked).update(
            _population=self._population.fork(branches),
            _society=self._society.fork(branches),
            _terrain=self._terrain.fork(branches.slots),
            _doors=self._doors.fork(branches.slots),
        )
        return forked

    def _grant_wishes(self, crowd: Crowd) -> None:
        population, terrain = self._population, self._terrain
        crowds = Crowds(crowd.counts, crowd.positions, crowd.velocities, crowd.radii, crowd.states)
        people = population.people
        seekers = self._doors.seekers(people["wish"], population.corners, self._door_wait * people["walking_speed"])
        assign_routes(crowds, people, population.routes, terrain.land, terrain.rooms, terrain.nodes, self.parameters)
        if seekers is not None and self._finds_ways:
            await_doors(crowds, people, seekers, self._doors.maps(terrain))
            people["lost"][people["waiting"] == 1] = 0

"""What the configuration and a person's own behaviour together make of it: body, force factors, reaction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from arena_core import PedestrianSpec
from arena_pedsim.forces.reactions import STATES, reaction_of, take_reaction
from arena_pedsim.parameters import ForceFactors, PersonTypes, Reactions
from arena_pedsim.people import person_memory
from arena_pedsim.state_ids import NONE
from arena_pedsim.states.person_types import type_name, with_body


@dataclass(frozen=True, slots=True)
class CrowdDefaults:
    """What holds for everybody whose behaviour does not say otherwise."""

    reaction: str
    factors: ForceFactors
    reactions: Reactions
    types: PersonTypes

    def of(self, spec: PedestrianSpec) -> PedestrianSpec:
        """Return a person with the body of the type; who may leave the place for the robot and has no
        waypoint comes back to it.
        """
        spec = with_body(spec, getattr(self.types, type_name(spec)))
        if len(spec.waypoints_xy) == 0 and STATES[reaction_of(spec, self.reaction)] != NONE:
            return replace(spec, waypoints_xy=spec.position_xy[None])
        return spec

    def memory(self, spec: PedestrianSpec) -> np.void:
        """Return the memory of a person who is about to start; raise ConfigurationError for an impossible behaviour."""
        person, kind = person_memory(spec, self.factors), getattr(self.types, type_name(spec))
        person["mass"], person["sociable"] = kind.mass, kind.sociable
        share = 1.0 if self.factors.reference_speed is None else spec.desired_speed / self.factors.reference_speed
        take_reaction(person, reaction_of(spec, self.reaction), self.reactions, share)
        return person

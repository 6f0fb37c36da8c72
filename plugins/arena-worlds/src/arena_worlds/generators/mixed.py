"""Worlds of several kinds in turn, by chance: for the training of planners that should know more than one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from arena_core import ConfigurationError, World, WorldSource, random_generator
from arena_core.parameters import NonNegativeInt


class MixedWorlds(WorldSource):
    """Each world comes from one of ``members``, all with equal chances: one for each seed, or a new one every
    ``regenerate`` scenarios.
    """

    def __init__(self, members: Mapping[str, WorldSource], regenerate: NonNegativeInt | None, *, known: bool) -> None:
        if not members:
            raise ConfigurationError(
                "world.members is empty; allowed: at least one world, as in +world@world.members.indoor=indoor"
            )
        self._members = [members[name] for name in sorted(members)]
        self._regenerate, self._known = regenerate, known

    def world(self, seed: int, index: int) -> World:
        """Return the world of this seed and scenario, under its member's name."""
        number = index // self._regenerate if self._regenerate else 0
        chosen = int(random_generator(seed, f"world/{number}", "mixed").integers(len(self._members)))
        return replace(self._members[chosen].world(seed, number), known=self._known)

    def at(self, difficulty: float) -> WorldSource:
        """Return the mixture at another difficulty; raise ConfigurationError where a member has none."""
        members = {f"{i:03d}": member.at(difficulty) for i, member in enumerate(self._members)}
        return MixedWorlds(members, self._regenerate, known=self._known)

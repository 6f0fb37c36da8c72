"""Which bodies of a model are tested for contacts: most of the time a robot is far from everything but the floor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from arena_mujoco.model import MOVES, STANDS, TOGETHER

if TYPE_CHECKING:
    import mujoco

# what is left of masks where nothing is near
FLOOR_ALONE = ~(int(STANDS[0]) | int(STANDS[1]) | int(MOVES[0]) | int(MOVES[1]) | int(TOGETHER[0]) | int(TOGETHER[1]))


class ContactFilter:
    """The contacts that one model is tested for. It costs more to find none than all the rest of a step takes."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._masks = model.body_contype, model.body_conaffinity
        whole = [mask.copy() for mask in self._masks]
        self._kept = {True: whole, False: [mask & FLOOR_ALONE for mask in whole]}
        self._near = True

    def select_contacts(self, *, near: bool) -> None:
        """Test for all contacts where something is ``near``, else for those with the floor; other worlds may
        step the model in between.
        """
        if near == self._near:
            return
        self._near = near
        for mask, kept in zip(self._masks, self._kept[near], strict=True):
            mask[:] = kept

"""Which random numbers an update of the particle filter draws."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from arena_kernels.scalars import Integer


class Draw(NamedTuple):
    """The random numbers of one update: the localiser's key, and which update since its start this is."""

    key: np.uint64
    tick: Integer

"""The integers that kernels take: Python's and numpy's alike."""

from typing import Any

import numpy as np

Integer = int | np.integer[Any]

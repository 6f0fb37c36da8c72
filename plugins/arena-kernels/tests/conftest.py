"""Random grids for the tests of the kernels."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import settings

settings.register_profile("kernels", derandomize=True, deadline=None)  # the first call may compile
settings.load_profile("kernels")


@dataclass(eq=False)
class Grid:
    occupied: np.ndarray
    resolution: float
    origin: SimpleNamespace
    derived: dict = field(default_factory=dict)

    def derive(self, function):
        if function not in self.derived:
            self.derived[function] = function(self)
        return self.derived[function]

    def positions(self, columns_rows):
        """Return points given in cells (column, row) in the map's frame, (..., 2)."""
        x, y = np.moveaxis(np.asarray(columns_rows) * self.resolution, -1, 0)
        c, s = np.cos(self.origin.theta), np.sin(self.origin.theta)
        return np.stack((self.origin.x + c * x - s * y, self.origin.y + s * x + c * y), axis=-1)


def build_grid(occupied, resolution=0.05, x=0.0, y=0.0, theta=0.0):
    return Grid(np.asarray(occupied, bool), resolution, SimpleNamespace(x=x, y=y, theta=theta))


def draw_grid(seed):
    random = np.random.default_rng(seed)
    shape = random.integers(1, 50, 2)
    occupied = random.random(shape) < random.choice([0.0, 0.01, 0.1, 0.4])
    return build_grid(occupied, random.choice([0.05, 0.1, 0.13]), *random.uniform(-3.0, 3.0, 3))


@pytest.fixture(scope="session")
def make_grid():
    return build_grid


@pytest.fixture(scope="session")
def random_grid():
    return draw_grid

"""How kernels are compiled."""

from __future__ import annotations

from numba import njit

# A division that cannot raise lets the compiler drop much of the reference counting of array arguments.
compiled = njit(cache=True, error_model="numpy")

# A kernel that only borrows arrays and makes none needs no reference counting at all. Counting is atomic and was most of the time of
# the short kernels that take whole named tuples of arrays; numba refuses to compile an allocation here.
borrowing = njit(cache=True, error_model="numpy", _nrt=False)

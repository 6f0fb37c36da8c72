"""numba kernels shared by plugins: ray casting, distance field, footprint collision, counter-based random numbers."""

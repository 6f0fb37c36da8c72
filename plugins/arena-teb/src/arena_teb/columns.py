"""The columns of rows of numbers, by name."""

X, Y, THETA, TIME = 0, 1, 2, 3  # of a pose of a band: m, m, rad, and s until the next one; of a position X and Y

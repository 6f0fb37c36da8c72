"""The columns of rows of numbers, by name."""

X, Y, THETA = 0, 1, 2  # of a pose: m, m, rad
LENGTH, CURVATURE = 0, 1  # of a piece of a curve: m, 1/m

"""The columns of rows of numbers, by name."""

X, Y = 0, 1  # of a position, m
VX, VY, RADIUS = 2, 3, 4  # of a person, behind its position: m/s, m
AWAY = 2  # of a near cell, behind its position: m

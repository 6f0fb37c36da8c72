"""The columns of rows of numbers, by name."""

PLACE_X, PLACE_Y, RADIUS = 0, 1, 2  # of a disc of the footprint, of where a moving obstacle is expected, of a path: m

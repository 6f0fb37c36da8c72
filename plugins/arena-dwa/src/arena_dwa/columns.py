"""The columns of rows of numbers, by name."""

X, Y, THETA = 0, 1, 2  # of a pose: m, m, rad
COSINE, SINE = 2, 3  # of a pose whose heading stands as these, behind its position
VELOCITY = 3  # where the velocity begins in a state, behind the pose
VX, VY, WZ = 0, 1, 2  # of a velocity, a sample and the axes of a window: m/s, m/s, rad/s
COST = 3  # of the cheapest sample, behind its velocity
LOW, HIGH = 0, 1  # of an axis of a window
TURN_COSINE, TURN_SINE = 0, 1  # of a turn
LENGTH, CURVATURE = 0, 1  # of a piece of a curve: m, 1/m
END_GAP = 3  # of where a curve may end, behind the pose: m
LEG_CURVATURE = 3  # of a row of a leg, behind the pose: 1/m

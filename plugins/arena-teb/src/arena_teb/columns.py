"""The columns of rows of numbers, by name."""

X, Y, THETA, TIME = 0, 1, 2, 3  # of a pose of a band: m, m, rad, and s until the next one; of a position X and Y
COLUMNS = 4  # of a band: variable COLUMNS * k + i is band[k, i]
NEXT_X, NEXT_Y, NEXT_THETA, NEXT_TIME = 4, 5, 6, 7  # of derivatives: by the variables of the next pose
SPAN = 7  # variables that move the robot within an interval: a pose, the time, the next pose
VX, VY, WZ = 0, 1, 2  # of a body velocity, of limits and of accelerations: m/s, m/s, rad/s
AXES = 3  # of a body velocity
LEFT, RIGHT = 0, 1  # of the points that are nearest to a pose

"""The columns of the problem's rows of numbers, by name."""

X, Y, THETA = 0, 1, 2  # of a pose, a state, a path, a disc's centre: m, m, rad
VELOCITIES = 3  # where a state's velocities begin
VX, VY, WZ = 3, 4, 5  # of a drive, whose velocities are those of a body: m/s, m/s, rad/s
STEP = -1  # of a state: the length of its interval, s

# a stage's row: the path point beside it, the path's normal and heading there, whether that counts; its via point
REFERENCE_X, REFERENCE_Y, NORMAL_X, NORMAL_Y, HEADING, HEADING_COUNTS = 0, 1, 2, 3, 4, 5
VIA_X, VIA_Y, VIA_COUNTS = 6, 7, 8
STAGE_HEAD = 9  # of these; half-planes or cells follow

PLANE_X, PLANE_Y, PLANE_OFFSET = 0, 1, 2  # a half-plane's normal and offset; a cell's place and the distance to keep
PLANE = 3
MOVER_X, MOVER_Y, MOVER_VX, MOVER_VY, MOVER_RADIUS = 0, 1, 2, 3, 4  # m, m/s, m
MOVER = 5

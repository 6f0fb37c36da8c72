"""The columns of rows of numbers, by name."""

X, Y, THETA = 0, 1, 2  # of a pose, m, m, rad; of a position or a state X and Y
VX, VY = 2, 3  # of a track's state, behind its position: m/s
REACH = 2  # of a track to leave out, behind its position: m
BEGIN, END = 0, 1  # of a piece: its first beam, and the one behind its last
COSINE, SINE = 0, 1  # of a turn, of a direction
ALONG, ACROSS, TURN = 0, 1, 2  # of an error of the pose, in the frame that drifts: m, m, rad
LENGTH, SUM_X, SUM_Y = 0, 1, 2  # of what tells a path from another: number of poses, m, m
SLOW, FAST, UPDATES = 0, 1, 2  # of averages of the likelihood, and how many updates are in them
BEAM_X, BEAM_Y, NORMAL_X, NORMAL_Y, OFFSET = range(5)  # of a line: its beam's direction, its normal, m from the sensor

"""How topics of ROS 2 are heard and published, by whichever transport."""

SENSORS = frozenset(
    {"sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage", "rosgraph_msgs/msg/Clock"}
)
DEPTH = 10  # messages that wait for a slow reader, as of rmw's default

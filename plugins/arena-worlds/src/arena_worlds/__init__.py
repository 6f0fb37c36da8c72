"""ROS maps and built-in worlds for the arena suite."""

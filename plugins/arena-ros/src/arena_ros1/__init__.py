"""ROS 1 for the arena suite. Nothing of ROS is imported until a transport is opened."""

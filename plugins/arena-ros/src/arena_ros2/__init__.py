"""ROS 2 for the arena suite. DDS is imported when a transport is opened."""

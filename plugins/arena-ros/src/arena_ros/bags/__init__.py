"""Recordings of ROS 1 and ROS 2: read one after the other in constant memory, written by rosbags."""

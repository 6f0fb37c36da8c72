"""TurtleBot3, Jackal and Robotino for the arena suite."""

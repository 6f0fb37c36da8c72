"""What moves through the system: worlds, robots, scenarios, what is sensed and what is true."""

"""One control step, one episode: what guides a robot, the navigator, the loop of N worlds, what is recorded."""

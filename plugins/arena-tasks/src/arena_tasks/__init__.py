"""Random and scenario tasks for the arena suite."""

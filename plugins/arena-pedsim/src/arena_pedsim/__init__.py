"""Social-force crowd for the arena suite."""

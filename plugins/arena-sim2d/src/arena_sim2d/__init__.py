"""Fast, batched 2-D simulator of the arena suite."""

"""Dynamic window approach for the arena suite."""

"""Pure pursuit: the specimen of a third-party planner for the arena suite."""
